"""Action servers: goals, cancels, status, feedback and results as topics. Source: actionlib."""
from __future__ import annotations

from typing import Any, Callable, List, Optional, Tuple

from .context import CallHandle, Context, Handle
from .frames import stamp_message

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED = range(9)
_STATUS_HZ = 5.0
# Sim time for which the status of an ended goal is published, and a cancel is kept for its goal.
_KEEP_NS = 5_000_000_000
_QUEUE = 50


class Goal:
    """A goal of an action server, with its status.

    Attributes:
        message: the client's request, e.g. control_msgs/FollowJointTrajectoryGoal.
        status: one of actionlib_msgs/GoalStatus.
    """

    def __init__(self, server: "ActionServer", goal_id: Any, message: Any) -> None:
        self._server, self.goal_id, self.message = server, goal_id, message
        self.status, self.text = PENDING, ""
        self.ended_ns: Optional[int] = None

    @property
    def active(self) -> bool:
        """Whether the goal was accepted and has not ended."""
        return self.status in (ACTIVE, PREEMPTING)

    def accept(self, text: str = "") -> None:
        self.status = PREEMPTING if self.status == RECALLING else ACTIVE
        self._server.status_changed(self, text)

    def reject(self, result: Any, text: str = "") -> None:
        self._end(REJECTED, result, text)

    def succeed(self, result: Any, text: str = "") -> None:
        self._end(SUCCEEDED, result, text)

    def abort(self, result: Any, text: str = "") -> None:
        self._end(ABORTED, result, text)

    def cancel(self, result: Any, text: str = "") -> None:
        """End the goal because another one replaces it, or because its client cancelled it."""
        self._end(PREEMPTED if self.status in (ACTIVE, PREEMPTING) else RECALLED, result, text)

    def feedback(self, feedback: Any) -> None:
        self._server.send_feedback(self, feedback)

    def _end(self, status: int, result: Any, text: str) -> None:
        self.status = status
        self._server.ended(self, result, text)


class ActionServer:
    """An action server of a plugin.

    Args:
        context: of the plugin.
        name: the namespace of its topics.
        kind: e.g. `control_msgs/FollowJointTrajectory`.
        asked: called with each new goal, which it must accept or reject.
        cancelled: called with each active goal that its client cancels.

    Attributes:
        current: the goal that `follow` accepted last, until it ends; None without one.
    """

    current: Optional[Goal] = None

    def __init__(self, context: Context, name: str, kind: str, asked: Callable[[Goal], None],
                 cancelled: Callable[[Goal], None]) -> None:
        self._context, self._kind = context, kind
        self._asked, self._cancelled = asked, cancelled
        self._goals: List[Goal] = []
        self._early: List[Tuple[Any, int]] = []   # cancels of unknown goals, and sim times
        self._status = context.publish(f"{name}/status", "actionlib_msgs/GoalStatusArray", _QUEUE,
                                       latch=True)
        self._results = context.publish(f"{name}/result", f"{kind}ActionResult", _QUEUE)
        self._feedback = context.publish(f"{name}/feedback", f"{kind}ActionFeedback", _QUEUE)
        self._handles: List[Handle] = [
            self._status, self._results, self._feedback,
            context.subscribe(f"{name}/goal", f"{kind}ActionGoal", self._receive_goal, _QUEUE),
            context.subscribe(f"{name}/cancel", "actionlib_msgs/GoalID", self._receive_cancel,
                              _QUEUE)]
        self._timer: CallHandle = context.observe(_STATUS_HZ, self._publish_status,
                                                  [self._status])
        self._publish_status()

    def result(self) -> Any:
        return self._context.message(f"{self._kind}Result")

    def follow(self, goal: Goal) -> None:
        """Accept a goal as the current one."""
        self.current = goal
        goal.accept()

    def preempt(self, why: str, result: Optional[Callable[[], Any]] = None) -> None:
        """Cancel the current goal, if there is one; `result` makes its result if given."""
        if self.current is not None:
            self.current.cancel((result or self.result)(), why)

    def close(self) -> None:
        """Remove the action from the ROS graph."""
        self._timer.end()
        for handle in self._handles:
            handle.close()

    # -- for goals ---------------------------------------------------------------------------------

    def status_changed(self, goal: Goal, text: str) -> None:
        """Publish the status after the status of a goal changed."""
        goal.text = text
        self._publish_status()

    def ended(self, goal: Goal, result: Any, text: str) -> None:
        """Publish the result and the status of a goal that ended."""
        goal.text, goal.ended_ns = text, self._context.now_ns
        if goal is self.current:
            self.current = None
        self._send_result(goal, result)
        self._publish_status()

    def send_feedback(self, goal: Goal, feedback: Any) -> None:
        """Publish feedback of a goal, if the topic has a subscriber."""
        if self._feedback.wanted:
            message = stamp_message(self._context, f"{self._kind}ActionFeedback")
            message.status, message.feedback = self._status_of(goal), feedback
            self._feedback.publish(message)

    # -- inside ------------------------------------------------------------------------------------

    def _receive_goal(self, message: Any) -> None:
        goal_id = message.goal_id
        if not goal_id.id:
            goal_id.id = f"goal-{self._context.now_ns}-{len(self._goals)}"
        for known in self._goals:
            if known.goal_id.id == goal_id.id:
                return   # a goal is sent once; a later copy changes nothing
        goal = Goal(self, goal_id, message.goal)
        self._goals.append(goal)
        if any(_applies_to(one, goal) for one, _ in self._early):
            goal.cancel(self.result(), "cancelled before it arrived")
            return
        self._asked(goal)

    def _receive_cancel(self, wanted: Any) -> None:
        found = [goal for goal in self._goals if _applies_to(wanted, goal)]
        if wanted.id and not found:
            self._early.append((wanted, self._context.now_ns))
        for goal in found:
            if goal.status == ACTIVE:
                goal.status = PREEMPTING
                self._cancelled(goal)

    def _publish_status(self) -> None:
        now = self._context.now_ns   # of an observation: can be earlier than the last message
        self._goals = [goal for goal in self._goals if goal.ended_ns is None
                       or abs(now - goal.ended_ns) <= _KEEP_NS]
        self._early = [(one, came_ns) for one, came_ns in self._early
                       if abs(now - came_ns) <= _KEEP_NS]
        message = stamp_message(self._context, "actionlib_msgs/GoalStatusArray")
        message.status_list = [self._status_of(goal) for goal in self._goals]
        self._status.publish(message)

    def _status_of(self, goal: Goal) -> Any:
        status = self._context.message("actionlib_msgs/GoalStatus")
        status.goal_id, status.status, status.text = goal.goal_id, goal.status, goal.text
        return status

    def _send_result(self, goal: Goal, result: Any) -> None:
        message = stamp_message(self._context, f"{self._kind}ActionResult")
        message.status, message.result = self._status_of(goal), result
        self._results.publish(message)


def _applies_to(wanted: Any, goal: Goal) -> bool:
    """Return whether a cancel message applies to a goal: by id, by time, or to all goals."""
    stamp = wanted.stamp.to_nsec()
    if wanted.id:
        return bool(wanted.id == goal.goal_id.id)
    return bool(stamp == 0 or goal.goal_id.stamp.to_nsec() <= stamp)
