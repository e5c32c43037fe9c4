"""Topics and services of robots in an open world."""
from __future__ import annotations

from collections import deque
from typing import Any, Callable, Deque, Dict, Iterator, List, Mapping, Optional

from ..errors import CommandError
from ..messages.message_types import Message
from ..plugins.local_graph import LocalGraph, resolve_name
from .plain_values import name_of, number_of

_KEPT = 1000      # messages for `take`
_PATIENCE_S = 10.0


class Topic:
    """A topic that is listened to since it was first looked up in `OpenWorld.topics`.

    Messages are copies, with NumPy arrays. After `OpenWorld.step` all messages have arrived that
    were due by then.

    Attributes:
        name: with a leading slash.
        is_closed: whether it was closed; a look-up in `OpenWorld.topics` begins to listen again.
    """

    def __init__(self, graph: LocalGraph, name: str, advance: Callable[[int], None],
                 step_size: Callable[[], float], explain_silence: Callable[[], str]) -> None:
        self.name = name
        self._graph, self._advance, self._step_size = graph, advance, step_size
        self._explain_silence = explain_silence
        self._latest: Optional[Message] = None
        self._count = 0
        self._kept: Deque[Message] = deque(maxlen=_KEPT)
        self.is_closed = False
        self._end = graph.listen(name, self._receive_message)

    def __repr__(self) -> str:
        return f"Topic({self.name!r}, {self.kind!r}, count={self._count})"

    @property
    def kind(self) -> str:
        """The type of the messages, such as `sensor_msgs/LaserScan`; "" while it is unknown."""
        return self._graph.topics().get(self.name, "")

    @property
    def count(self) -> int:
        """How many messages have arrived."""
        return self._count

    @property
    def latest(self) -> Any:
        """The last message. Raises CommandError if none has arrived since the first look-up."""
        if self._latest is None:
            raise CommandError(f"no message has arrived on {self.name} since the topic was looked"
                               f" up: make steps, or call wait(){self._explain_silence()}")
        return self._latest

    def take(self) -> List[Any]:
        """Return the messages that have arrived since the last call, at most the last 1000."""
        taken = []
        while self._kept:
            taken.append(self._kept.popleft())
        return taken

    def wait(self, seconds: float = _PATIENCE_S) -> Any:
        """Make steps until the next message arrives, and return it.

        Args:
            seconds: of sim time; CommandError if no message has arrived by then.
        """
        number_of(seconds, "the time to wait")
        before = self._count
        for _ in range(max(1, round(seconds / self._step_size()))):
            self._advance(1)
            if self._count > before:
                return self.latest
        raise CommandError(f"no message arrived on {self.name} in {seconds:g} s of sim time"
                           + self._explain_silence())

    def close(self) -> None:
        """Stop listening: robots do not compute what nothing listens to."""
        self.is_closed = True
        self._end()

    def forget(self) -> None:
        """Remove the messages; the world begins again."""
        self._latest, self._count = None, 0
        self._kept.clear()

    def _receive_message(self, message: Message) -> None:
        self._latest = message
        self._kept.append(message)
        self._count += 1


class Topics(Mapping[str, Topic]):
    """The topics of the robots by name; a look-up begins to listen.

    Args:
        graph: of the robots.
        advance: makes a number of steps.
        step_size: of the world, s.
        wait_until_loaded: has the plugins of new models loaded.
        explain_silence: why plugins may not publish, to be appended to a message.
    """

    def __init__(self, graph: LocalGraph, advance: Callable[[int], None],
                 step_size: Callable[[], float], wait_until_loaded: Callable[[], None],
                 explain_silence: Callable[[], str]) -> None:
        self._graph, self._advance, self._step_size = graph, advance, step_size
        self._wait_until_loaded, self._explain_silence = wait_until_loaded, explain_silence
        self._open: Dict[str, Topic] = {}

    def __getitem__(self, name: str) -> Topic:
        full = resolve_name(name_of(name, "the name of a topic"))
        if full not in self._open or self._open[full].is_closed:
            kinds = self.kinds()
            if full not in kinds:
                raise CommandError(f"there is no topic {full}; topics are"
                                   f" {', '.join(kinds) or 'none'}{self._explain_silence()}")
            self._open[full] = Topic(self._graph, full, self._advance, self._step_size,
                                     self._explain_silence)
        return self._open[full]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and resolve_name(name) in self.kinds()

    def __iter__(self) -> Iterator[str]:
        return iter(self.kinds())

    def __len__(self) -> int:
        return len(self.kinds())

    def kinds(self) -> Dict[str, str]:
        """The types of all topics, by name; this does not begin to listen."""
        self._wait_until_loaded()
        return self._graph.topics()

    def forget(self) -> None:
        """Remove the messages; the world begins again."""
        for topic in self._open.values():
            topic.forget()
