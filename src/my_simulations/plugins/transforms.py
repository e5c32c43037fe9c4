"""Stores the newest transforms of /tf."""
from __future__ import annotations

from typing import Any, Callable, Dict, Optional, Tuple

from ..geometry import IDENTITY, Pose, compose, inverse, normalised, pose_is_finite
from .context import Context

_NEAR_UNIT = 1e-2  # of the square of a quaternion's length (tf2)
_DEEPEST = 100  # frames above another: more is a loop


class Transforms:
    """Subscribes to `/tf` and `/tf_static`; `changed` is called after each message."""

    def __init__(self, context: Context, changed: Callable[[], None] = lambda: None) -> None:
        self._changed = changed
        self._parents: Dict[str, Tuple[str, Pose]] = {}
        for topic in ("/tf", "/tf_static"):
            context.subscribe(topic, "tf2_msgs/TFMessage", self._receive, queue=100)

    def _receive(self, message: Any) -> None:
        for one in message.transforms:
            at, turn = one.transform.translation, one.transform.rotation
            pose = Pose((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w))
            child, parent = one.child_frame_id.lstrip("/"), one.header.frame_id.lstrip("/")
            if child == parent or not pose_is_finite(pose) \
                    or abs(sum(part * part for part in pose.orientation) - 1.0) > _NEAR_UNIT:
                continue  # tf2 ignores these, too
            self._parents[child] = (parent, Pose(pose.position, normalised(pose.orientation)))
        self._changed()

    def look_up(self, frame: str, child: str) -> Optional[Pose]:
        """Return the pose of `child` in `frame`; None if /tf does not connect them."""
        (top, one), (other_top, other) = self._root(frame), self._root(child)
        return compose(inverse(one), other) if top == other_top else None

    def _root(self, frame: str) -> Tuple[str, Pose]:
        """Return the root of the tree of a frame, and the frame's pose in it."""
        frame, pose = frame.lstrip("/"), IDENTITY
        for _ in range(_DEEPEST):
            if frame not in self._parents:
                break
            frame, step = self._parents[frame]
            pose = compose(step, pose)
        return frame, pose
