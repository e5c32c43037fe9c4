"""Runs cases one after the other in the same engine."""
from __future__ import annotations

import hashlib
import math
import threading
from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

import numpy as np

from ..child_process import signal_name
from ..engine.api import Engine
from ..engine.commands import Command
from ..engine.process_engine import ProcessEngine
from ..errors import CommandError, InputError, SimulationError, errors_of
from ..python_api import OpenWorld
from ..python_api.kept_files import FileCache
from ..python_api.world_choice import WorldChoice
from ..simulator.watchdog import process_time, resident_bytes
from .attempts import repeat_after_crash
from .case_output import CaseTrajectory
from .case_world import CASE_ROBOTS, world_choice_of
from .plan import Case, CasePlan
from .row import CRASHED, DIVERGED, FAILED, OK, REFUSED, TIMED_OUT, TOO_LARGE, Row
from .sampling import SignalReader
from .study import Study

_FARTHEST = 1e9  # m: Bullet stops bodies whose bounds it cannot compute, without a message
_SLICE = 1000  # steps between two checks of `stop`

Hook = Callable[[Case, int, OpenWorld], None]
"""Called before a case begins to move, with its attempt and its world."""


class CaseStoppedError(SimulationError):
    """The study was stopped during a case."""


class CaseRefusedError(CommandError):
    """A case that cannot be run with the settings of the study."""


class NoRestartEngine(ProcessEngine):
    """An engine that does not restart after a crash: a case must not continue from a snapshot.

    Attributes:
        death: why it ended; "" while it runs.
    """

    def __init__(self) -> None:
        self.death = ""
        self._started = False
        super().__init__()

    def restart(self) -> None:
        """Start the child process. Raises OSError at the second call."""
        if self._started:
            raise OSError("a study begins the case again in another engine")
        self._started = True
        super().restart()

    def on_death(self, listener: Callable[[str, List[Command]], bool]) -> None:
        def note(reason: str, unanswered: List[Command]) -> bool:
            self.death = reason
            return listener(reason, unanswered)

        super().on_death(note)

    @property
    def ended_by(self) -> str:
        """Name of the signal that ended it; "" if none did."""
        code = self.exit_code
        return signal_name(-code) if code is not None and code < 0 else ""


@dataclass
class _Run:
    """A case that is running, with its results so far."""

    world: OpenWorld
    reader: SignalReader
    steps: int
    times: List[float]
    frames: List[np.ndarray]
    names: Tuple[str, ...] = ()
    rows: Optional[List[int]] = None


