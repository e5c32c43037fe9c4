"""The `<gripper>` of a model: an object between its links is fixed to the palm.

Elements and defaults are those of SDF, the behaviour is that of Gazebo's physics/Gripper.cc: an
update every 0.75 s counts up while the links of the gripper touch an object, else down. Above
`<attach_steps>` the object is fixed to the palm, unless it still moves relative to it. It is
released after more than `<detach_steps>` updates in a row without such contacts.

Differences: Gazebo waits 0.75 s of wall time, here it is sim time. Gazebo counts the contacts of
all steps between two updates, so one link is enough for any `<min_contact_count>`; here a count of
2 or more means two links. Each object has its own count. Gazebo waits ten further updates until it
compares the object's places in the palm; here each update compares with the one before.
"""
from __future__ import annotations

from typing import Dict

from ...geometry import Vec3, inverse, norm, subtract, transform
from ..base import Plugin
from ..context import PluginError
from ..parameters import Parameters
from .finger_contacts import FingerContacts
from .palm_joint import PalmJoint

_PERIOD_S = 0.75
_STEADY_M = 1e-5 ** 0.5   # Gazebo's bound for the square of the way between two updates


class SdfGripper(Plugin):
    """Holds one object."""

    def load(self) -> None:
        """Read the elements; check the links."""
        context, p = self.context, self.context.parameters
        name, palm = p.attribute("name"), self.required_text("palm_link")
        fingers = [one for one in p.texts("gripper_link") if one]
        if not fingers:
            raise PluginError("it has no <gripper_link>")
        for link in (palm, *fingers):
            context.link(link)
        check = (p.children("grasp_check") or [Parameters("", context.warn)])[0]
        self._attach_steps = check.integer("attach_steps", 20)
        self._detach_steps = check.integer("detach_steps", 40)
        self._least_links = max(1, min(check.integer("min_contact_count", 2), 2,
                                       len(set(fingers))))
        self._palm = palm
        self._joint = PalmJoint(context, palm, f"{name}::gripper", f"gripper '{name}'")
        self._contacts = FingerContacts(context, fingers, 1.0 / _PERIOD_S)
        self.reset()
        context.every(1.0 / _PERIOD_S, self.update)

    def reset(self) -> None:
        """Begin to count again."""
        self._contacts.clear()
        self._counts: Dict[str, int] = {}
        self._places: Dict[str, Vec3] = {}
        self._free_updates = 0   # in a row, without contacts with the held object

    def clock_set(self) -> None:
        """Begin to count again in the state that was restored."""
        self.reset()

    def update(self) -> None:
        """Count the contacts since the last update; attach or release an object."""
        touched = {name for name, by_link in self._contacts.take().items()
                   if len(by_link) >= self._least_links}
        held = self._joint.held
        self._free_updates = self._free_updates + 1 if held and held not in touched else 0
        if held:
            self._counts, self._places = {}, {}
            if self._free_updates > self._detach_steps:
                self._joint.detach()
            return
        counts = {name: count - 1 for name, count in self._counts.items() if count > 1}
        counts.update({name: self._counts.get(name, 0) + 1 for name in touched})
        places = {name: self._place_in_palm(name) for name in touched}
        for name in sorted(touched):
            before = self._places.get(name)
            if (counts[name] > self._attach_steps and before is not None
                    and norm(subtract(places[name], before)) < _STEADY_M
                    and self._joint.attach(name)):
                break
        self._counts, self._places = counts, places

    def _place_in_palm(self, link: str) -> Vec3:
        palm = self.context.link(self._palm).pose
        return transform(inverse(palm), self.context.model_link(link).pose.position)
