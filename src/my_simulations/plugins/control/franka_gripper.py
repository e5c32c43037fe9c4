"""The gripper of franka_gazebo, with its actions.

Source: franka_ros 0.10, franka_gazebo/FrankaGripperSim. Where it differs: `homing` closes the
fingers and then opens them; a motion to a width that something blocks is aborted.
"""
from __future__ import annotations

import math
from typing import Any, Callable, List, NamedTuple, Optional, Tuple

from ...engine.drive_commands import PidGains
from ..actions import ActionServer, Goal
from ..context import PluginError
from ..finite_messages import is_all_finite
from ..stepwise_change import StepwiseChange
from .controller import RUNNING, Controller
from .franka import UPDATE_HZ
from .hardware import EFFORT, HardwareJoint
from .joint_state import make_joint_state

_CHECK_HZ = 100.0      # of whether the fingers rest
_MOST_WIDTH = 0.08     # m between the fingers
_LEAST_FORCE = 1e-4    # N: a gripper_action with less force does not grasp
_HOMING_SPEED = 0.02   # m/s
_BLOCKED_CHECKS = 50   # at rest, after which a motion to a width is aborted


_Result = Callable[[bool, str], Any]
"""Makes the result of an action: whether it succeeded, and the reason if not."""


class _Motion(NamedTuple):
    """What a goal asks for.

    Attributes:
        end: ends the goal: whether the wanted width is reached, and the reason if not.
        width: wanted distance of the fingers, m.
        tolerance: m below and above it.
        speed: of the width, m/s.
        checks: how many that find the fingers at rest, one after the other, end the motion.
        force: with which the fingers press once they rest, N; None for a motion to the width.
        next_width: for another motion after this one.
    """

    end: Callable[[bool, str], None]
    width: float
    tolerance: Tuple[float, float]
    speed: float
    checks: int
    force: Optional[float] = None
    next_width: Optional[float] = None


