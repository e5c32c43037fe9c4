"""The inputs of a case besides its settings: contents of files, versions, the processor."""
from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import platform
from importlib import metadata
from typing import Any, Dict, Iterable, Iterator, List, Sequence, Set

from .. import __version__
from ..description.flatten import flatten_model
from ..description.model import Model
from ..description.world import World
from ..errors import SimulationError
from ..formats.reading import read_entity, read_world
from ..objects.object_documents import Documents, package_finder
from ..plugins.found_plugins import plugins_of, world_plugins
from ..plugins.registry import PluginRegistry, UnknownPluginError, is_built_in
from ..python_api.object_placement import selected_objects
from ..resources.resolver import Resolver
from ..resources.ros_packages import PackageIndex
from ..resources.world_lookup import find_world

_XACRO_SECONDS = 60.0


class RecordingResolver(Resolver):
    """A resolver that notes every file that it finds.

    Attributes:
        found: absolute paths, in the order in which they were asked for.
    """

    found: Dict[str, None]

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self.found = {}

    def resolve(self, uri: str, base_dir: str = "") -> str:
        path = super().resolve(uri, base_dir)
        self.found[path] = None
        return path

    def model_file(self, uri: str, base_dir: str = "") -> str:
        path = super().model_file(uri, base_dir)
        self.found[path] = None
        return path


def digest_of(value: Any) -> str:
    """A digest of plain values, the same on every machine: 32 hexadecimal digits."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:32]


def versions() -> Dict[str, str]:
    """Versions on which results depend."""
    found = {"my_simulations": __version__, "python": platform.python_version()}
    for name in ("pybullet", "numpy"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "unknown"
    return found


def processor_type() -> str:
    """The model of this machine's processor."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as info:
            for line in info:
                if line.startswith("model name"):
                    return " ".join(line.partition(":")[2].split())
    except OSError:
        return platform.machine()
    return platform.machine()


def digest_of_world(world: str, profile: str, objects: Sequence[str], object_list: str,
                    models: Sequence[str]) -> str:
    """A digest of the contents of all files that a world is read from.

    Included models, meshes, the documents of objects (after xacro) and plugins of users count. A
    file that cannot be read counts by its fault.
    """
    resolver = RecordingResolver.from_environment()
    assert isinstance(resolver, RecordingResolver)
    parts: List[object] = []
    plugins = PluginFiles()
    try:
        path = find_world(world, resolver, "")
        resolver.found[path] = None
        plugins.add_world(read_world(path, resolver, seed=0, profile=profile).world)
    except SimulationError as fault:
        parts.append(str(fault))
    if objects:
        parts += _object_texts(objects, object_list, world, resolver, plugins)
    for model in models:
        resolver.found[model] = None
        try:
            with open(model, "rb") as stream:
                entity, _ = read_entity(stream.read(), resolver, model)
            plugins.add_models([entity] if isinstance(entity, Model) else [])
        except (OSError, SimulationError) as fault:
            parts.append(str(fault))
    # By base name: a study whose folder was moved, or is mounted elsewhere, keeps its ids.
    parts += sorted((os.path.basename(name), digest_of_file(name))
                    for name in (*resolver.found, *plugins.paths()))
    return digest_of(parts)


def _object_texts(objects: Sequence[str], object_list: str, world: str,
                  resolver: RecordingResolver, plugins: PluginFiles) -> List[object]:
    parts: List[object] = []
    try:
        selection, issues = selected_objects(objects, object_list, world)
        parts += [str(issue) for issue in issues]
        with Documents(selection.objects, package_finder(), _XACRO_SECONDS) as documents:
            for placed in selection.objects:
                document = documents.of(placed)
                parts += [placed.name, placed.position, placed.rpy, document.xml]
                entity, _ = read_entity(document.xml, resolver, document.path)
                plugins.add_models([entity] if isinstance(entity, Model) else [])
    except SimulationError as fault:
        parts.append(str(fault))
    return parts


def digest_of_file(path: str) -> str:
    """A digest of the content of a file; one that cannot be read counts by its fault."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as stream:
            for block in iter(lambda: stream.read(1 << 20), b""):
                digest.update(block)
    except IsADirectoryError:
        return "folder"
    except OSError as fault:
        return f"unreadable: {fault.strerror}"
    return digest.hexdigest()


class PluginFiles:
    """Collects the plugins of worlds and models that are not of this package."""

    def __init__(self) -> None:
        self._libraries: Set[str] = set()

    def add_world(self, world: World) -> None:
        self._libraries.update(spec.filename for spec in world_plugins(world))
        self.add_models(world.models)

    def add_models(self, models: Iterable[Model]) -> None:
        for model in models:
            self._libraries.update(found.spec.filename
                                   for found in plugins_of(flatten_model(model)))

    def paths(self) -> List[str]:
        """Return the files of the plugins' packages, or their modules, sorted; import nothing."""
        registry = PluginRegistry(folders=PackageIndex().folders)
        packages: Set[str] = set()
        for library in self._libraries:
            try:
                where = registry.locate(library)
            except UnknownPluginError:   # the simulator replaces it, or the world reports it
                continue
            if not is_built_in(where):
                packages.add(where.partition(":")[0].partition(".")[0])
        return sorted(path for package in packages for path in _files_of(package))


def _files_of(package: str) -> Iterator[str]:
    """The Python files of a package, or the file of a module; none if it cannot be imported."""
    found = importlib.util.find_spec(package) if package else None
    if found is None:
        return
    for folder in found.submodule_search_locations or ():
        for place, _, files in os.walk(folder):
            yield from (os.path.join(place, name) for name in files if name.endswith(".py"))
    if not found.submodule_search_locations and found.origin:
        yield found.origin
