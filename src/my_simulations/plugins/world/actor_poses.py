"""libActorPosesPlugin.so: models follow the agents of pedsim_ros.

As in pedsim_gazebo_plugin, a model whose name is the id of an agent stands 0.75 m above the pose of
the agent. It collides with other models, but nothing moves it from its way.
"""
from __future__ import annotations

from typing import Any, Dict, Set

from ...geometry import Pose
from ..base import Plugin
from ..context import PluginError

_TOPIC = "/pedsim_simulator/simulated_agents"
_MIDDLE_M = 0.75
"""Height of the middle of a model above the pose of its agent."""


class ActorPoses(Plugin):
    """Moves the models of agents when a message arrives."""

    def load(self) -> None:
        self._reported: Set[str] = set()
        self.context.subscribe(_TOPIC, "pedsim_msgs/AgentStates", self._follow)

    def _follow(self, message: Any) -> None:
        refused: Dict[str, PluginError] = {}
        for agent in message.agent_states:
            name, at, turn = str(agent.id), agent.pose.position, agent.pose.orientation
            try:
                self.context.move_model(name, Pose(
                    (at.x, at.y, at.z + _MIDDLE_M), (turn.x, turn.y, turn.z, turn.w)))
            except PluginError as fault:
                refused[name] = fault
        if refused.keys() - self._reported:
            self._report_present(refused)

    def _report_present(self, refused: Dict[str, PluginError]) -> None:
        """Report refused poses once per model; many agents do not have a model."""
        for name in sorted(refused.keys() & self.context.models().keys() - self._reported):
            self._reported.add(name)
            self.context.warn(f"cannot move model {name!r}: {refused[name]}")
