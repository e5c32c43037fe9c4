"""A model of the world as a folder of the user's models: model.config and model.sdf."""
from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from typing import Any, Dict, List, Tuple

from ...description.model import Model
from ...description.unflatten import unflattened
from ...errors import Issue
from ...formats.sdf.writer.entities import write_entity
from ...geometry import Pose
from ...resources.resolver import Resolver
from ...simulator.safe_file import write_atomically
from ...simulator.simulator import Simulator
from ..transport.error_messages import EditRefusedError
from .model_import import check_loading, checked_folder_name, config_text, default_folder, relocated


def save_model(message: Dict[str, Any], world: Simulator,
               resolver: Resolver) -> Tuple[Dict[str, Any], List[Issue]]:
    """Store a model of the world as a model folder; the reply, and what is odd about the model.

    The model is stored under the folder's name, as it is described, at the height at which it
    stands now. Other files of the folder stay. Nothing is stored of a model that could not be
    loaded again.

    Raises:
        InputError: the written file could not be read.
        EditRefusedError: `exists`, where there is a folder of that name that must not be replaced.
        CommandError: no such model, no usable name, or the folder cannot be written.
    """
    name = checked_folder_name(message["name"])
    model = world.models.get(message["model"])
    height = world.states.model_state(model.name)[0].position[2]
    target = os.path.join(default_folder(), name)
    if os.path.lexists(target) and not message.get("overwrite"):
        raise EditRefusedError("exists", f"{target} already exists",
                               "overwrite it, or choose another name")
    files = {
        "model.sdf": _text(model, name, height).replace(
            f"{target}/".encode(), f"model://{name}/".encode()),
        "model.config": config_text(name, "model.sdf", message.get("about") or {}),
    }
    issues = _readable(files, name, target, resolver)
    for file, data in files.items():
        write_atomically(os.path.join(target, file), data, overwrite=True)
    return {"uri": f"model://{name}", "path": target}, issues


def _text(model: Model, name: str, height: float) -> bytes:
    whole = replace(unflattened(model), name=name, pose=Pose((0.0, 0.0, height)), uri="")
    return write_entity(whole)


def _readable(files: Dict[str, bytes], name: str, target: str, resolver: Resolver) -> List[Issue]:
    """What the simulator says of the folder. Raises InputError."""
    with tempfile.TemporaryDirectory(prefix="my_simulations-") as scratch:
        folder = os.path.join(scratch, name)
        os.makedirs(folder)
        for file, data in files.items():
            with open(os.path.join(folder, file), "wb") as stream:
                stream.write(data)
        return [relocated(issue, folder, target) for issue in check_loading(folder, resolver)]
