"""libActorPosesPlugin.so: models follow the agents of pedsim_ros.

As in pedsim_gazebo_plugin, a model whose name is the id of an agent stands 0.75 m above the pose of
the agent. It collides with other models, but nothing moves it from its way.
"""
from __future__ import annotations

import contextlib
from typing import Any

from ...geometry import Pose
from ..base import Plugin
from ..context import PluginError

_TOPIC = "/pedsim_simulator/simulated_agents"
_MIDDLE_M = 0.75
"""Height of the middle of a model above the pose of its agent."""


class ActorPoses(Plugin):
    """Moves the models of agents when a message arrives."""

    def load(self) -> None:
        self.context.subscribe(_TOPIC, "pedsim_msgs/AgentStates", self._follow)

    def _follow(self, message: Any) -> None:
        for agent in message.agent_states:
            at, turn = agent.pose.position, agent.pose.orientation
            with contextlib.suppress(PluginError):   # an agent without a model
                self.context.move_model(str(agent.id), Pose(
                    (at.x, at.y, at.z + _MIDDLE_M), (turn.x, turn.y, turn.z, turn.w)))