class FrankaGripper(Controller):
    """franka_gazebo/FrankaGripperSim: its actions, and `joint_states`.

    A goal of `gripper_action` without effort, or with a larger width, moves the fingers to this
    width. Any other one, and one of `grasp`, moves them until they rest; if they then have this
    width, they press. `move`, `grasp`, `homing` and `stop` require the package franka_gripper.
    """

    def load(self) -> None:
        s = self.settings
        arm = s.text("arm_id", "")
        self._fingers: List[HardwareJoint] = []
        self._gains: List[PidGains] = []
        for number in (1, 2):
            default = f"{arm}_finger_joint{number}" if arm else None
            self._fingers.append(self.claim_joint(
                EFFORT, s.text(f"finger{number}/joint", default)))
            self._gains.append(s.needed_gains(f"finger{number}/gains"))
        self._tolerance = abs(s.number("gripper_action/width_tolerance", 0.005))
        self._move_tolerance = abs(s.number("move/width_tolerance", 0.001))
        self._speed = abs(s.number("gripper_action/speed", 0.1))
        self._resting = abs(s.number("grasp/resting_threshold", 0.001))
        self._samples = max(1, round(s.number("grasp/consecutive_samples", 3)))
        self._motion: Optional[_Motion] = None
        self._goal: Optional[Tuple[Goal, _Result]] = None
        self._rested = 0
        self._watch = StepwiseChange(self.context, _CHECK_HZ, self._check)
        self._offer("gripper_action", "control_msgs/GripperCommand", self._accept_command)
        self._offer_own_actions()
        self._topic = self.publish("joint_states", "sensor_msgs/JointState")

    def _offer_own_actions(self) -> None:
        try:
            self.context.message("franka_gripper/MoveResult")
        except PluginError as missing:
            self.context.info(f"no actions move, grasp, homing and stop: {missing}")
            return
        for name, accept in (("move", self._accept_move), ("grasp", self._accept_grasp),
                             ("homing", self._accept_homing), ("stop", self._accept_stop)):
            self._offer(name, f"franka_gripper/{name.capitalize()}", accept)

    def _offer(self, name: str, kind: str, accept: Callable[[Goal, _Result], None]) -> None:
        def received(goal: Goal) -> None:
            if self.state != RUNNING:
                goal.reject(result(False, ""), "the controller is not running")
            else:
                accept(goal, result)

        def result(success: bool, error: str) -> Any:
            made = action.result()
            if kind == "control_msgs/GripperCommand":
                made.position, made.effort = self._width, 0.0
                made.stalled, made.reached_goal = False, success
            else:
                made.success, made.error = success, error
            return made

        action = ActionServer(self.context, f"{self.name}/{name}", kind, received, self._cancel)
        self.keep_handle(action)

    def start(self) -> None:
        """Hold the fingers."""
        self._hold()
        self.observe(UPDATE_HZ, self._publish, [self._topic],
                     efforts=[finger.name for finger in self._fingers])

    def stop(self) -> None:
        """End the goal."""
        self._watch.end()
        self._interrupt("the controller was stopped")

    @property
    def _width(self) -> float:
        return sum(finger.position for finger in self._fingers)

    def _hold(self, force: float = 0.0) -> None:
        """Keep each finger at the middle of both positions, and press it with a force, N."""
        for finger, gains in zip(self._fingers, self._gains):
            shift = force / gains.p if gains.p > 0.0 else 0.0
            finger.follow(self._width / 2.0 + shift, gains=gains, by_rates=True)

    def _begin(self, goal: Goal, result: _Result, motion: _Motion) -> None:
        """Begin a motion instead of the one under way."""
        self._interrupt("another goal came")
        goal.accept()
        self._goal = (goal, result)
        self._watch.begin()
        self._move(motion)

    def _move(self, motion: _Motion) -> None:
        """Move each finger at half of the speed, by the d of its loop."""
        self._motion, self._rested = motion, 0
        rate = math.copysign(motion.speed / 2.0, motion.width - self._width)
        for finger, gains in zip(self._fingers, self._gains):
            finger.follow(rate, gains=PidGains(p=gains.d), of_rate=True)

    # -- goals -------------------------------------------------------------------------------------

    def _accept_command(self, goal: Goal, result: _Result) -> None:
        command = goal.message.command
        width, force = 2.0 * command.position, abs(command.max_effort)
        if not is_all_finite(command.position) or not is_all_finite(command.max_effort):
            goal.reject(result(False, ""), "the position or the effort is no number")
        elif not 0.0 <= width <= _MOST_WIDTH:
            _abort(goal, result, f"the position is that of each finger: 0 to"
                                      f" {_MOST_WIDTH / 2.0:g} m, is {command.position:g} m")
        else:
            grasps = force >= _LEAST_FORCE and width <= self._width
            self._begin(goal, result, _Motion(
                lambda is_reached, why: goal.succeed(result(is_reached, why)), width,
                (self._tolerance, self._tolerance), self._speed, self._samples,
                force if grasps else None))

    def _accept_move(self, goal: Goal, result: _Result) -> None:
        if self._check_numbers(goal, result, goal.message.width, goal.message.speed):
            self._begin(goal, result, _Motion(
                _end_of(goal, result), goal.message.width,
                (self._move_tolerance, self._move_tolerance), goal.message.speed,
                _BLOCKED_CHECKS))

    def _accept_grasp(self, goal: Goal, result: _Result) -> None:
        wanted = goal.message
        epsilon = wanted.epsilon
        if self._check_numbers(goal, result, wanted.width, wanted.speed, wanted.force,
                               epsilon.inner, epsilon.outer):
            self._begin(goal, result, _Motion(
                _end_of(goal, result), wanted.width, (epsilon.inner, epsilon.outer), wanted.speed,
                self._samples, abs(wanted.force)))

    def _accept_homing(self, goal: Goal, result: _Result) -> None:
        self._begin(goal, result, _Motion(
            _end_of(goal, result), 0.0, (self._move_tolerance, self._move_tolerance),
            _HOMING_SPEED, _BLOCKED_CHECKS, next_width=_MOST_WIDTH))

    def _accept_stop(self, goal: Goal, result: _Result) -> None:
        self._interrupt("the stop action was called")
        self._hold()
        goal.accept()
        goal.succeed(result(True, ""))

    def _check_numbers(self, goal: Goal, result: _Result, width: float, speed: float,
                       *others: float) -> bool:
        if not is_all_finite([width, speed, *others]):
            _abort(goal, result, "a number of the goal is not finite")
        elif speed < 0.0:
            _abort(goal, result, f"the speed must not be negative, it is {speed:g} m/s")
        elif not 0.0 <= width <= _MOST_WIDTH:
            _abort(goal, result, f"the width must be 0 to {_MOST_WIDTH:g} m, it is"
                                      f" {width:g} m")
        else:
            return True
        return False

    def _cancel(self, goal: Goal) -> None:
        if self._goal is not None and self._goal[0] is goal:
            self._interrupt("")
            self._hold()

    def _interrupt(self, why: str) -> None:
        interrupted, self._goal, self._motion = self._goal, None, None
        if interrupted is not None:
            goal, result = interrupted
            goal.cancel(result(False, why), why)

    # -- motion ------------------------------------------------------------------------------------

    def _check(self, _dt: float) -> bool:
        """End the goal at its width, or once the fingers rest; return whether there is none."""
        motion = self._motion
        if motion is None:
            return True
        below, above = motion.tolerance
        width = self._width
        is_reached = motion.width - below < width < motion.width + above
        rests = abs(sum(finger.velocity for finger in self._fingers)) <= self._resting
        self._rested = self._rested + 1 if rests else 0
        if self._rested < motion.checks and (motion.force is not None or not is_reached):
            return False
        if motion.next_width is not None and is_reached:
            self._move(motion._replace(width=motion.next_width, next_width=None))
            return False
        self._goal = self._motion = None
        self._hold(-motion.force / 2.0 if motion.force is not None and is_reached else 0.0)
        motion.end(is_reached, f"the fingers rest at a width of {width:.4f} m, not at"
                               f" {motion.width:.4f} m")
        return True

    def _publish(self) -> None:
        self._topic.publish(make_joint_state(self.context, self.hardware, self._fingers))


def _end_of(goal: Goal, result: _Result) -> Callable[[bool, str], None]:
    def end(is_reached: bool, why: str) -> None:
        if is_reached:
            goal.succeed(result(True, ""))
        else:
            goal.abort(result(False, why), why)

    return end


def _abort(goal: Goal, result: _Result, why: str) -> None:
    goal.accept()
    goal.abort(result(False, why), why)
