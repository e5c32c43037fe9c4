"""Whether a model has plugins anywhere."""
from __future__ import annotations

from itertools import chain

from .model import Model


def has_plugins(model: Model) -> bool:
    """Whether a model, a sensor of its links or joints, or a nested model has a plugin."""
    if model.plugins:
        return True
    sensors = chain.from_iterable((*(link.sensors for link in model.links),
                                   *(joint.sensors for joint in model.joints)))
    nested = model.models if model.guide is None else model.guide.models
    return any(sensor.plugins for sensor in sensors) or any(map(has_plugins, nested))
