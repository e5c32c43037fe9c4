"""Splines in time, which represent joint trajectories."""
from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import Callable, Tuple

Coefficients = Tuple[float, float, float, float, float, float]
"""c0 + c1 t + ... + c5 t^5, t in s from the beginning of the segment."""


@dataclass(frozen=True)
class Segment:
    """A polynomial from `start` to `end`, s of the spline's own time."""

    start: float
    end: float
    coefficients: Coefficients


@dataclass(frozen=True)
class Spline:
    """Segments in order of time; before the first and after the last one it stands.

    Attributes:
        segments: at least one; a later one takes over where it starts.
        origin: step count at the spline's time 0.
    """

    segments: Tuple[Segment, ...]
    origin: int = 0

    def at_step(self, step: int, step_size: float) -> Tuple[float, float, float]:
        """Position, rate and acceleration at a step count; `step_size` in s."""
        return self.at((step - self.origin) * step_size)

    def index(self, time: float) -> int:
        """The segment that counts at a time, s; the first one before all of them."""
        segments = self.segments
        if len(segments) == 1 or time < segments[1].start:
            return 0
        if time >= segments[-1].start:
            return len(segments) - 1
        return bisect_right([segment.start for segment in segments], time) - 1

    def at(self, time: float) -> Tuple[float, float, float]:
        """Position, rate and acceleration at a time, s."""
        return sample(self.segments[self.index(time)], time)


def sample(segment: Segment, time: float) -> Tuple[float, float, float]:
    """A segment at a time; outside of it its ends, at rest."""
    t = time - segment.start
    c0, c1, c2, c3, c4, c5 = segment.coefficients
    if t < 0.0:
        return c0, 0.0, 0.0
    if time > segment.end:
        t = segment.end - segment.start
        return ((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0, 0.0, 0.0
    return (((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0,
            (((5.0 * c5 * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1,
            ((20.0 * c5 * t + 12.0 * c4) * t + 6.0 * c3) * t + 2.0 * c2)


def step_sampler(spline: Spline, step_size: float) -> Callable[[int], Tuple[float, float]]:
    """A function that gives position and rate at a step count, fast for one step after the other.

    It searches the segment at the end of the previous one, and caches the result of the last step.
    """
    begin, end = math.inf, -math.inf   # when the coefficients count, s
    c0 = c1 = c2 = c3 = c4 = c5 = d2 = d3 = d4 = d5 = 0.0   # of the position, and of the rate
    origin, known_step, known = spline.origin, -1, (0.0, 0.0)

    def find(time: float) -> None:
        nonlocal begin, end, c0, c1, c2, c3, c4, c5, d2, d3, d4, d5
        index = spline.index(time)
        segment, later = spline.segments[index], spline.segments[index + 1:index + 2]
        change = later[0].start if later else math.inf
        if segment.start <= time <= segment.end:
            begin, end = segment.start, min(segment.end, change)
            c0, c1, c2, c3, c4, c5 = segment.coefficients
        else:   # it stands from now on
            begin, end = time, segment.start if time < segment.start else change
            c0, c1, c2, c3, c4, c5 = spline.at(time)[0], 0.0, 0.0, 0.0, 0.0, 0.0
        d2, d3, d4, d5 = 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5

    def at(step: int) -> Tuple[float, float]:
        nonlocal known_step, known
        if step != known_step:
            time = (step - origin) * step_size
            if not begin <= time < end:
                find(time)
            t = time - begin
            known = (((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0,
                     (((d5 * t + d4) * t + d3) * t + d2) * t + c1)
            known_step = step
        return known

    return at


State = Tuple[float, ...]
"""Position; or position and rate; or position, rate and acceleration."""


def segment_between(start: float, before: State, end: float, after: State) -> Segment:
    """The polynomial between two states: linear, cubic or quintic, as both of them say enough for.

    Raises ValueError when it ends before it starts.
    """
    span = end - start
    if span < 0.0:
        raise ValueError("a segment ends before it starts")
    known = min(len(before), len(after))
    p0, p1 = before[0], after[0]
    if known == 1:
        return Segment(start, end, (p0, (p1 - p0) / span if span else 0.0, 0.0, 0.0, 0.0, 0.0))
    v0, v1 = before[1], after[1]
    half = before[2] / 2.0 if known > 2 else 0.0
    if not span:
        return Segment(start, end, (p0, v0, half, 0.0, 0.0, 0.0))
    way = p1 - p0
    if known == 2:
        return Segment(start, end, (p0, v0, (3.0 * way - (2.0 * v0 + v1) * span) / span ** 2,
                                    (-2.0 * way + (v0 + v1) * span) / span ** 3, 0.0, 0.0))
    a0, a1 = before[2] * span ** 2, after[2] * span ** 2
    b0, b1 = v0 * span, v1 * span
    return Segment(start, end, (
        p0, v0, half,
        (20.0 * way - 12.0 * b0 - 8.0 * b1 - 3.0 * a0 + a1) / (2.0 * span ** 3),
        (-30.0 * way + 16.0 * b0 + 14.0 * b1 + 3.0 * a0 - 2.0 * a1) / (2.0 * span ** 4),
        (12.0 * way - 6.0 * (b0 + b1) - a0 + a1) / (2.0 * span ** 5)))


def constant_segment(position: float) -> Segment:
    return Segment(0.0, 0.0, (position, 0.0, 0.0, 0.0, 0.0, 0.0))
