"""Reads a choice of a world and puts its objects and models into the simulator."""
from __future__ import annotations

from dataclasses import replace
from typing import Optional, Sequence

from ..description.plugin_namespace import with_namespace
from ..errors import CommandError, InputError, Issue, errors_of, group_repeated
from ..formats.reading import LoadedWorld, Text
from ..geometry import Pose, compose
from ..resources.resolver import ResourceNotFoundError
from ..simulator.simulator import Simulator
from .kept_files import FileCache, Log
from .object_placement import WorldEdit
from .world_choice import WorldChoice


class Furnisher:
    """Reads worlds and models, and spawns what does not come with the world's file.

    Args:
        files: reads the files.
        log: hears of every issue.
    """

    def __init__(self, files: FileCache, log: Log) -> None:
        self._files = files
        self._log = log

    def load(self, choice: WorldChoice) -> LoadedWorld:
        """The world of a choice.

        Raises:
            InputError: it cannot be used.
            CommandError: a file that the choice expects does not exist.
        """
        for uri in choice.expected_files:
            try:
                self._files.resolver.resolve(uri)
            except ResourceNotFoundError as missing:
                raise CommandError(str(missing)) from None
        loaded = self._files.world(choice, self._log)
        return replace(loaded, world=choice.alter(loaded.world))

    def furnish(self, simulator: Simulator, choice: WorldChoice) -> None:
        """Spawn the objects and models of a choice.

        Raises:
            InputError: one of them cannot be used.
            CommandError: the engine refused one.
        """
        placed, issues = self._files.objects(choice.objects, choice.object_list, choice.world)
        for found in placed:
            model = choice.alter_model(found.model)
            simulator.models.spawn(model, model.pose, meshes=found.meshes)
        self._judge(issues)
        for name, file, pose in choice.models:
            self.spawn(simulator, file, name, pose, choice.alter_model, choice.namespace)
        for name in choice.expected_models:
            simulator.models.get(name)

    def spawn(self, simulator: Simulator, document: Text, name: Optional[str], pose: Pose,
              alter: WorldEdit, namespace: str) -> str:
        """Spawn the model of a document; returns its name. Raises as `furnish`."""
        found, meshes, issues = self._files.model(document)
        model = alter(replace(found, name=found.name if name is None else name,
                              pose=compose(pose, found.pose)))
        self._judge(issues)
        if namespace:
            model = with_namespace(model, namespace)
        simulator.models.spawn(model, model.pose, meshes=meshes)
        return model.name

    def _judge(self, issues: Sequence[Issue]) -> None:
        for issue in group_repeated(issues):
            self._log(issue)
        if errors_of(issues):
            raise InputError(issues)
