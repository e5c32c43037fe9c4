"""The plugins of a description, and where each belongs."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Iterator, List, Optional, Sequence

from ..description.model import WORLD, Model
from ..description.plugin import PluginSpec
from ..description.sensor import Sensor
from ..description.world import World


@dataclass(frozen=True)
class FoundPlugin:
    """A plugin in a description: where it belongs. `scope` is that of a nested model, `inner::`."""

    spec: PluginSpec
    scope: str = ""
    link: str = ""
    joint: str = ""
    sensor: Optional[Sensor] = field(default=None, compare=False)


def plugins_of(model: Model, scope: str = "") -> Iterator[FoundPlugin]:
    """The plugins of a flattened model: its own, those of the sensors of links and
    joints, those of nested models.
    """
    for spec in model.plugins:
        yield FoundPlugin(spec, scope)
    if not scope:
        for link in model.links:
            yield from _of_sensors(link.sensors, link.name, link.name, "")
        for joint in model.joints:
            yield from _of_sensors(joint.sensors, joint.name, "", joint.name)
    for nested in (model.guide.models if model.guide is not None else model.models):
        yield from plugins_of(nested, f"{scope}{nested.name}::")


def world_plugins(world: World) -> List[PluginSpec]:
    """The plugins of a world and of its actors, which no model has."""
    return [*world.plugins, *(spec for actor in world.actors for spec in actor.plugins)]


def owner_text(model: str) -> str:
    """The owner of a plugin in a message; `model` is `WORLD` for plugins of the world."""
    return "the world" if model == WORLD else f"model '{model}'"


def _of_sensors(sensors: Sequence[Sensor], owner: str, link: str,
                joint: str) -> Iterator[FoundPlugin]:
    inner = owner.rpartition("::")[0]
    for sensor in sensors:
        for spec in sensor.plugins:
            yield FoundPlugin(spec, f"{inner}::" if inner else "", link, joint, sensor)
