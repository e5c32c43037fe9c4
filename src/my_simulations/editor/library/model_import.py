"""Files of the user's desktop that become a model folder: a model, or a mesh with inertia."""
from __future__ import annotations

import base64
import binascii
import os
import re
import tempfile
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Dict, List, Mapping, Tuple

from ...description.model import Inertial, Link, Model
from ...description.shapes import Collision, Mesh, Visual
from ...errors import CommandError, InputError, Issue, error, warning
from ...formats.mesh.loading import load_mesh
from ...formats.sdf.writer.entities import write_entity
from ...geometry import Pose
from ...resources.resolver import Resolver
from ..editing.inserts import check_meshes, entity_of_uri
from ..editing.part_inertia import mesh_solid, with_density
from ..transport.error_messages import EditRefusedError

MESHES = (".dae", ".stl", ".obj", ".glb")
MOST_BYTES = 20 << 20
MOST_FILES = 500
_OTHERS = (".sdf", ".config", ".mtl", ".png", ".jpg", ".jpeg", ".tga", ".bmp", ".tif", ".tiff",
           ".gif", ".material", ".program", ".vert", ".frag", ".txt", ".md", ".json", ".xml",
           ".yaml", ".urdf", ".world", ".gltf", ".bin")
_TEXTS = (".sdf", ".urdf", ".xml", ".dae", ".material", ".json")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_ .-]{0,63}")
_DENSITY = 1000.0


def default_folder() -> str:
    """Where the models of this user lie."""
    return os.path.expanduser("~/.gazebo/models")


def import_model(message: Dict[str, Any], resolver: Resolver) -> Tuple[Dict[str, Any], List[Issue]]:
    """Store the request's files as a model folder; the reply, and what is odd about the model.

    Nothing is stored of files that make no usable model.

    Raises:
        InputError: the files cannot be used, with file and line.
        EditRefusedError: `exists`, where a folder of that name is there and must not be replaced.
        CommandError: the request itself is at fault, or the folder cannot be written.
    """
    name = check_folder_name(message["name"])
    files = _contents(message["files"], name)
    target = os.path.join(default_folder(), name)
    if os.path.lexists(target) and not message.get("overwrite"):
        raise EditRefusedError("exists", f"{target} already exists",
                               "overwrite it, or choose another name")
    density = float(message.get("density") or _DENSITY)
    try:
        issues = _store_model(files, name, target, density, resolver)
    except OSError as fault:
        raise CommandError(f"{target} cannot be written: {fault}") from fault
    return {"uri": f"model://{name}", "path": target}, issues


def _store_model(files: Dict[str, bytes], name: str, target: str, density: float,
                 resolver: Resolver) -> List[Issue]:
    """Make the model folder and try it; only a usable one takes its place."""
    os.makedirs(default_folder(), exist_ok=True)
    issues: List[Issue] = []
    with tempfile.TemporaryDirectory(prefix=".import-", dir=default_folder()) as scratch:
        folder = os.path.join(scratch, name)
        try:
            if any(path.lower().endswith((".sdf", "model.config")) for path in files):
                _write(folder, files)
            else:
                issues += _mesh_model(folder, name, files, density)
            issues += check_loading(folder, resolver)
            _use_model_uris(folder, name)
        except InputError as fault:
            raise InputError([relocate_issue(issue, folder, target)
                              for issue in fault.issues]) from fault
        _replace_folder(folder, target, os.path.join(scratch, "former"))
    return [relocate_issue(issue, folder, target) for issue in issues]


def _replace_folder(folder: str, target: str, former: str) -> None:
    """Move a folder to `target`; an existing folder or link there moves to `former`."""
    if not os.path.lexists(target):
        os.rename(folder, target)
        return
    os.rename(target, former)
    try:
        os.rename(folder, target)
    except OSError:
        os.rename(former, target)
        raise


def check_folder_name(name: str) -> str:
    """Check the name of a model folder; return it without surrounding spaces.

    Raises CommandError.
    """
    name = name.strip()
    if not _NAME.fullmatch(name) or name.endswith("."):
        raise CommandError(f"{name!r} cannot be the name of a model folder; use letters, digits,"
                           " _, - and spaces")
    return name


def _contents(given: List[Dict[str, str]], name: str) -> Dict[str, bytes]:
    """By relative path, the common folder taken off; URIs of it are of `name`.

    Raises CommandError.
    """
    if not given or len(given) > MOST_FILES:
        raise CommandError(f"1 to {MOST_FILES} files can be imported at once, not {len(given)}")
    found: Dict[str, bytes] = {}
    for one in given:
        path = os.path.normpath(one["path"].replace("\\", "/").lstrip("/"))
        if path.startswith("..") or os.path.isabs(path) or "\0" in path:
            raise CommandError(f"{one['path']!r} lies outside of the model's folder")
        if not path.lower().endswith((*MESHES, *_OTHERS)):
            raise CommandError(f"{path}: files of this type are no part of a model")
        try:
            found[path] = base64.b64decode(one["data"], validate=True)
        except (binascii.Error, ValueError) as fault:
            raise CommandError(f"{path}: the data are not base64: {fault}") from fault
    size = sum(map(len, found.values()))
    if size > MOST_BYTES:
        raise CommandError(f"the files have {size / 1e6:.0f} MB; at most {MOST_BYTES >> 20} MB can"
                           " be imported; put larger models into ~/.gazebo/models by hand")
    tops = sorted({path.split("/")[0] for path in found})
    if len(tops) == 1 and all("/" in path for path in found):  # a folder that was dropped
        return {path.split("/", 1)[1]: _rename_references(path, data, tops[0], name)
                for path, data in found.items()}
    described = {path.split("/")[0] for path in found
                 if path.lower().endswith((".sdf", "model.config"))}
    if len(described) > 1 and not described & found.keys():
        raise CommandError("drop one model folder at a time; there are "
                           + ", ".join(sorted(described)))
    return found


