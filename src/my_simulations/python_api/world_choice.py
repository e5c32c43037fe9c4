"""Which world a Python program opens."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Tuple

from ..description.world import World
from ..errors import CommandError
from ..geometry import Pose
from .object_placement import WorldEdit


@dataclass(frozen=True)
class WorldChoice:
    """Which world to open; see `open_world`.

    Attributes:
        models: name, URDF or SDF document (path or text), and pose of each model to spawn
            besides.
        alter: changes the description of the world before it is loaded; it must leave its argument
            as it is.
        alter_model: the same for each object and model; `Model.pose` is its place.
        namespace: of the plugins of `models`, see `OpenWorld.spawn`.
        expected_models: names of models that the world must then have.
        expected_files: URIs of files that must exist.

    Raises CommandError if `models` has another form.
    """

    world: str = "worlds/empty.world"
    seed: int = 0
    profile: str = ""
    objects: Tuple[str, ...] = ()
    object_list: str = ""
    models: Tuple[Tuple[str, str, Pose], ...] = ()
    alter: Callable[[World], World] = lambda world: world
    alter_model: WorldEdit = lambda model: model
    namespace: str = ""
    expected_models: Tuple[str, ...] = ()
    expected_files: Tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for one in self.models:
            if not isinstance(one, (tuple, list)) or len(one) != 3 or not isinstance(one[2], Pose):
                raise CommandError("each of the models is a name, a document and a Pose, not"
                                   f" {one!r:.80}")
