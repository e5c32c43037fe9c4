"""Topics of a program that resemble topics of the world, but have another name."""
from __future__ import annotations

import difflib
from typing import Iterable, List, Sequence, Set, Tuple

_WORLD = "/gazebo"
_SHARED = {"/rosout", "/rosout_agg", "/tf", "/tf_static", "/clock"}
_ALIKE = 0.8   # ratio of difflib

Registered = Sequence[Tuple[str, Sequence[str]]]
"""Topics and the nodes that publish or subscribe to each, as the ROS master returns them."""


def misnamed_topics(publishers: Registered, subscribers: Registered) -> List[str]:
    """Return a sentence for each topic that only the program uses, if the world has a similar one.

    The others are of no interest.
    """
    found = []
    for own, other, fault in (
            (publishers, subscribers, "publishes {}, which nothing subscribes to"),
            (subscribers, publishers, "subscribes to {}, which nothing publishes")):
        used = {topic for topic, nodes in other if nodes}
        offered = {topic for topic, nodes in other if _WORLD in nodes}
        for topic, nodes in sorted(own):
            if topic in used or topic in _SHARED or _WORLD in nodes:
                continue
            meant = _similar(topic, offered)
            if meant:
                found.append(f"the program {fault.format(topic)}; did you mean {meant}?")
    return found


def _similar(topic: str, offered: Set[str]) -> str:
    """A topic with the same last part, or with a similar name; "" for none."""
    last = _last_part(topic)
    same = sorted(name for name in offered if _last_part(name) == last)
    near: Iterable[str] = same or difflib.get_close_matches(topic, sorted(offered), 1, _ALIKE)
    return next(iter(near), "")


def _last_part(topic: str) -> str:
    return topic.rsplit("/", 1)[-1]