def _rename_references(path: str, data: bytes, former: str, name: str) -> bytes:
    """A text file of the model, with `name` in the URIs of its own files."""
    if former == name or not path.lower().endswith(_TEXTS):
        return data
    return data.replace(f"model://{former}/".encode(), f"model://{name}/".encode())


def _write(folder: str, files: Dict[str, bytes]) -> None:
    for path, data in files.items():
        whole = os.path.join(folder, path)
        os.makedirs(os.path.dirname(whole), exist_ok=True)
        with open(whole, "wb") as stream:
            stream.write(data)
    if "model.config" not in files:
        described = min((path for path in files if path.lower().endswith(".sdf")), default="")
        if not described:
            raise CommandError("drop a model folder: there is no model.config at its top, and no"
                               " .sdf file")
        _write(folder, {"model.config": config_text(os.path.basename(folder), described)})


def _mesh_model(folder: str, name: str, files: Dict[str, bytes], density: float) -> List[Issue]:
    """A dynamic body of one mesh that stands on the ground, with its textures beside the mesh."""
    meshes = [path for path in files if path.lower().endswith(MESHES)]
    if len(meshes) != 1:
        raise CommandError("drop one mesh with its textures, or a model folder; there are "
                           f"{len(meshes)} meshes")
    if not 0.0 < density < 1e6:
        raise CommandError(f"the density must be between 0 and 1e6 kg/m^3, is {density:g}")
    _write(folder, {**{f"meshes/{path}": data for path, data in files.items()},
                    "model.config": config_text(name, "model.sdf")})
    path = os.path.join(folder, "meshes", meshes[0])
    uri = f"meshes/{meshes[0]}"
    inertial, issues = _inertial(path, uri, density)
    lowest = float(load_mesh(Mesh(uri=uri, path=path)).vertices[:, 2].min())
    shape = Mesh(uri=uri, path=path)
    model = Model(name, Pose((0.0, 0.0, -lowest)), links=[Link("link", inertial=inertial,
                                    collisions=[Collision("collision", shape)],
                                    visuals=[Visual("visual", shape)])])
    with open(os.path.join(folder, "model.sdf"), "wb") as stream:
        stream.write(write_entity(model))
    return issues


def _use_model_uris(folder: str, name: str) -> None:
    """Replace the absolute path of `folder` in its model.sdf by `model://NAME`."""
    path = os.path.join(folder, "model.sdf")
    if not os.path.isfile(path):
        return
    with open(path, "rb") as stream:
        text = stream.read()
    with open(path, "wb") as stream:
        stream.write(text.replace(folder.encode(), f"model://{name}".encode()))


def _inertial(path: str, uri: str, density: float) -> Tuple[Inertial, List[Issue]]:
    """Mass properties of the solid; of its convex hull where the surface is not closed."""
    solid, closed = mesh_solid(load_mesh(Mesh(uri=uri, path=path)))
    if solid is None:
        raise InputError([error("mesh-empty", "the mesh has no volume", file=path)])
    issues = [] if closed else [
        warning("mesh-open", "the mesh is not closed: mass and inertia are those of its convex"
                " hull", file=path)]
    return with_density(solid, density), issues


def config_text(name: str, described: str,
                about: Mapping[str, str] = MappingProxyType({})) -> bytes:
    """A model.config.

    Args:
        name: of the model.
        described: file with the description.
        about: `version`, `description`, `author` and `email`, as far as known.
    """
    from lxml import etree

    root = etree.Element("model")
    etree.SubElement(root, "name").text = name
    etree.SubElement(root, "version").text = about.get("version") or "1.0"
    etree.SubElement(root, "sdf", version="1.7").text = described
    if about.get("author") or about.get("email"):
        author = etree.SubElement(root, "author")
        etree.SubElement(author, "name").text = about.get("author") or ""
        etree.SubElement(author, "email").text = about.get("email") or ""
    if about.get("description"):
        etree.SubElement(root, "description").text = about["description"]
    etree.indent(root, space="  ")
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8"))


def check_loading(folder: str, resolver: Resolver) -> List[Issue]:
    """What the simulator says of the model. Raises InputError, CommandError."""
    # The model names its own files by model://, and is not among the models yet.
    entity, issues = entity_of_uri(f"file://{folder}",
                                   resolver.with_first_folder(os.path.dirname(folder)))
    if isinstance(entity, Model):
        issues += check_meshes(entity)[1]
    return issues


def relocate_issue(issue: Issue, scratch: str, target: str) -> Issue:
    """Replace the scratch folder by the target folder in the file and message of an issue."""
    return replace(issue, file=issue.file.replace(scratch, target),
                   message=issue.message.replace(scratch, target))
