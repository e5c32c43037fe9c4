"""Reads worlds, models and objects; once, for programs that open the same ones many times."""
from __future__ import annotations

import os
import pickle
import threading
from collections import OrderedDict
from typing import Any, Callable, Dict, Hashable, List, Optional, Sequence, Tuple

from ..description.model import Model
from ..description.shapes import MeshTable
from ..errors import InputError, Issue, error, group_repeated
from ..formats.mesh.loading import collision_meshes
from ..formats.reading import Entity, LoadedWorld, Text, read_entity, read_file
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import find_world
from ..simulator.world_loading import load_world
from .object_placement import PlacedModel, read_objects
from .world_choice import WorldChoice

Log = Callable[[Issue], None]
ReadModel = Tuple[Model, MeshTable, List[Issue]]
"""A model as its document says, its collision meshes, and all faults and advice."""


class FileCache:
    """Reads files, or gives what it has read of them before.

    Callers may change the returned copy, except meshes and issues. Changed files are read again
    after `forget`. Safe from any thread.

    Args:
        resolver: finds the files.
        keep: how many worlds, models and lists of objects are kept; 0 to read always.
    """

    def __init__(self, resolver: Resolver, keep: int = 0) -> None:
        self.resolver = resolver
        self._keep = keep
        self._lock = threading.Lock()
        self._kept: "OrderedDict[Hashable, Tuple[bytes, Any]]" = OrderedDict()
        self._seeded: Dict[str, bool] = {}

    def world(self, choice: WorldChoice, log: Log) -> LoadedWorld:
        """The world of a choice, not yet altered; `log` hears of every issue.

        Raises InputError if it cannot be used.
        """
        def read() -> Tuple[Any, Any]:
            loaded = load_world(choice.world, self.resolver, lambda issue: None, seed=choice.seed,
                                profile=choice.profile)
            return loaded.world, (loaded.meshes, loaded.issues)

        # A seed matters to files with populations alone.
        seed = choice.seed if self._keep and self._has_population(choice.world) else 0
        key = ("world", choice.world, choice.profile, seed)
        world, (meshes, issues) = self._read_once(key, read)
        for issue in group_repeated(issues):
            log(issue)
        return LoadedWorld(world, meshes, issues)

    def model(self, document: Text) -> ReadModel:
        """The model of a URDF or SDF document, a path or a text.

        Raises InputError if it has none.
        """
        def read() -> Tuple[Any, Any]:
            entity, issues = self._entity(document)
            if not isinstance(entity, Model):
                raise InputError([error("object-not-a-model",
                                        f"{entity.name} is a light, not a model")])
            meshes, faults = collision_meshes(entity)
            return entity, (meshes, [*issues, *faults])

        model, (meshes, issues) = self._read_once(("model", document), read)
        return model, meshes, issues

    def objects(self, names: Sequence[str], file: str, world: str
                ) -> Tuple[List[PlacedModel], List[Issue]]:
        """Objects of a list at their places, see `read_objects`."""
        if not names:
            return [], []

        def read() -> Tuple[Any, Any]:
            placed, issues = read_objects(self.resolver, names, file, world)
            return [one.model for one in placed], ([one.meshes for one in placed], issues)

        models, (meshes, issues) = self._read_once(("objects", tuple(names), file, world), read)
        return [PlacedModel(*pair) for pair in zip(models, meshes)], list(issues)

    def _entity(self, document: Text) -> Tuple[Entity, List[Issue]]:
        if isinstance(document, str) and "<" not in document:
            return read_file(os.path.expanduser(document), self.resolver)
        return read_entity(document, self.resolver)

    def _read_once(self, key: Hashable, read: Callable[[], Tuple[Any, Any]]) -> Tuple[Any, Any]:
        """What was read: a copy of the first part, the second part itself."""
        with self._lock:
            kept: Optional[Tuple[bytes, Any]] = self._kept.get(key)
            if kept is not None:
                self._kept.move_to_end(key)
        if kept is not None:
            return pickle.loads(kept[0]), kept[1]
        found = read()
        if self._keep:
            packed = pickle.dumps(found[0], pickle.HIGHEST_PROTOCOL)
            with self._lock:
                self._kept[key] = packed, found[1]
                while len(self._kept) > self._keep:
                    self._kept.popitem(last=False)
        return found

    def _has_population(self, world: str) -> bool:
        with self._lock:
            known = self._seeded.get(world)
        if known is None:
            known = _mentions_population(world, self.resolver)
            with self._lock:
                self._seeded[world] = known
        return known


def _mentions_population(world: str, resolver: Resolver) -> bool:
    try:
        with open(find_world(world, resolver, ""), "rb") as stream:
            return b"<population" in stream.read()
    except (OSError, ResourceNotFoundError):
        return True
