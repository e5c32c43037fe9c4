"""Warns about damaged meshes of visuals, and about missing textures and material libraries."""
from __future__ import annotations

import os
from dataclasses import replace
from typing import Iterable, Iterator, List, Optional, Tuple

from ...appearance.textures import existing_path, mesh_image_candidates
from ...description.model import Model
from ...description.shapes import Mesh
from ...errors import InputError, Issue, Severity, warning
from ...resources.lfs_pointer import LFS_HINT, LFS_POINTER, is_lfs_pointer_file
from ...resources.resolver import Resolver, ResourceNotFoundError
from .loading import load_solid
from .named_files import IMAGE, MATERIALS, NamedFile, named_files
from .part import MeshError

_WITHOUT = {IMAGE: "the mesh is shown without it", MATERIALS: "the mesh is shown without materials"}


def visual_file_issues(models: Iterable[Model], resolver: Resolver) -> List[Issue]:
    """Warnings about the mesh files of visuals and the files that they refer to, each once.

    The triangles are not read; see `named_files`.

    Args:
        models: nested models are included.
        resolver: finds images that a mesh names by URI, and Gazebo's shared texture folders.
    """
    paths = dict.fromkeys(mesh.path for _, mesh in _meshes(models, ""))
    return [issue for path in paths for issue in _issues(path, path, resolver)]


def decoded_visual_issues(models: Iterable[Model], known: Iterable[Issue]) -> List[Issue]:
    """Warnings about visuals whose triangles cannot be read; this decodes the meshes.

    Args:
        models: nested models are included.
        known: issues that were already found; their files are not read again.
    """
    faulty = {issue.file for issue in known if issue.code.startswith("mesh-")}
    issues: List[Issue] = []
    for visual, mesh in _meshes(models, ""):
        if mesh.path in faulty:
            continue
        try:
            load_solid(mesh)
        except InputError as fault:
            faulty.add(mesh.path)
            issues += [replace(issue, severity=Severity.WARNING, message=f"{visual}:"
                               f" {issue.message}; it is not shown") for issue in fault.issues]
    return issues


def _meshes(models: Iterable[Model], scope: str) -> Iterator[Tuple[str, Mesh]]:
    """The meshes of visuals, with the name of each visual for messages."""
    for model in models:
        for link in model.links:
            for visual in link.visuals:
                mesh = visual.geometry
                if isinstance(mesh, Mesh) and mesh.path:
                    yield f"visual {visual.name!r} of link {scope + link.name!r}", mesh
        for inner in model.models:
            yield from _meshes([inner], f"{scope}{inner.name}::")


def _issues(path: str, mesh: str, resolver: Resolver) -> List[Issue]:
    try:
        named = named_files(path)
    except (MeshError, OSError) as fault:
        return [_unreadable(path, mesh, fault)]
    issues: List[Issue] = []
    for one in named:
        found = _find(one, mesh, resolver)
        if found is None:
            issues.append(_missing(one, path, mesh))
        elif one.kind == MATERIALS:
            issues += _issues(found, mesh, resolver)
        elif is_lfs_pointer_file(found):
            issues.append(warning("image-unreadable", f"the {one.kind} {one.name!r} cannot be read:"
                                  f" {LFS_POINTER}", file=path, line=one.line, hint=LFS_HINT))
    return issues


def _unreadable(path: str, mesh: str, fault: Exception) -> Issue:
    what, without = ("mesh", "it is not shown") if path == mesh else (
        MATERIALS, _WITHOUT[MATERIALS])
    reason = (fault.strerror if isinstance(fault, OSError) else None) or str(fault)
    return warning(getattr(fault, "code", "mesh-unreadable"),
                   f"the {what} of this visual cannot be read: {reason}; {without}", file=path,
                   line=getattr(fault, "line", 0), hint=LFS_HINT if reason == LFS_POINTER else "")


def _missing(one: NamedFile, path: str, mesh: str) -> Issue:
    code = {IMAGE: "image-not-found", MATERIALS: "material-library-not-found"}.get(
        one.kind, "mesh-unreadable")
    return warning(code, f"the {one.kind} {one.name!r} was not found;"
                   f" {_WITHOUT.get(one.kind, 'the mesh is not shown')}",
                   file=path, line=one.line, hint=_advice(one.name, mesh))


def _advice(name: str, mesh: str) -> str:
    """Return the expected path of the file, or the path of a file with its name."""
    folder, base = os.path.dirname(mesh), os.path.basename(name.replace("\\", "/"))
    near = _same_name(base, folder)
    if near:
        return f"did you mean {near}?"
    inside = os.path.dirname(name)
    if inside and "://" not in name and "\\" not in name and not os.path.isabs(name) \
            and not os.path.isdir(os.path.join(folder, inside)):
        return f"copy its folder {inside!r} to {folder}"
    return f"copy {base!r} to {folder}"


def _same_name(base: str, folder: str) -> str:
    """A file of that name in a folder below, as a path relative to `folder`; "" for none."""
    try:
        inner = sorted(entry.name for entry in os.scandir(folder) if entry.is_dir())
    except OSError:
        return ""
    return next((os.path.join(name, base) for name in inner
                 if os.path.isfile(os.path.join(folder, name, base))), "")


def _find(one: NamedFile, mesh: str, resolver: Resolver) -> Optional[str]:
    """The path of a file that a mesh names; None if it does not exist (Gazebo's search order)."""
    name = one.name[len("file://"):] if one.name.startswith("file://") else one.name
    if "://" in name:
        try:
            return resolver.resolve(name)
        except ResourceNotFoundError:
            return None
    path = os.path.normpath(os.path.join(os.path.dirname(mesh), name))
    places = mesh_image_candidates(path, resolver.resource_folders()) if one.kind == IMAGE else ()
    return existing_path(path) or next((hit for hit in map(existing_path, places) if hit), None)
