"""Plugins of a description, and plugins at work."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Iterator, Optional

from ..description.model import Model
from ..description.plugin import PluginSpec
from ..description.sensor import Sensor
from .base import Plugin
from .simulated_context import SimulatedContext


@dataclass(frozen=True)
class Found:
    """A plugin in a description: where it belongs. `scope` is that of a nested model, `inner::`."""

    spec: PluginSpec
    scope: str = ""
    link: str = ""
    joint: str = ""
    sensor: Optional[Sensor] = field(default=None, compare=False)


@dataclass
class Running:
    """A plugin at work; `plugin` None for one that is unknown or was switched off."""

    found: Found
    context: SimulatedContext
    plugin: Optional[Plugin]


def plugins_of(model: Model, scope: str = "") -> Iterator[Found]:
    """The plugins of a flattened model: its own, those of the sensors of links and
    joints, those of nested models.
    """
    for spec in model.plugins:
        yield Found(spec, scope)
    if not scope:
        for link in model.links:
            inner = link.name.rpartition("::")[0]
            for sensor in link.sensors:
                for spec in sensor.plugins:
                    yield Found(spec, f"{inner}::" if inner else "", link.name, "", sensor)
        for joint in model.joints:
            inner = joint.name.rpartition("::")[0]
            for sensor in joint.sensors:
                for spec in sensor.plugins:
                    yield Found(spec, f"{inner}::" if inner else "", "", joint.name, sensor)
    for nested in (model.guide.models if model.guide is not None else model.models):
        yield from plugins_of(nested, f"{scope}{nested.name}::")
