"""Names of tf frames under a prefix (source: tf::resolve of ROS 1), and messages with headers."""
from __future__ import annotations

from typing import Any, Optional

from .context import Context


def resolve_frame(prefix: str, frame: str) -> str:
    """Return the tf frame `prefix/frame`; a frame with a leading `/` gets no prefix."""
    if frame.startswith("/"):
        return frame[1:]
    prefix = prefix.strip("/")
    return f"{prefix}/{frame}" if prefix else frame


def add_tf_prefix(context: Context, frame: str) -> str:
    """Add the parameter `tf_prefix` of the plugin's namespace, or of one above, to a frame."""
    return resolve_frame(str(context.search_parameter("tf_prefix", "") or ""), frame)


def stamp_message(context: Context, kind: str, frame: str = "", ns: Optional[int] = None) -> Any:
    """Make a message whose header has the frame and the sim time `ns` (default: now)."""
    message = context.message(kind)
    message.header.stamp, message.header.frame_id = context.stamp(ns), frame
    return message


def data_message(context: Context, kind: str, data: Any) -> Any:
    """Return a message of a type with the field `data`, such as std_msgs/Bool."""
    message = context.message(kind)
    message.data = data
    return message
