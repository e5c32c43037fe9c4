"""libgazebo_ros_control.so: the joints of a robot for ros_control, and its controller manager."""
from __future__ import annotations

from typing import Any

from ..base import Plugin
from ..context import PluginError
from .hardware import Hardware
from .initial_hold import InitialHold
from .manager import ControllerManager

_KNOWN = ("", "gazebo_ros_control/DefaultRobotHWSim")


class GazeboRosControl(Plugin):
    """Reads transmissions; controllers do the rest."""

    def load(self) -> None:
        """Find the joints; offer the controller manager."""
        context, p = self.context, self.context.parameters
        # As in Gazebo an empty element, such as xacro leaves, is the node's namespace.
        context.use_namespace(p.text("robotNamespace", context.model))
        simulated = p.text("robotSimType")
        if simulated not in _KNOWN:
            context.warn(f"<robotSimType> {simulated} is not simulated; {_KNOWN[1]} is used")
        transmissions = context.transmissions(p.text("robotParam") or "robot_description")
        if not transmissions:
            raise PluginError("the robot has no <transmission>: no joint can be controlled")
        self._hardware = Hardware(context, transmissions)
        period = p.number("controlPeriod", 0.0)
        self._hold = InitialHold(context, self._hardware, lambda: self._manager.claimed)
        self._manager = ControllerManager(context, self._hardware, period,
                                          claimed=self._hold.limit)
        self._stopped = False
        topic = p.text("eStopTopic")
        if topic:
            context.subscribe(topic, "std_msgs/Bool", self._hear_stop)
        self._hold.begin()

    def reset(self) -> None:
        """Joints are where they began: they are held, and controllers start anew, there."""
        self._hardware.halt(self._stopped)
        self._manager.restart()
        self._hold.begin()

    def clock_set(self) -> None:
        """What was planned by the clock counts no more."""
        self._manager.restart()
        self._hold.begin()

    def close(self) -> None:
        """The robot goes, and with it its controllers."""
        self._manager.close()

    def _hear_stop(self, message: Any) -> None:
        """Stopped, controllers go on but drive nothing; then they start anew, as in Gazebo."""
        if bool(message.data) == self._stopped:
            return
        self._stopped = bool(message.data)
        self._hardware.halt(self._stopped)
        if not self._stopped:
            self._manager.restart()
