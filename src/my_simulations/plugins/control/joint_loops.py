"""Controllers with a PID loop about the position or rate of a joint; the engine runs the loop."""
from __future__ import annotations

from functools import partial
from typing import Dict

from ...engine.drive_commands import PidGains
from ...engine.servo_law import wrapped_angle
from ..frames import stamp_message
from .controller import Controller
from .forward import ForwardGroupController
from .hardware import HardwareJoint

_STATE_HZ = 100.0   # of sim time: the originals publish each tenth update, at 1 kHz


class JointLoop(Controller):
    """One joint: `joint`, gains in `pid`, topics `command` (Float64) and `state`.

    The state's command is the effort of the last step, so it is 0 for loops that give a rate.
    """

    of_rate = False

    def load(self) -> None:
        self._gains = self.settings.needed_gains("pid")
        self._joint = self.claim_joint(self.interface, self.settings.text("joint"))
        self._wanted = 0.0
        self._state = self.publish("state", "control_msgs/JointControllerState")
        self.subscribe("command", "std_msgs/Float64",
                       lambda message: self._set_target(message.data))
        self.offer_gains("pid", self._joint, self._gains, self._set_gains)

    def _set_gains(self, gains: PidGains) -> None:
        self._gains = gains

    def start(self) -> None:
        """Hold the position, or command 0."""
        self._set_target(0.0 if self.of_rate else self._joint.position)
        self.observe(self.update_hz(_STATE_HZ), self._publish_state, [self._state],
                     efforts=[self._joint.name])

    def _set_target(self, wanted: float) -> None:
        self._wanted = wanted if self.of_rate else clamp_to_limits(self._joint, wanted)
        self._joint.follow(self._wanted, gains=self._gains, of_rate=self.of_rate)

    def _publish_state(self) -> None:
        joint, gains = self._joint, self._gains
        message = stamp_message(self.context, "control_msgs/JointControllerState")
        message.set_point = self._wanted
        message.process_value = joint.velocity if self.of_rate else joint.position
        message.process_value_dot = 0.0 if self.of_rate else joint.velocity
        error = self._wanted - message.process_value
        message.error = wrapped_angle(error) if joint.limits.wraps and not self.of_rate else error
        message.time_step = self.period or self.context.step_size
        message.command = self.hardware.efforts([joint.name])[0]
        message.p, message.i, message.d = gains.p, gains.i, gains.d
        message.i_clamp, message.antiwindup = gains.i_max, gains.antiwindup
        self._state.publish(message)


class JointVelocityLoop(JointLoop):
    """effort_controllers/JointVelocityController."""

    of_rate = True


class JointPositionGroup(ForwardGroupController):
    """effort_controllers/JointGroupPositionController: gains in JOINT/pid."""

    def load(self) -> None:
        super().load()
        self._gains: Dict[str, PidGains] = {
            joint.name: self.settings.needed_gains(f"{joint.name}/pid") for joint in self.joints}
        for joint in self.joints:
            self.offer_gains(f"{joint.name}/pid", joint, self._gains[joint.name],
                             partial(self._gains.__setitem__, joint.name))

    def start(self) -> None:
        """Hold the present positions."""
        for joint in self.joints:
            self.command(joint, joint.position)

    def command(self, joint: HardwareJoint, value: float) -> None:
        joint.follow(clamp_to_limits(joint, value), gains=self._gains[joint.name])


def clamp_to_limits(joint: HardwareJoint, position: float) -> float:
    """Return the position within the limits of a joint that is nearest to `position`."""
    return max(joint.limits.lower, min(joint.limits.upper, position))
