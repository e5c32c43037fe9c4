"""libgazebo_grasp_fix.so: a gripped object is fixed to the palm.

Parameters and defaults are those of gazebo_grasp_plugin. An object that is pressed from opposite
sides in more than `grip_count_threshold` updates is fixed to the palm, and released when a finger
has moved back by more than `release_tolerance`. An update takes the mean of the finger forces since
the previous one: in the original of every step, here of 100 samples per second during a contact.
Where it differs: held objects still collide (`<disable_collisions_on_attach>`).
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Tuple

from ...geometry import Vec3, add, conjugate, dot, inverse, norm, rotate, scale, subtract, transform
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import PluginError
from ..parameters import Parameters

_FORGET = 1e-6  # N: a contact that does not press
_COUNTS = 10    # the usual most of counts
_SAMPLE_HZ = 100.0  # of contacts between two updates
_LEAST_RATIO = 0.3  # of two forces that oppose each other, and the smallest, N: gazebo_grasp_plugin
_LEAST_FORCE = 1e-4


class FingerForce(NamedTuple):
    """Force of a finger on an object, N, world axes, and its point of application, m."""

    finger: str
    force: Vec3
    point: Vec3  # in the finger's frame


FingerForces = Dict[str, Dict[str, List[FingerForce]]]
"""Sampled forces by the link of the object and the finger."""


@dataclass
class Arm:
    """A gripper.

    Attributes:
        pressed: since the last update.
        counts: updates with a grip minus updates without, by the scoped link name of the object.
        held: the object that is fixed to the palm; "" for none.
        marks: of each finger that held it, where it touched (in the finger and in the palm frame)
            and which way it pressed (in the palm frame).
    """

    name: str
    palm: str
    fingers: List[str]
    pressed: FingerForces = field(default_factory=dict)
    counts: Dict[str, int] = field(default_factory=dict)
    held: str = ""
    marks: List[Tuple[str, Vec3, Vec3, Vec3]] = field(default_factory=list)


class GraspFix(Plugin):
    """Watches the fingers of one or more arms."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        if not p.children("arm"):
            raise PluginError("it has no <arm>")
        self._arms: List[Arm] = []
        for one in p.children("arm"):
            try:
                self._arms.append(self._arm(one))
            except PluginError as fault:
                context.warn(f"{fault}; this <arm> does nothing")
        if not self._arms:
            raise PluginError("none of its <arm>s can hold anything")
        self._least_angle = math.radians(p.number("forces_angle_tolerance", 120.0))
        self._most = p.integer("max_grip_count", _COUNTS)
        self._threshold = p.integer("grip_count_threshold", self._most // 2)
        if "max_grip_count" not in p:  # there a threshold of the usual most is never passed
            self._most = max(self._most, 2 * self._threshold)
        self._release = p.number("release_tolerance", 0.005)
        if p.flag("disable_collisions_on_attach", False):
            context.warn("<disable_collisions_on_attach> has no effect: held objects still collide")
        hertz = p.number("update_rate", 5.0)
        self._rare = 0.0 < hertz < _SAMPLE_HZ
        self._samples = CallSlot()
        self._step = -1
        context.every(hertz, self.update)

    def _arm(self, p: Parameters) -> Arm:
        name, palm = p.text("arm_name", "default_arm"), p.text("palm_link")
        named = [one for one in p.texts("gripper_link") if one]
        if not palm or not named:
            raise PluginError(f"arm '{name}' has no <palm_link> or no <gripper_link>")
        if any(arm.name == name for arm in self._arms):
            raise PluginError(f"there is an arm '{name}' already")
        self.context.link(palm)
        fingers: List[str] = []
        for finger in named:
            try:
                self.context.link(finger)
                fingers.append(finger)
            except PluginError as fault:
                self.context.warn(f"arm '{name}': {fault}; this <gripper_link> does nothing")
        if not fingers:
            raise PluginError(f"arm '{name}' has no <gripper_link> that there is")
        return Arm(name, palm, fingers)

    def reset(self) -> None:
        """Clear the contacts and the held objects of all arms."""
        for arm in self._arms:
            arm.pressed, arm.counts, arm.held, arm.marks = {}, {}, "", []

    def update(self) -> None:
        """Evaluate the contacts of the last step and those sampled since the last update."""
        self._sample()
        self._sample_on(any(arm.pressed for arm in self._arms))
        models = self.context.models()
        for arm in self._arms:
            pressed, arm.pressed = arm.pressed, {}
            if not arm.held:
                self._count(arm, {name: [_mean(presses) for presses in by_finger.values()]
                                  for name, by_finger in pressed.items()
                                  if name.partition("::")[0] in models})
            elif arm.held.partition("::")[0] not in models or self._has_opened(arm):
                self._drop_object(arm)

    def _sample_on(self, touches: bool) -> None:
        """Start or stop the sampling of contacts between updates."""
        if touches and self._rare and not self._samples.is_active:
            self._samples.set(self.context.every(_SAMPLE_HZ, self._sample))
        elif not touches:
            self._samples.end()

    def _sample(self) -> None:
        """Take the contacts of the last step, once."""
        if self.context.step == self._step:
            return
        self._step = self.context.step
        free = [arm for arm in self._arms if not arm.held]
        contacts = self.context.contacts() if free else []
        for arm in free:
            for name, by_finger in self._collect_presses(arm, contacts).items():
                known = arm.pressed.setdefault(name, {})
                for finger, press in by_finger.items():
                    known.setdefault(finger, []).append(press)

    def _collect_presses(self, arm: Arm, contacts: list) -> Dict[str, Dict[str, FingerForce]]:
        """What presses movable links of other models, by their names and by those of fingers."""
        prefix, models = f"{self.context.model}::", self.context.models()
        parts = {self.context.scoped(name): name for name in arm.fingers}
        found: Dict[str, Dict[str, FingerForce]] = {}
        for one, other, contact in contacts:
            for mine, theirs, sign in ((one, other, -1.0), (other, one, 1.0)):
                if mine not in parts or theirs.startswith(prefix) or contact.force <= _FORGET:
                    continue
                model = models.get(theirs.partition("::")[0])
                if model is None or model.static:
                    continue
                force = scale(add(scale(contact.normal, contact.force), contact.friction), sign)
                before = found.setdefault(theirs, {}).get(mine)
                if before is not None:
                    force = add(before.force, force)
                finger = self.context.link(parts[mine]).pose
                found[theirs][mine] = FingerForce(parts[mine], force,
                                            transform(inverse(finger), contact.position))
        return found

    def _count(self, arm: Arm, pressed: Dict[str, List[FingerForce]]) -> None:
        gripped = {name for name, presses in pressed.items() if self._are_opposed(presses)}
        for name in gripped | set(arm.counts):
            arm.counts[name] = min(self._most, arm.counts.get(name, 0) + 1) if name in gripped \
                else arm.counts[name] - 1
        arm.counts = {name: count for name, count in arm.counts.items() if count > 0}
        for name in sorted(gripped):
            if arm.counts[name] > self._threshold:
                self._hold(arm, name, pressed[name])
                return

    def _are_opposed(self, presses: List[FingerForce]) -> bool:
        for n, one in enumerate(presses):
            for other in presses[n + 1:]:
                less, more = sorted((norm(one.force), norm(other.force)))
                if less < _LEAST_FORCE or less < _LEAST_RATIO * more:
                    continue
                cosine = dot(one.force, other.force) / (less * more)
                if math.acos(max(-1.0, min(1.0, cosine))) > self._least_angle:
                    return True
        return False

    def _hold(self, arm: Arm, name: str, presses: List[FingerForce]) -> None:
        context, palm = self.context, self.context.link(arm.palm).pose
        context.attach(self._joint(arm), context.scoped(arm.palm), name)
        arm.held = name
        arm.marks = []
        for press in presses:
            if press.finger == arm.palm:
                continue
            finger = context.link(press.finger).pose
            arm.marks.append((press.finger, press.point,
                              transform(inverse(palm), transform(finger, press.point)),
                              rotate(conjugate(palm.orientation),
                                     scale(press.force, 1.0 / norm(press.force)))))
        context.info(f"arm '{arm.name}' holds {name}")

    def _has_opened(self, arm: Arm) -> bool:
        """Return whether a finger has moved back from its contact, against its force."""
        palm = inverse(self.context.link(arm.palm).pose)
        for finger, mark, place, way in arm.marks:
            now = transform(palm, transform(self.context.link(finger).pose, mark))
            if dot(subtract(place, now), way) > self._release:
                return True
        return False

    def _drop_object(self, arm: Arm) -> None:
        self.context.detach(self._joint(arm))
        self.context.info(f"arm '{arm.name}' lets go of {arm.held}")
        arm.counts, arm.held, arm.marks = {}, "", []

    def _joint(self, arm: Arm) -> str:
        return f"{self.context.scoped(arm.palm).rpartition('::')[0]}::{arm.name}::grasp"


def _mean(presses: List[FingerForce]) -> FingerForce:
    """Of one finger on one object."""
    share, force, point = 1.0 / len(presses), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for press in presses:
        force, point = add(force, press.force), add(point, press.point)
    return FingerForce(presses[0].finger, scale(force, share), scale(point, share))
