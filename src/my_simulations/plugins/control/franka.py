"""Hardware and controllers of franka_gazebo: the arm, its joint states, and the gripper.

Source: franka_ros 0.10, franka_control and franka_gazebo. Messages and actions of the packages
franka_msgs and franka_gripper are not offered.
"""
from __future__ import annotations

import math
from typing import Any, List, Optional

from ...engine.drive_commands import PidGains
from ..actions import ActionServer, Goal
from ..context import Context
from ..finite_messages import is_all_finite
from ..stepwise_change import StepwiseChange
from ..world.gravity_compensation import GravityCompensation
from .controller import RUNNING, Controller
from .hardware import EFFORT, HardwareJoint
from .joint_state import measured_joints

_UPDATE_HZ = 30.0          # without a rate
_GRIPPER_HZ = 100.0        # checks whether the fingers rest
_MOST_WIDTH = 0.08         # m between the fingers
_LEAST_FORCE = 1e-4        # N: a goal with less force does not grasp
_JOINT_STATE = "sensor_msgs/JointState"


class FrankaArm:
    """What franka_gazebo/FrankaHWSim adds to the joints: gravity is compensated, and the topic
    `initialized`, for which its launch files wait, says true.
    """

    def __init__(self, context: Context) -> None:
        self._compensation = GravityCompensation(context)
        topic = context.publish("initialized", "std_msgs/Bool", latch=True)
        message = context.message("std_msgs/Bool")
        message.data = True
        topic.publish(message)

    def reset(self) -> None:
        """Compensate gravity again: forces ended with the reset."""
        self._compensation.apply()


class FrankaStateController(Controller):
    """franka_control/FrankaStateController: `joint_states` and `joint_states_desired`.

    Both have the measured values, as franka_gazebo's have under efforts.
    """

    def load(self) -> None:
        names = self.settings.texts("joint_names", [])
        self._joints = [self.hardware.state(name) for name in names]
        self._rate = self.settings.number("publish_rate", _UPDATE_HZ)
        self._topics = [self.publish(name, _JOINT_STATE)
                        for name in ("joint_states", "joint_states_desired")]

    def start(self) -> None:
        self.observe(self._rate if self._rate > 0.0 else _UPDATE_HZ, self._publish, self._topics,
                     efforts=[joint.name for joint in self._joints])

    def _publish(self) -> None:
        for topic in self._topics:
            topic.publish(measured_joints(self.context, self.hardware, self._joints))


class FrankaGripper(Controller):
    """franka_gazebo/FrankaGripperSim: the action `gripper_action`, and `joint_states`.

    A goal without effort, or with a larger width, moves the fingers to this width. Any other goal
    closes them until they rest; if they then have this width, they press with `max_effort`.
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
        self._speed = abs(s.number("gripper_action/speed", 0.1))
        self._resting = abs(s.number("grasp/resting_threshold", 0.001))
        self._samples = max(1, round(s.number("grasp/consecutive_samples", 3)))
        self._goal: Optional[Goal] = None
        self._grasps, self._rested = False, 0
        self._watch = StepwiseChange(self.context, _GRIPPER_HZ, self._check)
        self._action = ActionServer(
            self.context, f"{self.name}/gripper_action", "control_msgs/GripperCommand",
            self._accept, self._cancel)
        self.keep(self._action)
        self._topic = self.publish("joint_states", _JOINT_STATE)

    def start(self) -> None:
        self._hold()
        self.observe(_UPDATE_HZ, self._publish, [self._topic],
                     efforts=[finger.name for finger in self._fingers])

    def stop(self) -> None:
        self._watch.end()
        self._preempt("the controller was stopped")

    @property
    def _width(self) -> float:
        return sum(finger.position for finger in self._fingers)

    def _hold(self, force: float = 0.0) -> None:
        """Keep each finger at the middle of both positions, and press it with a force, N."""
        for finger, gains in zip(self._fingers, self._gains):
            shift = force / gains.p if gains.p > 0.0 else 0.0
            finger.follow(self._width / 2.0 + shift, gains=gains, by_rates=True)

    def _move(self, rate: float) -> None:
        """Move each finger at a rate, m/s, by the d of its loop."""
        for finger, gains in zip(self._fingers, self._gains):
            finger.follow(rate, gains=PidGains(p=gains.d), of_rate=True)

    def _accept(self, goal: Goal) -> None:
        command = goal.message.command
        width = 2.0 * command.position
        if self.state != RUNNING:
            goal.reject(self._result(False), "the controller is not running")
        elif not is_all_finite(command.position) or not is_all_finite(command.max_effort):
            goal.reject(self._result(False), "the position or the effort is no number")
        elif not 0.0 <= width <= _MOST_WIDTH:
            goal.accept()
            goal.abort(self._result(False), f"the position is that of each finger: 0 to"
                                            f" {_MOST_WIDTH / 2.0:g} m, is {command.position:g} m")
        else:
            self._preempt("another goal came")
            goal.accept()
            self._goal, self._rested = goal, 0
            self._grasps = abs(command.max_effort) >= _LEAST_FORCE and width <= self._width
            self._watch.begin()
            self._move(math.copysign(self._speed / 2.0, width - self._width))

    def _cancel(self, goal: Goal) -> None:
        if self._goal is goal:
            self._preempt("")
            self._hold()

    def _preempt(self, why: str) -> None:
        if self._goal is not None:
            goal, self._goal = self._goal, None
            goal.cancel(self._result(False), why)

    def _check(self, _dt: float) -> bool:
        """End the goal at its width, or once the fingers rest; return whether there is none."""
        goal = self._goal
        if goal is None or not goal.active:
            return True
        command = goal.message.command
        is_reached = abs(self._width - 2.0 * command.position) < self._tolerance
        rests = abs(sum(finger.velocity for finger in self._fingers)) <= self._resting
        self._rested = self._rested + 1 if rests else 0
        if self._rested < self._samples and (self._grasps or not is_reached):
            return False
        self._goal = None
        self._hold(-abs(command.max_effort) / 2.0 if self._grasps and is_reached else 0.0)
        goal.succeed(self._result(is_reached))
        return True

    def _result(self, is_reached: bool) -> Any:
        result = self._action.result()
        result.position, result.effort = self._width, 0.0
        result.stalled, result.reached_goal = False, is_reached
        return result

    def _publish(self) -> None:
        self._topic.publish(measured_joints(self.context, self.hardware, self._fingers))
