"""libfetch_gazebo_plugin.so: the joints and the controllers of Fetch and Freight.

Source: fetch_gazebo, plugin.cpp and joint_handle.h; the controllers are those of the package
robot_controllers. Where it differs: the velocity loop of a joint is a motor with the joint's effort
limit; a joint that no controller commands stays where it is, as if gravity were compensated; the
bellows follow the torso exactly; the action `query_controller_states` is missing.
"""
from __future__ import annotations

import math
from typing import Dict, List, Mapping, Tuple, Type

from ..base import Plugin
from ..context import Context
from .controller import RUNNING, Controller
from .fetch_controllers import (
    FetchBase,
    FetchController,
    FetchTrajectory,
    ParallelGripper,
    PointHead,
)
from .hardware import POSITION, VELOCITY, Hardware, HardwareJoint
from .joint_state import make_joint_state
from .limits import limits_of
from .settings import Settings

_STATES_HZ = 100.0
_GAZEBO = "gazebo"                              # the node, below which the parameters are
_TYPES: Mapping[str, Type[FetchController]] = {
    "FollowJointTrajectoryController": FetchTrajectory, "PointHeadController": PointHead,
    "DiffDriveBaseController": FetchBase, "ParallelGripperController": ParallelGripper}
_MIMIC, _COMPENSATION = "ScaledMimicController", "GravityCompensation"


class FetchHardware(Hardware):
    """All moving joints of the model, each by rates or by positions."""

    needs_transmissions = False

    def __init__(self, context: Context, followers: List[str]) -> None:
        """`followers`: joints that follow others."""
        super().__init__(context, ())
        self.names = [joint.name for joint in context.description.joints
                      if joint.type != "fixed" and joint.name not in followers]
        for name in self.names:
            joint = context.joint(name)
            for interface in (VELOCITY, POSITION):
                self._all[interface, name] = HardwareJoint(
                    joint, interface, limits_of(joint.spec, context), None, 0.0)
            self._active[name] = self._all[VELOCITY, name]

    def release(self, name: str) -> None:
        """Hold a joint that no controller uses any longer."""
        self._active[name].hold()


class FetchGazebo(Plugin):
    """Loads the controllers that `gazebo/default_controllers` lists."""

    def load(self) -> None:
        context = self.context
        context.use_namespace("/")
        names = Settings(context, _GAZEBO).texts("default_controllers")
        kinds = {name: Settings(context, name).text("type").rpartition("/")[2] for name in names}
        self._mimics = [self._mimic(name) for name, kind in kinds.items() if kind == _MIMIC]
        hardware = self._hardware = FetchHardware(
            context, [follower for follower, _, _ in self._mimics])
        self._controllers: Dict[str, FetchController] = {}
        for name, kind in kinds.items():
            if kind in _TYPES:
                made = self._controllers[name] = _TYPES[kind](name, context, hardware, 0.0)
                made.on_goal = self._start
                made.load()
            elif kind not in (_MIMIC, _COMPENSATION):
                context.warn(f"controller '{name}': there is no controller of type {kind}; there"
                             f" are {', '.join([*_TYPES, _MIMIC, _COMPENSATION])}")
        self._joints = [context.joint(joint.name) for joint in context.description.joints
                        if joint.type != "fixed"]
        self._wraps = [limits_of(joint.spec, context).wraps for joint in self._joints]
        self._states = context.publish("joint_states", "sensor_msgs/JointState", 10)
        context.observe(_STATES_HZ, self._publish, [self._states],
                        efforts=[joint.name for joint in self._joints])
        self._begin()

    def _mimic(self, name: str) -> Tuple[str, str, float]:
        """The follower, the leader and the factor of a ScaledMimicController."""
        settings = Settings(self.context, name)
        return (settings.text("controlled_joint", "bellows_joint"),
                settings.text("mimic_joint", "torso_lift_joint"),
                settings.number("mimic_scale", 1.0))

    def _begin(self) -> None:
        """Hold all joints, and start the controllers that start by themselves."""
        self._hardware.hold()
        for follower, leader, factor in self._mimics:
            self.context.mimic(follower, leader, factor, 0.0)
        for one in self._controllers.values():
            if one.autostarts:
                self._start(one)

    def _start(self, one: Controller) -> None:
        """Start a controller; those that use its joints stop."""
        if one.state == RUNNING:
            return
        wanted = set(_joints_of(one))
        for other in self._controllers.values():
            if other.state == RUNNING and wanted & set(_joints_of(other)):
                other.switch_off()
        one.switch_on()

    def reset(self) -> None:
        """Stop all controllers, and begin again at the initial joint positions."""
        self.clock_set()

    def clock_set(self) -> None:
        """Controllers stop, because their plans refer to the previous sim time."""
        self._stop()
        self._begin()

    def close(self) -> None:
        self._stop()
        for one in self._controllers.values():
            one.close()

    def _stop(self) -> None:
        for one in self._controllers.values():
            if one.state == RUNNING:
                one.switch_off()

    def _publish(self) -> None:
        message = make_joint_state(self.context, self._hardware, self._joints)
        message.position = [
            math.remainder(position, 2.0 * math.pi) if wraps else position
            for wraps, position in zip(self._wraps, message.position)]
        self._states.publish(message)


def _joints_of(controller: Controller) -> List[str]:
    return [name for names in controller.claimed.values() for name in names]
