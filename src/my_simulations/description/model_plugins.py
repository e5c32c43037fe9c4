"""The plugins of a model, wherever they are."""
from __future__ import annotations

from itertools import chain
from typing import Iterable

from .model import Model


def has_plugins(model: Model) -> bool:
    """Whether a model, a sensor of its links or joints, or a nested model has a plugin."""
    return (bool(model.plugins) or _of_sensors(model) > 0
            or any(map(has_plugins, _list_nested(model))))


def plugin_count(model: Model) -> int:
    """The number of plugins of a flattened model, those of sensors and nested models included."""
    return _of_sensors(model) + _of_models([model])


def _of_sensors(model: Model) -> int:
    sensors = chain.from_iterable((*(link.sensors for link in model.links),
                                   *(joint.sensors for joint in model.joints)))
    return sum(len(sensor.plugins) for sensor in sensors)


def _of_models(models: Iterable[Model]) -> int:
    return sum(len(model.plugins) + _of_models(_list_nested(model)) for model in models)


def _list_nested(model: Model) -> Iterable[Model]:
    return model.models if model.guide is None else model.guide.models
