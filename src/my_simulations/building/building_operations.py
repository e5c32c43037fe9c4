"""Requests of the editor about buildings, with JSON values.

They raise InputError (faults of the plan) and CommandError (names, folders, disk); nothing has
changed then.
"""
from __future__ import annotations

import os
from dataclasses import asdict, fields
from typing import Any, Dict, List, Mapping, Sequence, Tuple

from ..description.model import Model
from ..errors import CommandError, Issue
from ..formats.sdf.writer.entities import write_entity
from .building_folder import (
    About,
    check_name,
    default_folder,
    list_buildings,
    load_building,
    read_about,
    save_building,
)
from .plan_check import check_plan
from .plan_json import plan_from_json, plan_to_json
from .plan_to_model import building_model


def building_sdf(plan: Any, with_text: bool = True) -> Tuple[Model, str, List[Issue]]:
    """The model of a plan, its SDF ("" unless `with_text`), and warnings about the plan."""
    read = plan_from_json(plan)
    model = building_model(read)
    return model, write_entity(model).decode() if with_text else "", check_plan(read)


def building_save(plan: Any, name: str, options: Mapping[str, Any],
                  roots: Sequence[str] = ()) -> Dict[str, Any]:
    """Save a plan as a building.

    Args:
        plan: JSON of a plan.
        name: name of the building; spaces become `_`.
        options: `folder` that contains the building's folder (default `default_folder()`),
            `overwrite`, and the fields of `About`.
        roots: folders below which buildings may be saved, besides the default one.

    Returns:
        JSON with the path of the folder, name and `model://` URI of the model, and issues.
    """
    made = check_name(name)
    parent = _resolve_allowed_path(str(options.get("folder") or default_folder()), roots)
    read = plan_from_json(plan)
    read.name = name.strip()
    about = About(**{item.name: str(options[item.name])
                     for item in fields(About) if options.get(item.name)})
    path = os.path.join(parent, made)
    issues = save_building(read, path, about, bool(options.get("overwrite")))
    return {"path": path, "name": made, "uri": f"model://{made}", "issues": issues}


def building_load(name: str, roots: Sequence[str] = ()) -> Dict[str, Any]:
    """Load a saved building by its name in the default folder or by its path.

    Returns:
        JSON with plan, path, issues, and the fields of its model.config as `about`.
    """
    path = os.path.expanduser(name.strip())
    if not os.path.isabs(path):
        path = os.path.join(default_folder(), check_name(name))
    path = _resolve_allowed_path(path, roots)
    if not os.path.exists(path):
        raise CommandError(f"{path} does not exist")
    plan, issues = load_building(path)
    return {"plan": plan_to_json(plan), "path": path, "issues": issues,
            "about": asdict(read_about(path))}


def building_list(parents: Sequence[str] = ()) -> List[Dict[str, str]]:
    """The buildings of the default folder and of others: name, path, title."""
    seen: Dict[str, Dict[str, str]] = {}
    for parent in (default_folder(), *parents):
        for entry in list_buildings(parent):
            seen.setdefault(os.path.realpath(entry["path"]), entry)
    return list(seen.values())


def _resolve_allowed_path(path: str, roots: Sequence[str]) -> str:
    """The real path. Raises CommandError if it is outside the default folder and all roots."""
    places = [os.path.realpath(os.path.expanduser(root)) for root in (default_folder(), *roots)]
    real = os.path.realpath(os.path.join(places[0], os.path.expanduser(path.replace("\0", ""))))
    if "\0" in path or not any(real == place or real.startswith(place.rstrip("/") + "/")
                               for place in places):
        raise CommandError(f"{path!r} resolves to {real}, which is outside the allowed folders: "
                           + ", ".join(places))
    return real
