"""Times and durations in messages, as those of ROS."""
from __future__ import annotations

from dataclasses import dataclass

_NS = 10 ** 9


@dataclass
class _Seconds:
    """Whole seconds and nanoseconds."""

    secs: int = 0
    nsecs: int = 0

    def to_sec(self) -> float:
        return self.secs + self.nsecs * 1e-9

    def to_nsec(self) -> int:
        return self.secs * _NS + self.nsecs


@dataclass
class Time(_Seconds):
    """A sim time: whole seconds and nanoseconds since its beginning."""

    @classmethod
    def of_ns(cls, ns: int) -> Time:
        return cls(*divmod(ns, _NS))


@dataclass
class Duration(_Seconds):
    """A length of time: whole seconds, and nanoseconds that are added to them."""

    @classmethod
    def of_ns(cls, ns: int) -> Duration:
        return cls(*divmod(ns, _NS))
