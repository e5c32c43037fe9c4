"""Samples of the contacts between the fingers of a gripper and objects."""
from __future__ import annotations

from typing import Dict, List, NamedTuple, Sequence

from ...geometry import Vec3, add, inverse, scale, transform
from ..call_slot import CallSlot
from ..context import Context

_LEAST_FORCE = 1e-6  # N: a contact that does not press
_SAMPLE_HZ = 100.0   # of contacts between two updates


class FingerForce(NamedTuple):
    """Force of a finger on an object, N, world axes, and its point of application, m."""

    finger: str
    force: Vec3
    point: Vec3  # in the finger's frame


FingerForces = Dict[str, Dict[str, FingerForce]]
"""Forces by the scoped names of the object's link and of the finger."""


class FingerContacts:
    """The mean contact forces of fingers since the last update of a plugin.

    The plugin's updates are rare; while a finger touches an object, contacts are also sampled
    between them. Objects are links of other models that are not static.

    Args:
        context: that of the plugin.
        fingers: the names of the links.
        hertz: the rate of the plugin's updates; 0 for every step.
    """

    def __init__(self, context: Context, fingers: Sequence[str], hertz: float) -> None:
        self._context, self._fingers = context, fingers
        self._is_rare = 0.0 < hertz < _SAMPLE_HZ
        self._sampled: Dict[str, Dict[str, List[FingerForce]]] = {}
        self._samples = CallSlot()
        self._step = -1

    def clear(self) -> None:
        """Drop all samples, and make none before the next update."""
        self._sampled = {}
        self._samples.end()

    def take(self) -> FingerForces:
        """Return the mean forces on objects that exist, those of the last step included."""
        self._sample()
        taken, self._sampled = self._sampled, {}
        if not taken:
            self._samples.end()
        elif self._is_rare and not self._samples.is_active:
            self._samples.set(self._context.every(_SAMPLE_HZ, self._sample))
        models = self._context.models() if taken else {}
        return {name: {finger: _mean(forces) for finger, forces in by_finger.items()}
                for name, by_finger in taken.items() if name.partition("::")[0] in models}

    def _sample(self) -> None:
        """Add the contacts of the last step, once."""
        if self._context.step == self._step:
            return
        self._step = self._context.step
        for name, by_finger in self._read_forces().items():
            known = self._sampled.setdefault(name, {})
            for finger, force in by_finger.items():
                known.setdefault(finger, []).append(force)

    def _read_forces(self) -> FingerForces:
        context = self._context
        prefix, models = f"{context.model}::", context.models()
        parts = {context.scoped(name): name for name in self._fingers}
        found: FingerForces = {}
        for one, other, contact in context.contacts():
            for mine, theirs, sign in ((one, other, -1.0), (other, one, 1.0)):
                if (mine not in parts or theirs.startswith(prefix)
                        or contact.force <= _LEAST_FORCE):
                    continue
                model = models.get(theirs.partition("::")[0])
                if model is None or model.static:
                    continue
                force = scale(add(scale(contact.normal, contact.force), contact.friction), sign)
                before = found.setdefault(theirs, {}).get(mine)
                if before is not None:
                    force = add(before.force, force)
                finger = context.link(parts[mine]).pose
                found[theirs][mine] = FingerForce(
                    parts[mine], force, transform(inverse(finger), contact.position))
        return found


def _mean(forces: List[FingerForce]) -> FingerForce:
    """Return the mean of the forces of one finger on one object."""
    share, force, point = 1.0 / len(forces), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for one in forces:
        force, point = add(force, one.force), add(point, one.point)
    return FingerForce(forces[0].finger, scale(force, share), scale(point, share))
