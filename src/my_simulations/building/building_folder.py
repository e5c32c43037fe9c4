"""Saves and loads buildings: folders with model.config, model.sdf, the plan and its images."""
from __future__ import annotations

import base64
import binascii
import errno
import os
import re
import tempfile
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Optional, Tuple

from ..description.model import Model
from ..errors import CommandError, InputError, Issue, Severity, error
from ..formats.image.pixels import verify_format
from ..formats.reading import read_file
from ..formats.sdf.writer.entities import write_entity
from ..resources.limited_file import at_most
from ..resources.model_config import description_in
from ..resources.resolver import Resolver
from ..xml_characters import check_characters
from .building_plan import FloorImage, Level, Plan
from .model_to_plan import plan_from_model
from .plan_check import check_plan
from .plan_json import plan_from_text, plan_to_text
from .plan_to_model import building_model, model_name

PLAN_FILE = "building.json"

LARGEST_IMAGE = 16 << 20
"""Largest size of a floor-plan image, bytes."""

_DATA_URL = re.compile(r"data:image/(png|jpeg);base64,", re.ASCII)
_ENDINGS = {"PNG": ".png", "JPEG": ".jpg"}
_FORBIDDEN = re.compile(r"[/\\:*?\"<>|\x00-\x1f\x7f]")


@dataclass
class About:
    """Fields of a building's model.config."""

    version: str = "1.0"
    description: str = ""
    author: str = ""
    email: str = ""


def default_folder() -> str:
    """The default folder of saved buildings (Gazebo behaviour)."""
    return os.path.expanduser("~/building_editor_models")


def check_name(name: str) -> str:
    """Check a building's name; return it as the name of its folder and model.

    Raises CommandError: it is empty or not a plain file name.
    """
    check_characters(name, "the name of the building")
    made = model_name(name)
    if not made:
        raise CommandError("the name of the building must not be empty")
    if _FORBIDDEN.search(made) or made.startswith(".") or ".." in made:
        raise CommandError(f"{name!r} is not a valid building name: it must not contain"
                           " / \\ : * ? \" < > | or .. or start with a dot")
    if len(made.encode()) > 100:
        raise CommandError("the name of the building is longer than 100 bytes")
    return made


def save_building(plan: Plan, folder: str, about: Optional[About] = None,
                  overwrite: bool = False) -> List[Issue]:
    """Save a building; on any error the folder is unchanged.

    Args:
        plan: the plan, with images as data URLs or as names of files in the folder.
        folder: absolute path of the building's folder; other files in it are kept.
        about: fields of model.config.
        overwrite: whether the folder may exist.

    Returns:
        Warnings about the plan.

    Raises:
        InputError: the plan has errors, or an image is invalid.
        CommandError: the folder exists or is not writable.
    """
    about = about or About()
    if os.path.lexists(folder) and not overwrite:
        raise CommandError(f"{folder} already exists; confirm overwriting, or choose another"
                           " name")
    plan, files = _with_image_files(plan, folder)
    files["model.sdf"] = write_entity(building_model(plan))
    files["model.config"] = _config(plan, about)
    files[PLAN_FILE] = plan_to_text(plan).encode()
    _write_all(folder, files)
    return check_plan(plan)


def load_building(path: str) -> Tuple[Plan, List[Issue]]:
    """Load the plan of a building's folder or of an SDF file.

    Reads the plan file beside the model; if that is missing or unreadable, the plan is derived from
    the model. Images are returned as data URLs. Raises InputError: not a building.
    """
    issues: List[Issue] = []
    plan_path = os.path.join(path, PLAN_FILE)
    if os.path.isfile(plan_path):
        try:
            return _read_plan(plan_path)
        except InputError as fault:
            issues += [replace(issue, severity=Severity.WARNING) for issue in fault.issues]
    file = description_in(path) if os.path.isdir(path) else path
    if file is None:
        raise InputError([*issues, error("building-not-found", f"{path} contains no building",
                                         file=path)])
    model, found = read_file(file, Resolver())
    if not isinstance(model, Model):
        raise InputError([error("building-unknown", f"{file} contains no model", file=file)])
    plan, more = plan_from_model(model, file)
    return plan, [*issues, *found, *more]


def read_about(path: str) -> About:
    """Fields of the model.config of a building's folder; empty if there is none."""
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, recover=True)
    try:
        root = etree.parse(os.path.join(path, "model.config"), parser).getroot()
    except (OSError, etree.XMLSyntaxError):
        return About()
    if root is None:
        return About()
    texts = (root.findtext(tag, "").strip()
             for tag in ("version", "description", "author/name", "author/email"))
    return About(*texts)


def list_buildings(parent: str) -> List[Dict[str, str]]:
    """Folders in `parent` that contain a building's plan or a model: name, path and title."""
    try:
        entries = sorted(os.scandir(parent), key=lambda entry: entry.name.lower())
    except OSError:
        return []
    return [{"name": entry.name, "path": entry.path, "title": entry.name.replace("_", " ")}
            for entry in entries if entry.is_dir()
            and (os.path.isfile(os.path.join(entry.path, PLAN_FILE))
                 or description_in(entry.path) is not None)]


