"""Reads the signals of a study's expressions from an open world, sample by sample."""
from __future__ import annotations

from typing import Dict, Iterable, List, Sequence

import numpy as np

from ..errors import CommandError
from ..geometry import rpy_from_quat
from ..python_api import ContactReading, OpenWorld
from ..python_api.readings import NamedRows, Readings
from .expressions import JOINT_PARTS, POSE_PARTS, TWIST_PARTS, Samples, Signal
from .variation import Setting

_BODIES = ("pose", "twist", "speed")


class SignalReader:
    """Collects samples.

    Args:
        world: the world that is read.
        signals: the signals to read.
        settings: of the case, for `vary`.

    Raises:
        CommandError: the world has no model, link or axis of a name; also from `add_sample`.
    """

    def __init__(self, world: OpenWorld, signals: Iterable[Signal],
                 settings: Dict[str, Setting]) -> None:
        self._world = world
        self._values: Dict[Signal, List[float]] = {
            signal: [] for signal in sorted(signals, key=lambda s: (s.kind, s.names, s.part))}
        self._values.setdefault(Signal("time"), [])
        self._settings = settings
        kinds = {signal.kind for signal in self._values}
        models = set(world.names)
        bodies = [s.names[0] for s in self._values if s.kind in _BODIES]
        self._joints = "joint" in kinds
        self._contacts = bool(kinds & {"contact", "force"})
        self._models = any(name in models for name in bodies)
        self._links = any(name not in models for name in bodies)
        self._check_pairs(models)

    def add_sample(self) -> None:
        """Add a sample of the present state."""
        world = self._world
        read: List[Readings] = []
        if self._models:
            read.append(world.states())
        if self._links:
            read.append(world.links())
        joints = world.joints() if self._joints else None
        contacts = world.contacts() if self._contacts else []
        for signal, values in self._values.items():
            if signal.kind == "time":
                values.append(world.time)
            elif signal.kind == "vary":
                values.append(_as_number(self._settings[signal.names[0]], signal))
            elif signal.kind == "joint" and joints is not None:
                rows = (joints.position, joints.rate)[JOINT_PARTS.index(signal.part)]
                values.append(float(_row([rows], signal.names[0], "joint axis")))
            elif signal.kind in _BODIES:
                values.append(_of_body(signal, read))
            else:
                values.append(_between(signal, contacts))

    def samples(self) -> Samples:
        return {signal: np.array(values, bool if signal.kind == "contact" else float)
                for signal, values in self._values.items()}

    def _check_pairs(self, models: "set[str]") -> None:
        links = set(self._world.links().names) if self._contacts else set()
        for signal in self._values:
            if signal.kind in ("contact", "force"):
                for name in signal.names:
                    if name not in models and name not in links:
                        raise CommandError(
                            f"{signal.kind}: the world has no model or link '{name}'")


def _of_body(signal: Signal, read: Sequence[Readings]) -> float:
    name = signal.names[0]
    if signal.kind == "pose":
        row = _row([one.pose for one in read], name, "model or link")
        place = POSE_PARTS.index(signal.part)
        if place < 3:
            return float(row[place])
        x, y, z, w = (float(value) for value in row[3:])
        return rpy_from_quat((x, y, z, w))[place - 3]
    row = _row([one.twist for one in read], name, "model or link")
    if signal.kind == "speed":
        return float(np.sqrt(row[:3] @ row[:3]))
    return float(row[TWIST_PARTS.index(signal.part)])


def _row(tables: Sequence[NamedRows], name: str, kind: str) -> np.ndarray:
    for table in tables:
        if name in table:
            return table[name]
    known = ", ".join(sorted(known for table in tables for known in table)[:10])
    raise CommandError(f"the world has no {kind} '{name}'" + (f"; there are {known}" if known
                                                              else ""))


def _between(signal: Signal, contacts: Sequence[ContactReading]) -> float:
    """The force between both, N, or whether they touch."""
    first, second = signal.names
    found = [contact for contact in contacts
             if (_in(contact.links[0], first) and _in(contact.links[1], second))
             or (_in(contact.links[0], second) and _in(contact.links[1], first))]
    if signal.kind == "force":
        return float(sum(contact.force for contact in found))
    return float(bool(found))


def _in(link: str, name: str) -> bool:
    return link == name or link.startswith(name + "::")


def _as_number(value: Setting, signal: Signal) -> float:
    if isinstance(value, (int, float)):
        return float(value)
    raise CommandError(f"'{signal.names[0]}' is {value!r}, which is no number")
