"""Options, name and namespace of a spawn request.

The description is changed, not the text, so no number is rounded and comments do not matter.
"""
from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Mapping

from ...description.model import Model
from ...description.plugin_namespace import with_namespace
from ...errors import CommandError

REPLACE_ATTRIBUTE = "my_simulations_replace"
FILE_ATTRIBUTE = "my_simulations_file"
LAUNCH_ATTRIBUTE = "my_simulations_launch"
"""Deprecated attributes of the root element that say what `SpawnObject.srv` has fields for."""


@dataclass(frozen=True)
class SpawnOptions:
    """What our own tools may add to a spawn request (see `SpawnObject.srv`).

    Attributes:
        replace: replace a model of that name in one step.
        file: file that the document was read from, "" if unknown.
        launch_pid: process id of the roslaunch that runs the caller, 0 if there is none.
    """

    replace: bool = False
    file: str = ""
    launch_pid: int = 0


def options_of_attributes(attributes: Mapping[str, str]) -> SpawnOptions:
    """The options in the deprecated attributes of a document's root element."""
    pid = attributes.get(LAUNCH_ATTRIBUTE, "")
    return SpawnOptions(
        attributes.get(REPLACE_ATTRIBUTE, "").strip().lower() in ("true", "1", "yes"),
        attributes.get(FILE_ATTRIBUTE, ""), int(pid) if re.fullmatch("[0-9]{1,9}", pid) else 0)


def checked_name(name: str) -> str:
    """The name, checked. Raises CommandError: invalid as the name of a model."""
    if not name.strip():
        raise CommandError("model_name is empty")
    if "::" in name:
        raise CommandError(f"model_name {name!r} must not contain '::', the separator of scoped "
                           "names")
    return name


def with_name(model: Model, name: str, namespace: str) -> Model:
    """The model with the requested name; plugins without a namespace get that of the request."""
    renamed = replace(model, name=name)
    return with_namespace(renamed, namespace) if namespace else renamed
