"""Whether a model has plugins anywhere."""
from __future__ import annotations

from .model import Model


def has_plugins(model: Model) -> bool:
    """Whether a model, a sensor of its links or joints, or a nested model has a plugin."""
    if model.plugins:
        return True
    for owner in (*model.links, *model.joints):
        if any(sensor.plugins for sensor in owner.sensors):
            return True
    return any(map(has_plugins, model.models if model.guide is None else model.guide.models))
