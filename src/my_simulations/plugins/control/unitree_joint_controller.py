"""unitree_legged_control's UnitreeJointController: a motor with stiffness and damping.

Topics, messages, modes and limits are those of unitree_ros. Each step the engine applies tau + Kp
(q - q_now) + Kd (dq - dq_now), within the joint's effort. Where it differs: the rate is the joint's
own (original: a filtered one); the state is published 200 times a second of sim time, or as often
as the parameter `publish_rate` says (original: after each step).
"""
from __future__ import annotations

from typing import Any

from ...engine.drive_commands import PidGains
from .controller import Controller
from .hardware import EFFORT
from .speed_limits import clamp

_STATE_HZ = 200.0
_SERVO, _BRAKE = 0x0A, 0x00      # unitree_legged_sdk's motor modes
_NO_POSITION, _NO_RATE = 2.146e9, 16000.0   # values of q and dq that switch their loop off
_BRAKING = 20.0                  # N m s/rad
_SAME = 1e-5


class UnitreeJointController(Controller):
    """One joint: `joint`, topics `command` (MotorCmd) and `state` (MotorState)."""

    def load(self) -> None:
        self._joint = self.claim_joint(EFFORT, self.settings.text("joint"))
        self._hertz = self.settings.number("publish_rate", _STATE_HZ)
        self._state = self.publish("state", "unitree_legged_msgs/MotorState")
        self._mode = _BRAKE
        self.subscribe("command", "unitree_legged_msgs/MotorCmd", self._receive)

    def start(self) -> None:
        """Brake until a command comes."""
        self._brake()
        self.observe(self.update_hz(self._hertz), self._publish_state, [self._state],
                     efforts=[self._joint.name])

    def _receive(self, message: Any) -> None:
        """A command in another mode leaves the motor as it is."""
        mode = int(message.mode)
        if mode == _BRAKE:
            self._brake()
        elif mode == _SERVO:
            self._mode = mode
            limits = self._joint.limits
            position, rate = float(message.q), float(message.dq)
            stiffness = 0.0 if abs(position - _NO_POSITION) < _NO_POSITION * 1e-6 else message.Kp
            damping = 0.0 if abs(rate - _NO_RATE) < _SAME else message.Kd
            self._set_target(clamp(position, limits.lower, limits.upper), float(stiffness),
                             clamp(rate, -limits.rate, limits.rate), float(damping),
                             clamp(float(message.tau), -limits.effort, limits.effort))

    def _brake(self) -> None:
        self._mode = _BRAKE
        self._set_target(0.0, 0.0, 0.0, _BRAKING, 0.0)

    def _set_target(self, position: float, stiffness: float, rate: float, damping: float,
                    effort: float) -> None:
        """The effort is given to the loop as a target that is shifted by as much."""
        if damping > 0.0:
            rate += effort / damping
        elif stiffness > 0.0:
            position += effort / stiffness
        else:
            self._joint.command(effort)
            return
        self._joint.follow(position, gains=PidGains(stiffness, 0.0, damping, 0.0, 0.0, False),
                           target_rate=rate, by_rates=True)

    def _publish_state(self) -> None:
        message = self.context.message("unitree_legged_msgs/MotorState")
        message.mode = self._mode
        message.q, message.dq = self._joint.position, self._joint.velocity
        message.tauEst = self.hardware.efforts([self._joint.name])[0]
        self._state.publish(message)
