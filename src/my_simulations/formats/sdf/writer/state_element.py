"""`<state>`: poses and velocities at one time. Source: SDF specification 1.7, state."""
from __future__ import annotations

from typing import Any, Callable, Dict, Sequence

from lxml import etree

from ....description.light import Light
from ....description.model import Model
from ....description.saved_state import LinkState, ModelState, SavedState
from ....description.scoped_names import SCOPE
from ...xml.values import FLOAT, INT, POSE, TEXT, VECTOR3
from .xml_text import write_value

_NANO = 1_000_000_000


def write_state(parent: Any, state: SavedState, write_model: Callable[[Any, Model], None],
                write_light: Callable[[Any, Light], None]) -> None:
    """`<state>`.

    Times of 0 are omitted, except sim time. Links and joints of nested models are in elements of
    their own. Velocities are six numbers: linear (m/s), then angular (rad/s), in world axes.

    Args:
        parent: receives the element.
        state: the state.
        write_model: writes an inserted model below an element.
        write_light: writes an inserted light below an element.
    """
    element = etree.SubElement(parent, "state", world_name=state.world_name)
    write_value(element, "sim_time", TEXT, _seconds(state.sim_time_ns))
    for tag, time in (("real_time", state.real_time_ns), ("wall_time", state.wall_time_ns)):
        if time:
            write_value(element, tag, TEXT, _seconds(time))
    write_value(element, "iterations", INT, state.iterations)
    if state.inserted_models or state.inserted_lights:
        insertions = etree.SubElement(element, "insertions")
        for inserted in state.inserted_models:
            write_model(insertions, inserted)
        for added in state.inserted_lights:
            write_light(insertions, added)
    if state.deletions:
        deletions = etree.SubElement(element, "deletions")
        for name in state.deletions:
            write_value(deletions, "name", TEXT, name)
    for model in state.models:
        _write_model(element, model)
    for light in state.lights:
        one = etree.SubElement(element, "light", name=light.name)
        write_value(one, "pose", POSE, light.pose)


def _seconds(nanoseconds: int) -> str:
    return "{} {}".format(*divmod(nanoseconds, _NANO))


def _write_model(parent: Any, model: ModelState) -> None:
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
    """The elements of a model and of its nested models, created on first use."""

    def __init__(self, element: Any) -> None:
        self._elements: Dict[str, Any] = {"": element}

    def holder(self, name: str) -> "tuple[Any, str]":
        """The element that holds the link or joint `name` of the model, and its plain name."""
        scope, _, plain = name.rpartition(SCOPE)
        return self._model(scope), plain

    def _model(self, scope: str) -> Any:
        if scope not in self._elements:
            outer, _, plain = scope.rpartition(SCOPE)
            self._elements[scope] = etree.SubElement(self._model(outer), "model", name=plain)
        return self._elements[scope]


def _write_joint(parent: Any, name: str, positions: Sequence[float]) -> None:
    joint = etree.SubElement(parent, "joint", name=name)
    for axis, position in enumerate(positions):
        write_value(joint, "angle", FLOAT, position)
        joint[-1].set("axis", str(axis))


def _write_link(parent: Any, name: str, link: LinkState) -> None:
    element = etree.SubElement(parent, "link", name=name)
    write_value(element, "pose", POSE, link.pose)
    numbers = (*link.twist.linear, *link.twist.angular)
    write_value(element, "velocity", TEXT, " ".join(FLOAT.format(n) for n in numbers))
