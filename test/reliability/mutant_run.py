"""Feeds changed inputs to a reader, keeps those that show something new, and notes all faults."""
from __future__ import annotations

import hashlib
import json
import os
import re
import signal
import time
import traceback
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any, Callable, Dict, Hashable, Iterable, Iterator, List, Optional, Set, Tuple

from heap import memory
from proofs import IS_LONG, allowance, per_second, spent

LONGEST_S = 1.0
"""Processor time of one input, in seconds."""

AT_ONCE = 20_000
"""Inputs of a round; the next one has a seed of its own, and half of what was found."""

MOST_GROWN, MOST_FEATURES = 500, 20_000
LARGEST = 6000
"""Characters of an input that others are made of: small ones are read fast."""

SETTLED = 0.25
"""Share of a run after which neither memory nor the number of kept inputs may grow."""

_VARIES = re.compile(r"'[^']*'|\"[^\"]*\"|-?\d[\d.e+-]*|nan|inf")
MOST_FAULTS = 20
REPORT_S = 60.0
GROWTH = 1.05


class TooLongError(BaseException):
    """An input took longer than it may; no reader must catch it."""


@dataclass
class Target:
    """A reader or a door.

    Attributes:
        name: of the proof.
        seeds: the inputs that others are made of.
        change: another input made of one.
        encode: makes the argument of `feed` from an input.
        feed: reads an encoded input and returns its features, such as codes of issues. Raises for
            a fault.
        renew: called before each round.
        suffix: of the file that keeps an input.
        made: how inputs are made, before the name in the table.
        kept_bytes: what libxml2 may keep of an input for ever: names that it had not met.
    """

    name: str
    seeds: List[Any]
    change: Callable[[Any, Random], Any]
    encode: Callable[[Any, Random], Any]
    feed: Callable[[Any], Iterable[Hashable]]
    renew: Callable[[], None] = lambda: None
    suffix: str = ""
    made: str = "changed inputs: "
    kept_bytes: float = 0.0


@dataclass
class Run:
    """The results of a run.

    Attributes:
        growth: of memory since the run has settled, as a share of that.
        kept_bytes: the same, for each input since.
        faults: by the place that raised, what and which file has the input.
    """

    inputs: int = 0
    slowest: float = 0.0
    fed: float = 0.0
    growth: float = 0.0
    kept_bytes: float = 0.0
    faults: Dict[str, str] = field(default_factory=dict)
    features: int = 0
    per_second: int = 0

    def figures(self) -> Dict[str, Any]:
        return {"inputs": self.inputs, "per_second": self.per_second,
                "slowest_ms": round(1000 * self.slowest), "kinds_of_answers": self.features,
                "growth_percent": round(100 * self.growth, 1),
                "kept_bytes": round(self.kept_bytes), "faults": len(self.faults)}


