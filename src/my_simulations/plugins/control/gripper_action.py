"""gripper_action_controller: control_msgs/GripperCommand. Parameters and ends as the original."""
from __future__ import annotations

import math
from typing import Any, Optional

from ...engine.drive_commands import PidGains
from ..actions import ActionServer, Goal
from ..finite_messages import is_all_finite
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut
from .controller import RUNNING, Controller
from .hardware import EFFORT

_LOOK_HZ = 100.0


class Gripper(Controller):
    """One joint that opens and closes."""

    def load(self) -> None:
        s = self.settings
        self._joint = self.claim_joint(self.interface, s.text("joint"))
        path = f"gains/{self._joint.name}"
        self._gains: Optional[PidGains] = None
        if self.interface == EFFORT:
            self._gains = s.needed_gains(path)
            self.offer_gains(path, self._joint, self._gains, self._set_gains)
        self._tolerance = abs(s.number("goal_tolerance", 0.01))
        self._default_effort = abs(s.number("max_effort", 0.0))
        self._still = s.number("stall_velocity_threshold", 0.001)
        self._stall = TimeOut(self.context, s.number("stall_timeout", 1.0))
        self._watch = StepwiseChange(self.context, self.update_hz(_LOOK_HZ), self._check_goal)
        self._wanted, self._most = 0.0, self._default_effort
        self._action = ActionServer(self.context, f"{self.name}/gripper_cmd",
                                    "control_msgs/GripperCommand", self._start_goal,
                                    self._on_cancel)
        self.keep_handle(self._action)

    def _set_gains(self, gains: PidGains) -> None:
        self._gains = gains

    def start(self) -> None:
        self._hold()

    def stop(self) -> None:
        self._watch.end()
        self._preempt("the controller was stopped")

    def _start_goal(self, goal: Goal) -> None:
        if self.state != RUNNING:
            goal.reject(self._result(False, False), "the controller is not running")
            return
        command = goal.message.command
        if not is_all_finite(command.position) or math.isnan(command.max_effort):
            goal.reject(self._result(False, False), "the position or the effort is no number")
            return
        self._preempt("another goal came")
        self._action.follow(goal)
        self._stall.begin()
        self._watch.begin()
        self._move_to(float(command.position), float(command.max_effort))

    def _on_cancel(self, goal: Goal) -> None:
        if self._action.current is goal:
            self._hold()
            goal.cancel(self._result(False, False))

    def _preempt(self, why: str) -> None:
        self._action.preempt(why, lambda: self._result(False, False))

    def _hold(self) -> None:
        self._move_to(self._joint.position, self._default_effort)

    def _move_to(self, wanted: float, most: float) -> None:
        """Move to a position; limit 0 of an effort joint is no effort (as in the original)."""
        self._wanted, self._most = wanted, abs(most)
        if self._gains is None:
            self._joint.follow(wanted, most_effort=self._most or math.inf)
        else:
            self._joint.follow(wanted, gains=self._gains, by_rates=True, most_effort=self._most)

    def _check_goal(self, dt: float) -> bool:
        """End a goal that is reached or holds something; return whether there is no goal left."""
        goal = self._action.current
        if goal is None:
            return True
        if abs(self._wanted - self._joint.position) < self._tolerance:
            goal.succeed(self._result(False, True))
        elif abs(self._joint.velocity) > self._still:
            self._stall.begin()
        elif self._stall.is_over:
            goal.abort(self._result(True, False))
        return not goal.active

    def _result(self, stalled: bool, reached: bool) -> Any:
        result = self._action.result()
        result.position = self._joint.position
        result.effort = self.hardware.efforts([self._joint.name])[0]
        result.stalled, result.reached_goal = stalled, reached
        return result
