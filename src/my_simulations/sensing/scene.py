"""What there is to see: bodies by name, lights, surroundings; kept on both sides of the pipe."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Tuple

from ..appearance.looks import Look
from ..description.light import Light
from ..description.model import Model
from ..description.surroundings import Scene
from .api import AddBody, Body, Change, LoadScene, RemoveBody, SetLights

if TYPE_CHECKING:
    from ..appearance.materials import Materials


def body(name: str, model: Model, first_link_row: int, materials: "Materials") -> Body:
    """A flattened model to look at, its materials resolved."""
    looks: Dict[Tuple[int, int], Look] = {}
    for n, link in enumerate(model.links):
        for m, visual in enumerate(link.visuals):
            look = materials.of_visual(visual)
            if look is not None:
                looks[n, m] = look
    return Body(name, model, first_link_row, looks)


class SceneState:
    """Changes, summed up."""

    def __init__(self) -> None:
        self.bodies: Dict[str, Body] = {}
        self.lights: List[Light] = []
        self.scene = Scene()

    def apply(self, change: Change) -> None:
        """Take a change in."""
        if isinstance(change, AddBody):
            self.bodies[change.body.name] = change.body
        elif isinstance(change, RemoveBody):
            self.bodies.pop(change.name, None)
        elif isinstance(change, SetLights):
            self.lights, self.scene = change.lights, change.scene
        else:
            self.bodies = {one.name: one for one in change.bodies}
            self.lights, self.scene = change.lights, change.scene

    def whole(self) -> LoadScene:
        """The one change that makes this of nothing."""
        return LoadScene(list(self.bodies.values()), self.lights, self.scene)
