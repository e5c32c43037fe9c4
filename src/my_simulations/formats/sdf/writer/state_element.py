"""`<state>`: where everything is at one moment of a run. Source: SDF specification 1.7, state."""
from __future__ import annotations

from typing import Any, Dict, Sequence

from ....description.scoped_names import SCOPE
from ....description.world import LinkState, ModelState, SavedState
from ...xml.values import FLOAT, INT, POSE, TEXT, VECTOR3
from .xml_text import write_value

_NANO = 1_000_000_000


def write_state(parent: Any, state: SavedState) -> None:
    """`<state>`.

    Times that are 0 are left out, except sim time. Links and joints of nested models stand in
    elements of their own; velocities are six plain numbers, linear then angular, in world axes.
    """
    from lxml import etree

    element = etree.SubElement(parent, "state", world_name=state.world_name)
    write_value(element, "sim_time", TEXT, _seconds(state.sim_time_ns))
    for tag, time in (("real_time", state.real_time_ns), ("wall_time", state.wall_time_ns)):
        if time:
            write_value(element, tag, TEXT, _seconds(time))
    write_value(element, "iterations", INT, state.iterations)
    for model in state.models:
        _write_model(element, model)
    for light in state.lights:
        one = etree.SubElement(element, "light", name=light.name)
        write_value(one, "pose", POSE, light.pose)


def _seconds(nanoseconds: int) -> str:
    return "{} {}".format(*divmod(nanoseconds, _NANO))


def _write_model(parent: Any, model: ModelState) -> None:
    from lxml import etree

    element = etree.SubElement(parent, "model", name=model.name)
    if model.pose is not None:
        write_value(element, "pose", POSE, model.pose)
    write_value(element, "scale", VECTOR3, model.scale)
    inside = _Nested(element)
    for name, positions in model.joints.items():
        holder, plain = inside.holder(name)
        _write_joint(holder, plain, positions)
    for link in model.links:
        holder, plain = inside.holder(link.name)
        _write_link(holder, plain, link)


class _Nested:
    """The elements of a model and of those nested in it, made as they are asked for."""

    def __init__(self, element: Any) -> None:
        self._elements: Dict[str, Any] = {"": element}

    def holder(self, name: str) -> "tuple[Any, str]":
        """The element for what is called `name` within the model, and its plain name."""
        scope, _, plain = name.rpartition(SCOPE)
        return self._model(scope), plain

    def _model(self, scope: str) -> Any:
        from lxml import etree

        if scope not in self._elements:
            outer, _, plain = scope.rpartition(SCOPE)
            self._elements[scope] = etree.SubElement(self._model(outer), "model", name=plain)
        return self._elements[scope]


def _write_joint(parent: Any, name: str, positions: Sequence[float]) -> None:
    from lxml import etree

    joint = etree.SubElement(parent, "joint", name=name)
    for axis, position in enumerate(positions):
        write_value(joint, "angle", FLOAT, position)
        joint[-1].set("axis", str(axis))


def _write_link(parent: Any, name: str, link: LinkState) -> None:
    from lxml import etree

    element = etree.SubElement(parent, "link", name=name)
    write_value(element, "pose", POSE, link.pose)
    numbers = (*link.twist.linear, *link.twist.angular)
    write_value(element, "velocity", TEXT, " ".join(FLOAT.format(n) for n in numbers))