def _read_plan(path: str) -> Tuple[Plan, List[Issue]]:
    try:
        with open(path, "rb") as stream:
            plan = plan_from_text(stream.read(), path)
    except OSError as fault:
        raise InputError([error("plan-unreadable", f"cannot be read: {fault.strerror or fault}",
                                file=path)]) from None
    issues: List[Issue] = []
    for level in plan.levels:
        if level.image is not None and not level.image.data:
            _load_image(level, os.path.dirname(path), issues)
    return plan, issues


def _load_image(level: Level, folder: str, issues: List[Issue]) -> None:
    assert level.image is not None
    name = os.path.basename(level.image.file)
    try:
        path = os.path.join(folder, name)
        if not os.path.isfile(path):   # a named pipe may have no writer
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        with open(path, "rb") as stream:
            content = at_most(stream, LARGEST_IMAGE)
        kind = image_kind(content, name)
    except (OSError, InputError) as fault:
        why = fault.strerror if isinstance(fault, OSError) else fault
        issues.append(Issue(Severity.WARNING, "image-unreadable", f"the floor plan {name!r} of"
                            f" {level.name!r} cannot be shown: {why}", file=folder))
        return
    level.image.data = (f"data:image/{kind.lower()};base64,"
                        + base64.b64encode(content).decode("ascii"))


def image_kind(content: bytes, name: str) -> str:
    """`PNG` or `JPEG`; decodes the whole image as a check, a large one in another process.

    Raises InputError: not an image, truncated, or too large.
    """
    from PIL import UnidentifiedImageError

    why = ""
    if len(content) > LARGEST_IMAGE:
        why = f"it is larger than {LARGEST_IMAGE >> 20} MB"
    else:
        try:
            kind = verify_format(content)
            if kind in _ENDINGS:
                return kind
            why = f"it is {kind}, not PNG or JPEG"
        except InputError as fault:
            why = str(fault.summary())
        except UnidentifiedImageError:
            why = "it is not an image"
        except (OSError, ValueError, SyntaxError, EOFError) as fault:
            why = str(fault)
    raise InputError([error("image-unreadable", f"the floor plan {name!r} cannot be used: {why}",
                            hint="use a PNG or JPEG file")])


def _with_image_files(plan: Plan, folder: str) -> Tuple[Plan, Dict[str, bytes]]:
    """The plan with file names instead of data URLs, and the content of these files."""
    levels: List[Level] = []
    files: Dict[str, bytes] = {}
    for number, level in enumerate(plan.levels):
        image = level.image
        if image is not None and image.data:
            content = _decode_image(image)
            name = f"floor_plan_{number + 1}{_ENDINGS[image_kind(content, image.file)]}"
            files[name] = content
            image = FloorImage(name, image.resolution)
        elif image is not None:
            name = os.path.basename(image.file)
            if name != image.file or not os.path.isfile(os.path.join(folder, name)):
                raise InputError([error("image-not-found", f"the floor plan {image.file!r} of"
                                        f" {level.name!r} was not found")])
        levels.append(replace(level, image=image))
    return replace(plan, levels=levels), files


def _decode_image(image: FloorImage) -> bytes:
    try:
        head = _DATA_URL.match(image.data)
        if head is None:
            raise ValueError
        return base64.b64decode(image.data[head.end():], validate=True)
    except (ValueError, binascii.Error):
        raise InputError([error("image-unreadable", f"the floor plan {image.file!r} is not a PNG or"
                                " JPEG picture", hint="import it again")]) from None


def _config(plan: Plan, about: About) -> bytes:
    from lxml import etree

    root = etree.Element("model")
    _child(root, "name", plan.name.strip())
    _child(root, "version", about.version or "1.0")
    _child(root, "sdf", "model.sdf").set("version", "1.7")
    author = etree.SubElement(root, "author")
    _child(author, "name", about.author)
    _child(author, "email", about.email)
    _child(root, "description", about.description)
    etree.indent(root, space="  ")
    text: bytes = etree.tostring(root, encoding="utf-8")
    return b'<?xml version="1.0" encoding="utf-8"?>\n' + text + b"\n"


def _child(parent: Any, tag: str, text: str) -> Any:
    from lxml import etree

    child = etree.SubElement(parent, tag)
    child.text = text
    return child


def _write_all(folder: str, files: Dict[str, bytes]) -> None:
    """Write all files or none: each to a temporary file first, then all are renamed."""
    made = not os.path.isdir(folder)
    staged: List[Tuple[str, str]] = []
    try:
        os.makedirs(folder, exist_ok=True)
        for name, content in files.items():
            target = os.path.join(folder, name)
            if os.path.isdir(target):
                raise IsADirectoryError(errno.EISDIR, "it is a folder", target)
            handle, temporary = tempfile.mkstemp(prefix=".", suffix=".part", dir=folder)
            staged.append((temporary, target))
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
                stream.flush()
                os.fchmod(stream.fileno(), 0o644)
                os.fsync(stream.fileno())
        while staged:
            temporary, target = staged[0]
            os.replace(temporary, target)
            del staged[0]
    except OSError as fault:
        raise CommandError(f"cannot write {folder}: {fault.strerror or fault}") from fault
    finally:
        for temporary, _ in staged:
            if os.path.lexists(temporary):
                os.unlink(temporary)
        if made and os.path.isdir(folder) and not os.listdir(folder):
            os.rmdir(folder)
