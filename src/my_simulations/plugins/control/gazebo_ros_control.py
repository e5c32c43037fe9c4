"""libgazebo_ros_control.so: the joints of a robot for ros_control, and its controller manager."""
from __future__ import annotations

from typing import Any, Callable, List, Mapping, Type

from ...description.transmission import Transmission
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import Context
from .franka import FrankaArm
from .hardware import Hardware, PalHardware, SwitchingHardware
from .manager import ControllerManager
from .quadrotor_hardware import QuadrotorHardware
from .steer_bot_hardware import SteerBotHardware

DEFAULT, SWITCHING = ("gazebo_ros_control/DefaultRobotHWSim",
                      "cob_gazebo_ros_control/HWISwitchRobotHWSim")
FRANKA = "franka_gazebo/FrankaHWSim"
_HARDWARE: Mapping[str, Type[Hardware]] = {
    DEFAULT: Hardware, FRANKA: Hardware, SWITCHING: SwitchingHardware,
    "pal_hardware_gazebo/PalHardwareGazebo": PalHardware,
    "steer_bot_hardware_gazebo/SteerBotHardwareGazebo": SteerBotHardware,
    "hector_quadrotor_controller_gazebo/QuadrotorHardwareSim": QuadrotorHardware}


class GazeboRosControl(Plugin):
    """Reads transmissions; controllers do the rest.

    Attributes:
        hardware_type: the simulated hardware; "" if `<robotSimType>` decides.
    """

    hardware_type = ""

    def load(self) -> None:
        """Find the joints; offer the controller manager."""
        context, p = self.context, self.context.parameters
        # As in Gazebo an empty element, such as xacro leaves, is the node's namespace.
        context.use_namespace(p.text("robotNamespace", context.model))
        kind = self.hardware_type or p.text("robotSimType") or DEFAULT
        if kind not in _HARDWARE:
            context.warn(f"<robotSimType> {kind} is not simulated; {DEFAULT} is used")
        hardware = _HARDWARE.get(kind, Hardware)
        transmissions = context.transmissions(p.text("robotParam") or "robot_description") \
            if hardware.needs_transmissions else []
        if hardware.needs_transmissions and not transmissions:
            context.warn("the robot has no <transmission>: no joint can be controlled")
        self._hardware = hardware(context, self.controllable(transmissions))
        self._franka = FrankaArm(context) if kind == FRANKA else None
        period = p.number("controlPeriod", 0.0)
        self._hold = InitialHold(context, self._hardware, lambda: self._manager.claimed)
        self._manager = ControllerManager(context, self._hardware, period,
                                          claimed=self._hold.shorten_wait)
        self._stopped = False
        topic = p.text("eStopTopic")
        if topic:
            context.subscribe(topic, "std_msgs/Bool", self._receive_stop)
        self._hold.begin()

    def controllable(self, transmissions: List[Transmission]) -> List[Transmission]:
        """Return the transmissions of the joints that this plugin controls. Raises PluginError."""
        return transmissions

    def reset(self) -> None:
        """Restart controllers at the initial joint positions, and hold the joints there."""
        self._hardware.set_emergency_stop(self._stopped)
        if self._franka is not None:
            self._franka.reset()
        self._manager.restart()
        self._hold.begin()

    def clock_set(self) -> None:
        """Restart controllers, because their plans refer to the previous sim time."""
        self._manager.restart()
        self._hold.begin()

    def close(self) -> None:
        """End all controllers; the robot is deleted."""
        self._manager.close()

    def _receive_stop(self, message: Any) -> None:
        """Apply a message of `<eStopTopic>`: true begins the emergency stop, false ends it."""
        self.set_stopped(bool(message.data))

    def set_stopped(self, stopped: bool) -> None:
        """Begin or end an emergency stop.

        During the stop controllers run without effect; at its end they restart, as in Gazebo.
        """
        if stopped == self._stopped:
            return
        self._stopped = stopped
        self._hardware.set_emergency_stop(self._stopped)
        if not self._stopped:
            self._manager.restart()


PATIENCE_S = 10.0
"""How long joints are held for the first controller, s of sim time."""

FURTHER_S = 1.0
"""How long they are held for further controllers after the first one has started."""


class InitialHold:
    """Holds joints from the first step on, so that a robot starts as it was spawned.

    Gazebo holds joints with a position or velocity interface at once, and lets those with an effort
    interface fall until their controller starts: how far depends on the speed of the machine. Here
    all are held. A controller takes its joints over. The others rest a while later: positions are
    held with the effort of the joint, rates and efforts are 0.

    Args:
        context: of the plugin.
        hardware: the joints.
        claimed: returns the names of the joints that controllers drive.
    """

    def __init__(self, context: Context, hardware: Hardware,
                 claimed: Callable[[], List[str]]) -> None:
        self._context, self._hardware, self._claimed = context, hardware, claimed
        self._timer = CallSlot()
        self._limited = False

    def begin(self) -> None:
        """Hold all joints, unless a controller drives some."""
        if self._claimed():
            return
        self._limited = False
        self._hardware.hold()
        self._wait(PATIENCE_S)

    def shorten_wait(self) -> None:
        """Wait only a little longer for other controllers, after the first has started."""
        if not self._limited:
            self._limited = True
            self._wait(FURTHER_S)

    def _wait(self, seconds: float) -> None:
        self._timer.set(self._context.once(self._context.now_ns + round(seconds * 1e9), self._end))

    def _end(self) -> None:
        self._timer.end()
        released = self._hardware.end_holds(but=self._claimed())
        if released and not self._limited:
            self._context.info(f"no controller has started within {PATIENCE_S:g} s of sim time; "
                               "these joints are not held any more, as they have an effort"
                               f" interface: {', '.join(released)}")
