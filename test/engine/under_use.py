"""A world in use: any law of `test/engine` can run in it instead of in an empty one.

Worlds of users differ from those of laws: controllers renew their commands, a wind renews its
forces, other bodies roll, slide, fall, bounce and sleep, steps are longer, and saved worlds have
objects a millimetre inside the ground. `UsedLab` does all of that around a law that is written for
`Lab` and steps of 1 ms.
"""
from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Dict, Iterator, Optional

from company import Company
from conftest import Lab
from laws import Laws, Value

from my_simulations.description.model import Model
from my_simulations.engine.commands import FOREVER, Command, ReadContacts
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort, TimedWrench

MILLISECOND = 0.001
SUNK = 0.001     # m
GUST = 1e-3      # N
GUST_HZ = 10.0   # of its sign: a body that rolls freely comes back to its place
CHANGE = 1e-3    # rad/s or m/s, of commands that change


@dataclass(frozen=True)
class Use:
    """What happens in a world beside a law.

    Attributes:
        step_size: s.
        command_hz: how often the motors' targets change; 0 for never.
        wind: a force of `GUST` on each moving model is renewed each step.
        company: bodies of every kind are elsewhere in the world.
        sunk: what the law loads starts `SUNK` lower, where the law allows it.
    """

    step_size: float
    command_hz: float
    wind: bool = True
    company: bool = True
    sunk: bool = True

    def __str__(self) -> str:
        named = [f"{1e3 * self.step_size:g}ms"]
        named += [f"{self.command_hz:g}Hz"] if self.command_hz else []
        named += [name for name in ("wind", "company", "sunk") if getattr(self, name)]
        return "-".join(named)


USES = (Use(0.001, 100.0), Use(0.002, 50.0), Use(0.005, 20.0), Use(0.01, 100.0))


class UsedLab(Lab):
    """A lab whose world is in use. Laws count in milliseconds, whatever the size of the steps.

    Args:
        use: what happens beside the law.
        sunk: the law allows its models to start in the ground.
        longest: the longest time of one call of `seconds`, s; none for as long as the law says.
    """

    def __init__(self, use: Use, sunk: bool = False, longest: Optional[float] = None) -> None:
        super().__init__()
        self.use = use
        self._sunk, self._longest = use.sunk and sunk, longest
        self._own_steps = False   # the law sets the step size itself, and counts in steps
        self._done = 0            # steps of the engine
        self._motors: Dict[int, JointMotor] = {}
        self._blown: Dict[int, int] = {}
        self._company: Optional[Company] = None
        super().configure(step_size=use.step_size)
        self.backend.read()

    def configure(self, **changes: object) -> None:
        self._own_steps |= "step_size" in changes
        super().configure(**changes)

    def load(self, model: Model, position=(0, 0, 0), *args, **named) -> int:
        moves = not model.static
        if self._sunk and moves:
            position = (position[0], position[1], position[2] - SUNK)
        number = super().load(model, position, *args, **named)
        if moves:
            self._blown[number] = self.rows[number, model.links[0].name]
        for joint in model.joints:
            if joint.axis and joint.axis.motor_rate:
                row = self.joint_rows[number, joint.name]
                self._motors[row] = JointMotor(row, joint.axis.motor_rate, joint.axis.friction)
        return number

    def remove(self, model_id: int) -> None:
        self._blown.pop(model_id, None)
        super().remove(model_id)

    def apply(self, command: Command) -> object:
        if isinstance(command, SetMotors):
            self._motors.update({motor.row: motor for motor in command.motors})
        if isinstance(command, AddTimedForces) and not self._own_steps:
            command = AddTimedForces(tuple(self._in_steps(force) for force in command.forces))
        answer = super().apply(command)
        if isinstance(command, ReadContacts) and self._company is not None:
            answer = tuple(contact for contact in answer
                           if not self._company.rows & {contact.row_a, contact.row_b})
        return answer

    def _in_steps(self, force: "TimedWrench | TimedEffort") -> "TimedWrench | TimedEffort":
        def steps(count: int) -> int:
            return count if count == FOREVER else self._steps_at(count)
        return replace(force, start=steps(force.start), stop=steps(force.stop))

    def _steps_at(self, milliseconds: int) -> int:
        return round(milliseconds * MILLISECOND / self.settings.step_size)

    def steps(self, count: int) -> None:
        if self.use.company and self._company is None:
            self._company = Company(super().load, super().apply, self)
        self.step += count
        end = self._done + count if self._own_steps else self._steps_at(self.step)
        if end == self._done:
            return
        while self._done < end:
            self._disturb()
            self.backend.step(self._done, 1)
            self._done += 1
        self.backend.read()

    def seconds(self, duration: float) -> None:
        duration = min(duration, self._longest or duration)
        count = duration / (self.settings.step_size if self._own_steps else MILLISECOND)
        for _ in range(round(count / 10)):
            self.steps(10)

    def _disturb(self) -> None:
        """Renew commands and forces before a step."""
        time = self._done * self.settings.step_size
        if self.use.command_hz:
            period = max(1, round(1 / self.use.command_hz / self.settings.step_size))
            if self._done % period == 0 and self._motors:
                change = CHANGE * (1 if self._done // period % 2 else -1)
                super().apply(SetMotors(tuple(
                    replace(motor, rate=motor.rate + change * bool(motor.rate))
                    for motor in self._motors.values() if motor.effort)))
        if self.use.wind and self._blown:
            force = GUST * math.cos(2 * math.pi * GUST_HZ * time)
            super().apply(AddTimedForces(tuple(
                TimedWrench(-self._done * len(self._blown) - n - 1, row, self._done, self._done + 1,
                            (0.6 * force, 0.8 * force, 0.0))
                for n, row in enumerate(self._blown.values()))))
        if self._company is not None:
            self._company.act(time)


class UsedLaws(Laws):
    """Compares with the bars of a law, which are three times as wide from steps of 10 ms on."""

    def __init__(self, laws: Laws, use: Use) -> None:
        self._laws, self._use = laws, use
        self._wider = 3.0 if use.step_size >= 0.01 else 1.0

    def near(self, law: str, measured: Value, expected: Value, *, rel: float = 0.0,
             abs: float = 0.0) -> None:
        """As `Laws.near`."""
        self._laws.near(f"in use, {1e3 * self._use.step_size:g} ms: {law}", measured, expected,
                        rel=rel * self._wider, abs=abs * self._wider)


@contextmanager
def used(use: Use, sunk: bool = False, longest: Optional[float] = None) -> Iterator[UsedLab]:
    """A lab in use, closed at the end."""
    lab = UsedLab(use, sunk, longest)
    try:
        yield lab
    finally:
        lab.backend.close()