class Slot:
    """Runs one case at a time, for one thread.

    Args:
        plan: of the study.
        processor: model of the processor, for rows.
        stop: ends the case that runs with CaseStoppedError once it is set.
        files: reads worlds and models, for all slots.
        hook: for tests.
    """

    def __init__(self, plan: CasePlan, processor: str, stop: threading.Event, files: FileCache,
                 hook: Optional[Hook] = None) -> None:
        self._plan = plan
        self._study: Study = plan.study
        self._processor = processor
        self._stop = stop
        self._files = files
        self._hook = hook
        self._world: Optional[OpenWorld] = None
        self._engine: Optional[NoRestartEngine] = None
        self._guard = threading.Lock()
        self._began: Optional[float] = None  # processor time of the engine as the case began
        self._opened_world = False  # of the case that runs
        self._excess = ""  # the status of a case that has used up a limit

    def close(self) -> None:
        if self._world is not None:
            self._world.close()
        self._world = self._engine = None

    def enforce_limits(self) -> None:
        """End the engine if its case has used up its processor time or memory.

        Called from another thread.
        """
        limits = self._study.limits
        with self._guard:
            engine = self._engine
            if self._began is None or engine is None or self._excess:
                return
            if _read_processor_time(engine) - self._began > limits.processor_seconds:
                self._excess = TIMED_OUT
            elif resident_bytes(engine.pid) > limits.memory_mb * 1e6:
                self._excess = TOO_LARGE
            if self._excess:
                engine.kill("the case has used up a limit of the study")

    def run(self, case: Case) -> Tuple[Row, Optional[CaseTrajectory]]:
        """Run a case; once more in a new engine if its engine crashes.

        Raises CaseStoppedError: `stop` was set; there is no result.
        """
        def attempt(number: int) -> Tuple[Row, Optional[CaseTrajectory]]:
            row, trajectory = self._attempt(case, number)
            if row.status == CRASHED:
                self.close()
            return row, trajectory
        return repeat_after_crash(self._study.limits.attempts, attempt)

    def _attempt(self, case: Case, attempt: int) -> Tuple[Row, Optional[CaseTrajectory]]:
        row = Row(OK, case.id, case.index, case.seed, dict(case.settings), attempt=attempt,
                  processor=self._processor)
        with self._guard:
            self._excess = ""
            self._began = _read_processor_time(self._engine) if self._engine is not None else 0.0
        began = self._began
        self._opened_world = False
        trajectory = None
        try:
            trajectory = self._measure_case(case, row)
        except InputError as fault:
            row.status, row.issue = REFUSED, str(fault.first)
        except CaseRefusedError as fault:
            row.status, row.issue = REFUSED, str(fault)
        except CommandError as fault:
            row.status, row.issue = FAILED, str(fault)
        with self._guard:
            self._began = None
        self._judge(row, began)
        return row, trajectory if row.status == OK or row.values else None

    def _judge(self, row: Row, began: float) -> None:
        engine = self._engine
        if engine is None:
            return
        if self._opened_world:  # else the engine shows the case before
            row.step = row.step or engine.ring.step
        if engine.exit_code is None and not self._excess:
            row.seconds = round(_read_processor_time(engine) - began, 2)
            return
        row.status, row.values, row.hash = self._excess or CRASHED, {}, ""
        row.signal, row.issue = engine.ended_by, engine.death or "the physics engine ended"
        limits = self._study.limits
        if self._excess == TIMED_OUT:
            row.signal = ""
            row.issue = f"used up its processor time of {limits.processor_seconds:g} s"
            row.seconds = limits.processor_seconds
        elif self._excess:
            row.signal, row.issue = "", f"used more memory than {limits.memory_mb:g} MB"
        self.close()

    # -- one attempt -----------------------------------------------------------------------------

    def _measure_case(self, case: Case, row: Row) -> Optional[CaseTrajectory]:
        """Run the case and fill its row."""
        study = self._study
        world = self._open_world(case)
        self._opened_world = True
        if self._hook is not None:
            self._hook(case, row.attempt, world)
        expressions = study.measure + study.require
        steps = round(study.duration / world.step_size)
        if steps > study.limits.steps:
            raise CaseRefusedError(
                f"the case needs {steps} steps, the limit is {study.limits.steps}")
        if steps < 1:
            raise CaseRefusedError(
                f"the duration of {study.duration:g} s is less than half a step of"
                               f" {world.step_size:g} s: there is no step to make")
        signals = [signal for _, expression in expressions for signal in expression.signals]
        run = _Run(world, SignalReader(world, signals, case.settings), steps, [], [])
        self._make_steps(run, any(expression.sampled for _, expression in expressions))
        # The reply follows all events of the engine, such as a diverged state.
        world.contacts()
        samples = run.reader.samples()
        row.step, row.hash = steps, final_hash(world)
        row.values = {name: expression.value(samples) for name, expression in expressions}
        row.issue = _divergence(world)
        missed = [name for name, _ in study.require if not row.values[name]]
        faults = errors_of(world.issues)  # since the world was opened, such as of a plugin
        if row.issue:
            row.status = DIVERGED
        elif faults:
            row.status, row.issue = FAILED, str(faults[0])
        elif missed:
            row.status, row.issue = FAILED, f"required, and not so: {', '.join(missed)}"
        if study.trajectory is None:
            return None
        return CaseTrajectory(np.array(run.times), run.names, np.array(run.frames))

    def _open_world(self, case: Case) -> OpenWorld:
        choice, changes = world_choice_of(self._plan, case)
        if self._world is None:
            self._world = self._in_new_engine(choice)
        else:
            self._world.open(choice)
        world = self._world
        faults = errors_of(world.issues)
        if faults:
            raise InputError(faults)
        unused = changes.unused()
        if unused:
            raise CaseRefusedError("the world has no '" + "', '".join(unused) + "' to vary; its"
                                   f" models are {', '.join(sorted(world.names)[:10])}")
        return world

    def _in_new_engine(self, choice: WorldChoice) -> OpenWorld:
        try:
            return OpenWorld(choice, engine=self._new_engine, files=self._files,
                             robots=CASE_ROBOTS)
        except BaseException:
            with self._guard:  # it was closed; that is no crash unless it had died before
                if self._engine is not None and not (self._engine.death or self._excess):
                    self._engine = None
            raise

    def _new_engine(self) -> Engine:
        engine = NoRestartEngine()
        with self._guard:
            self._engine = engine
            self._began = 0.0
        return engine

    def _make_steps(self, run: _Run, sampled: bool) -> None:
        """Make all steps; take samples and frames on the way."""
        study, world = self._study, run.world
        sample = _interval(study.sample, world) if sampled else run.steps
        frame = _interval(study.trajectory.every, world) if study.trajectory else 0
        run.reader.add_sample()
        self._add_frame(run)
        done = 0
        while done < run.steps:
            ends = [run.steps, done + _SLICE, done + sample - done % sample]
            if frame:
                ends.append(done + frame - done % frame)
            world.step(min(ends) - done)
            done = min(ends)
            if self._stop.is_set():
                raise CaseStoppedError
            if done % sample == 0 or done == run.steps:
                run.reader.add_sample()
            if frame and (done % frame == 0 or done == run.steps):
                self._add_frame(run)

    def _add_frame(self, run: _Run) -> None:
        wanted = self._study.trajectory
        if wanted is None:
            return
        states = run.world.states()
        if run.rows is None:
            run.names = wanted.models or states.names
            missing = [name for name in run.names if name not in states.pose]
            if missing:
                raise CommandError(f"the world has no model '{missing[0]}' whose trajectory"
                                   " could be kept")
            run.rows = [states.names.index(name) for name in run.names]
        run.times.append(states.time)
        run.frames.append(states.pose.array[run.rows])


def final_hash(world: OpenWorld) -> str:
    """A hash of all bits of the poses and twists of links and the states of joint axes."""
    links, joints = world.links(), world.joints()
    digest = hashlib.sha256("\0".join(links.names + joints.names).encode())
    for rows in (links.pose, links.twist, joints.position, joints.rate):
        digest.update(np.ascontiguousarray(rows.array, dtype="<f8").tobytes())
    return digest.hexdigest()[:32]


def _divergence(world: OpenWorld) -> str:
    """Return the issue of a diverged state or of a link that is too far away; "" for none."""
    for issue in world.issues:
        if issue.code == "state-diverged":
            return issue.message
    pose = world.links().pose
    far = ~(np.abs(pose.array[:, :3]) < _FARTHEST).all(axis=1)
    return f"{pose.names[int(np.argmax(far))]} is farther than {_FARTHEST:g} m" if far.any() else ""


def _interval(seconds: float, world: OpenWorld) -> int:
    return max(1, int(math.floor(seconds / world.step_size + 0.5)))


def _read_processor_time(engine: ProcessEngine) -> float:
    """Processor time of the engine in s."""
    found = process_time(engine.pid)
    return found[0] if found else 0.0
