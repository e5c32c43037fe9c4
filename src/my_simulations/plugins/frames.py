"""Names of tf frames under a prefix (source: tf::resolve of ROS 1), and headers with them."""
from __future__ import annotations

from typing import Any, Optional

from .context import Context


def resolve(prefix: str, frame: str) -> str:
    """`/x` is x whatever the prefix; x becomes prefix/x."""
    if frame.startswith("/"):
        return frame[1:]
    prefix = prefix.strip("/")
    return f"{prefix}/{frame}" if prefix else frame


def prefixed(context: Context, frame: str) -> str:
    """A frame under the parameter `tf_prefix` of the plugin's namespace, or of one above."""
    return resolve(str(context.search_parameter("tf_prefix", "") or ""), frame)


def stamped(context: Context, kind: str, frame: str = "", ns: Optional[int] = None) -> Any:
    """A new message whose header has a frame and a sim time (ns); default now."""
    message = context.message(kind)
    message.header.stamp, message.header.frame_id = context.stamp(ns), frame
    return message
