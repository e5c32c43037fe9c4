"""libgazebo_ros_vacuum_gripper.so: a link that holds links near it while it is on.

Parameters, defaults, topic and services are those of gazebo_plugins: links of other models whose
origin comes within 5 cm of the link's origin are held. Here a fixed joint keeps their
relative pose; in gazebo_plugins a force pulls them to the link's origin.
"""
from __future__ import annotations

from typing import List, Tuple

from ...geometry import norm, subtract
from ..base import Plugin
from ..call_slot import CallSlot
from ..frames import data_message

_REACH = 0.05   # m, between the origins of the links
_HERTZ = 100.0


class VacuumGripper(Plugin):
    """The link `<bodyName>`, with services `on` and `off`; the topic reports whether it holds."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        topic = self.required_text("topicName")
        self._link = context.link(p.text("bodyName"))
        self._on = False
        self._held: List[Tuple[str, str]] = []
        self._topic = context.publish(topic, "std_msgs/Bool")
        context.serve("on", "std_srvs/Empty", lambda request, response: self._switch(True))
        context.serve("off", "std_srvs/Empty", lambda request, response: self._switch(False))
        self._search = CallSlot()   # while it is on
        context.observe(_HERTZ, self.publish, [self._topic])

    def reset(self) -> None:
        """Nothing is held, and it stays on or off as it is."""
        self._held = []

    def _switch(self, on: bool) -> None:
        if on == self._on:
            self.context.warn(f"it is {'on' if on else 'off'} already")
        self._on = on
        if on and not self._search.is_active:
            self._search.set(self.context.every(_HERTZ, self._attach_touched))
        elif not on:
            self._search.end()
            self._release_links()

    def _release_links(self) -> None:
        for joint, _ in self._held:
            self.context.detach(joint)
        self._held = []

    def publish(self) -> None:
        self._topic.publish(data_message(self.context, "std_msgs/Bool", bool(self._held)))

    def _attach_touched(self) -> None:
        context, here = self.context, self._link.pose.position
        models = context.models()
        self._held = [one for one in self._held if one[1].partition("::")[0] in models]
        taken = {link for _, link in self._held}
        for name, model in models.items():
            if name == context.model or model.static:
                continue
            for link in model.links:
                scoped = f"{name}::{link.name}"
                if scoped in taken or norm(subtract(
                        here, context.model_link(scoped).pose.position)) >= _REACH:
                    continue
                cup = context.scoped(self._link.name)
                joint = f"{cup}::holds::{scoped}"
                context.attach(joint, cup, scoped)
                self._held.append((joint, scoped))
