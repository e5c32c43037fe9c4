"""Names of tf frames under a prefix. Source: tf::resolve of ROS 1."""
from __future__ import annotations


def resolve(prefix: str, frame: str) -> str:
    """`/x` is x whatever the prefix; x becomes prefix/x."""
    if frame.startswith("/"):
        return frame[1:]
    prefix = prefix.strip("/")
    return f"{prefix}/{frame}" if prefix else frame