def run(target: Target, inputs: int, seed: int, folder: Path,
        report: Optional[Callable[[Run], None]] = None) -> Run:
    """Feed so many inputs, or as many as may be; a seed stands for the same inputs again.

    Args:
        folder: keeps what a reader failed with.
        report: hears now and then how far it is.
    """
    done, used, start = Run(), allowance(), spent()
    seen: Set[int] = set()
    grown: List[Tuple[Any, int]] = []
    before, told, number, most = 0, time.monotonic(), 0, MOST_GROWN
    settled = 0
    while done.inputs < inputs and used() < 1.0 and len(done.faults) < MOST_FAULTS:
        chance = Random(f"{seed} {number}")
        number += 1
        target.renew()
        corpus = target.seeds + [one for one, _ in chance.sample(grown, len(grown) // 2)]
        for _ in range(min(AT_ONCE, inputs - done.inputs)):
            if done.inputs % 64 == 0 and used() >= 1.0:
                break
            try:
                made = target.change(corpus[int(len(corpus) * chance.random())], chance)
                data = target.encode(made, chance)
            except RecursionError:  # too deep for what writes it down
                continue
            features = _fed(target, data, done, folder, seed)
            done.inputs += 1
            new = {hash(one) for one in features} - seen
            if new and len(seen) < MOST_FEATURES:
                seen |= new
                if not isinstance(data, (str, bytes)) or len(data) < LARGEST:
                    _put(made, corpus, len(target.seeds) + most, chance)
                    _keep_small((made, len(as_bytes(data))), grown, most, chance)
            if not before and max(used(), done.inputs / inputs) > SETTLED:
                before, most, settled = memory(), len(grown), done.inputs
        done.features = len(seen)
        done.per_second = per_second(done.inputs, start)
        if before:
            more = memory() - before
            done.growth = more / before
            done.kept_bytes = 1024 * more / max(1, done.inputs - settled)
        if report is not None and time.monotonic() > told + REPORT_S:
            told = time.monotonic()
            report(done)
    return done


def _put(made: Any, into: List[Any], most: int, chance: Random) -> None:
    """Append an input, or put it where one of the others was; the first ones are the oldest."""
    if len(into) < most:
        into.append(made)
    elif into:
        into[chance.randrange(len(into) // 2, len(into))] = made


def _keep_small(made: Tuple[Any, int], into: List[Tuple[Any, int]], most: int,
                chance: Random) -> None:
    """As `_put`, for an input and its size; one that is replaced was as large, or larger.

    Otherwise kept inputs would grow during a run, and look like memory that a reader leaks.
    """
    if len(into) < most:
        into.append(made)
    elif into:
        old = chance.randrange(len(into) // 2, len(into))
        if made[1] <= into[old][1]:
            into[old] = made


def _fed(target: Target, data: Any, done: Run, folder: Path, seed: int) -> Iterable[Hashable]:
    began = time.process_time()
    try:
        with _watched():
            return target.feed(data)
    except (Exception, TooLongError) as defect:
        _keep(target, data, defect, done, folder, seed)
        return ()
    finally:
        took = time.process_time() - began
        done.fed += took
        done.slowest = max(done.slowest, took)


@contextmanager
def _watched() -> Iterator[None]:
    """Raises TooLongError in what takes longer, once it is back in Python."""
    signal.setitimer(signal.ITIMER_PROF, LONGEST_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def _too_long(_number: int, _frame: Any) -> None:
    raise TooLongError(f"more than {LONGEST_S:g} s of processor time")


@contextmanager
def watchdog() -> Iterator[None]:
    """Handle the timer signal of `run`; for the main thread."""
    before = signal.signal(signal.SIGPROF, _too_long)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _keep(target: Target, data: Any, defect: BaseException, done: Run, folder: Path,
          seed: int) -> None:
    frames = traceback.extract_tb(defect.__traceback__)
    ours = [one for one in frames if "my_simulations" in one.filename] or frames
    said = f" ({shape(str(defect))})" if isinstance(defect, AssertionError) else ""
    file = os.path.basename(ours[-1].filename)
    place = f"{type(defect).__name__}{said} at {file}:{ours[-1].lineno}"
    if place in done.faults:
        return
    folder.mkdir(parents=True, exist_ok=True)
    content = as_bytes(data)
    digest = hashlib.sha1(content).hexdigest()[:10]
    name = f"{target.name.replace(' ', '_')}-{digest}"
    path = folder / f"{name}{target.suffix}"
    path.write_bytes(content)
    path.with_suffix(".trace").write_text(
        f"seed {seed}, input {done.inputs}\n" + "".join(traceback.format_exception(
            type(defect), defect, defect.__traceback__)), encoding="utf-8", errors="replace")
    done.faults[place] = f"{defect!r:.300} (seed {seed}, input {done.inputs}): see {path}"


def shape(text: str) -> str:
    """A text without names and numbers, so that answers of one kind are alike."""
    return _VARIES.sub("#", text)[:80]


def as_bytes(data: Any) -> bytes:
    """An input as it is kept in a file."""
    if isinstance(data, tuple) and isinstance(data[-1], bytes):
        data = data[-1]
    if isinstance(data, bytes):
        return data
    if isinstance(data, str):
        return data.encode("utf-8", "surrogatepass")
    try:
        return json.dumps(data, indent=1).encode()
    except (TypeError, ValueError):
        return repr(data).encode("utf-8", "replace")


def prove(target: Target, inputs: int, record: Callable[..., None], folder: Path,
          **more: Callable[[], Any]) -> None:
    """Run, record the figures (in a long run also on the way), fail for faults and growth."""
    seed = int(os.environ.get("MY_SIMULATIONS_SEED") or (time.time() if IS_LONG else 2026))

    def tell(done: Run) -> None:
        record(f"{target.made}{target.name}", **done.figures(),
               **{name: value() for name, value in more.items()})

    with watchdog():
        done = run(target, inputs, seed, folder, tell)
    tell(done)
    assert not done.faults, "\n".join(f"{place}: {text}" for place, text in done.faults.items())
    assert done.slowest < LONGEST_S
    if IS_LONG:
        # A heap may find its size, by a twentieth; what each input leaves behind is bounded.
        assert done.growth < GROWTH - 1.0 or done.kept_bytes < target.kept_bytes, (
            f"memory grew by {100 * done.growth:.1f} %, {done.kept_bytes:.0f} bytes an input")
