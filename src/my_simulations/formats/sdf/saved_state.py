"""`<state>`: the state of a world when it was saved. Source: SDF spec 1.7, state."""
from __future__ import annotations

from typing import Any, List

from ...description.saved_state import LightState, LinkState, ModelState, SavedState
from ..xml.binding import fill
from ..xml.source import FaultLevel, Source
from ..xml.values import numbers
from .light import read_light
from .model import read_model
from .world_tables import LIGHT_STATE, LINK_STATE, MODEL_STATE, STATE


def read_state(element: Any, source: Source) -> SavedState:
    """The state as written; `state_applied.apply_state` applies it to the world."""
    state = SavedState()
    found = fill(state, element, STATE, source, [])
    for child in found.get("model", ()):
        state.models.append(_model(child, source))
    for child in found.get("light", ()):
        light = LightState(child.get("name", ""))
        fill(light, child, LIGHT_STATE, source, [])
        state.lights.append(light)
    for child in found.get("insertions", ()):
        _insertions(child, state, source)
    return state


def _model(element: Any, source: Source) -> ModelState:
    state = ModelState(element.get("name", ""))
    _into(state, element, "", source)
    return state


def _into(state: ModelState, element: Any, scope: str, source: Source) -> None:
    """Add links and joints of a model and of its nested models, by scoped names."""
    own = state if not scope else ModelState("")
    found = fill(own, element, MODEL_STATE, source, [])
    for child in found.get("link", ()):
        link = LinkState(scope + child.get("name", ""))
        fill(link, child, LINK_STATE, source, [])
        if child.find("pose") is not None:
            state.links.append(link)
    for child in found.get("joint", ()):
        state.joints[scope + child.get("name", "")] = _angles(child, source)
    for child in found.get("model", ()):
        _into(state, child, f"{scope}{child.get('name', '')}::", source)


def _angles(element: Any, source: Source) -> List[float]:
    angles: List[float] = []
    for angle in element.iterfind("angle"):
        try:
            angles.append(numbers(angle.text or "", 1)[0])
        except ValueError as fault:
            source.report(FaultLevel.WARNING, "bad-value", f"<angle>: {fault}", angle)
    return angles


def _insertions(element: Any, state: SavedState, source: Source) -> None:
    for child in element:
        before = source.log.fatal
        if child.tag == "model":
            placement = read_model(child, source)
            if source.log.fatal == before:
                state.inserted_models.append(placement.model)
        elif child.tag == "light":
            light = read_light(child, source).light
            if source.log.fatal == before:
                state.inserted_lights.append(light)
