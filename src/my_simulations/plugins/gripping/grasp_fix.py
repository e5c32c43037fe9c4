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
from typing import Dict, List, Tuple

from ...geometry import Vec3, conjugate, dot, inverse, norm, rotate, scale, subtract, transform
from ..base import Plugin
from ..context import PluginError
from ..parameters import Parameters
from .finger_contacts import FingerContacts, FingerForce
from .palm_joint import PalmJoint

_COUNTS = 10    # the usual most of counts
_LEAST_RATIO = 0.3  # of two forces that oppose each other, and the smallest, N: gazebo_grasp_plugin
_LEAST_FORCE = 1e-4


@dataclass
class Arm:
    """A gripper.

    Attributes:
        joint: fixes an object to the palm.
        contacts: those of the fingers.
        counts: updates with a grip minus updates without, by the scoped link name of the object.
        marks: of each finger that held it, where it touched (in the finger and in the palm frame)
            and which way it pressed (in the palm frame).
    """

    name: str
    palm: str
    joint: PalmJoint
    contacts: FingerContacts
    counts: Dict[str, int] = field(default_factory=dict)
    marks: List[Tuple[str, Vec3, Vec3, Vec3]] = field(default_factory=list)

    def clear(self) -> None:
        """Drop what is known of contacts."""
        self.contacts.clear()
        self.counts, self.marks = {}, []


class GraspFix(Plugin):
    """Watches the fingers of one or more arms."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        if not p.children("arm"):
            raise PluginError("it has no <arm>")
        hertz = p.number("update_rate", 5.0)
        self._arms: List[Arm] = []
        for one in p.children("arm"):
            try:
                self._arms.append(self._arm(one, hertz))
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
        context.every(hertz, self.update)

    def _arm(self, p: Parameters, hertz: float) -> Arm:
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
        return Arm(name, palm, PalmJoint(self.context, palm, f"{name}::grasp", f"arm '{name}'"),
                   FingerContacts(self.context, fingers, hertz))

    def reset(self) -> None:
        """Clear the contacts and the held objects of all arms."""
        for arm in self._arms:
            arm.clear()

    def clock_set(self) -> None:
        """Find the contacts in the state that was restored."""
        self.reset()

    def update(self) -> None:
        """Evaluate the contacts of the last step and those sampled since the last update."""
        for arm in self._arms:
            held = arm.joint.held
            if not held or not arm.marks:
                pressed = {name: list(by_finger.values())
                           for name, by_finger in arm.contacts.take().items()}
                if held:   # since a saved state was restored
                    self._mark_contacts(arm, pressed.get(held, []))
                else:
                    self._count(arm, pressed)
            elif self._has_opened(arm):
                arm.joint.detach()
                arm.clear()

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
        if arm.joint.attach(name):
            arm.clear()
            self._mark_contacts(arm, presses)

    def _mark_contacts(self, arm: Arm, presses: List[FingerForce]) -> None:
        """Store where the fingers touch the held object."""
        context, palm = self.context, self.context.link(arm.palm).pose
        for press in presses:
            if press.finger == arm.palm:
                continue
            finger = context.link(press.finger).pose
            arm.marks.append((press.finger, press.point,
                              transform(inverse(palm), transform(finger, press.point)),
                              rotate(conjugate(palm.orientation),
                                     scale(press.force, 1.0 / norm(press.force)))))

    def _has_opened(self, arm: Arm) -> bool:
        """Return whether a finger has moved back from its contact, against its force."""
        palm = inverse(self.context.link(arm.palm).pose)
        for finger, mark, place, way in arm.marks:
            now = transform(palm, transform(self.context.link(finger).pose, mark))
            if dot(subtract(place, now), way) > self._release:
                return True
        return False
