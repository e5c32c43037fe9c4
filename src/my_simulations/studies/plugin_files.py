"""The Python files of the plugins that a world names, on which the results of a case depend."""
from __future__ import annotations

import importlib.util
import os
from typing import Iterable, Iterator, List, Set

from ..description.flatten import flattened
from ..description.model import Model
from ..description.world import World
from ..plugins.found_plugins import plugins_of, world_plugins
from ..plugins.registry import PluginRegistry, UnknownPluginError, is_built_in
from ..resources.ros_packages import PackageIndex


class PluginFiles:
    """Collects the plugins of worlds and models that are not of this package."""

    def __init__(self) -> None:
        self._libraries: Set[str] = set()

    def add_world(self, world: World) -> None:
        self._libraries.update(spec.filename for spec in world_plugins(world))
        self.add_models(world.models)

    def add_models(self, models: Iterable[Model]) -> None:
        for model in models:
            self._libraries.update(found.spec.filename for found in plugins_of(flattened(model)))

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
