"""Topics and their messages as pages and state logs hold them."""
from __future__ import annotations

import json
import struct
from typing import Any, Dict, Tuple

from ...errors import CommandError
from ..scene.plain_json import to_json
from ..topic_source import ListedTopic

TOPIC = 3
"""Kind of the frames (`frames` of the protocol)."""

_HEAD = struct.Struct("<II")


def encode_frame(head: Dict[str, Any], payload: bytes) -> bytes:
    """A frame of a page; the payload begins at a multiple of 8."""
    text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-(len(text) + _HEAD.size) % 8)
    return _HEAD.pack(TOPIC, len(text)) + text + payload


def decode_frame(frame: bytes) -> Tuple[Dict[str, Any], bytes]:
    """Head and payload of a frame. Raises CommandError for bytes that are no frame."""
    try:
        kind, size = _HEAD.unpack_from(frame)
        head = json.loads(frame[_HEAD.size:_HEAD.size + size])
    except (struct.error, ValueError) as fault:
        raise CommandError(f"invalid frame of a topic: {fault}") from None
    if kind != TOPIC or not isinstance(head, dict):
        raise CommandError("invalid frame of a topic")
    return head, frame[_HEAD.size + size:]


def document_of(topic: ListedTopic) -> Dict[str, Any]:
    """A topic as `Topic` of the protocol, without measured rates."""
    found: Dict[str, Any] = {"name": topic.name, "type": topic.kind,
                             "publishers": topic.publishers, "subscribers": topic.subscribers}
    if topic.model:
        found.update(model=topic.model, driven=topic.driven)
    if topic.link:
        found["mount"] = {"link": topic.link, "pose": to_json(topic.pose)}
    return found
