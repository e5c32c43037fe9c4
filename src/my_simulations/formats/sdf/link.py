"""SDF links: inertia, shapes, and the frames their poses are given in."""
from __future__ import annotations

from typing import Any, Container, Dict, Iterable, List, Sequence, Set, Tuple

from ...description.model import WORLD, Inertial, Link
from ...description.shapes import Heightmap, ImageMap
from ..inertia import usable_inertia
from ..xml.binding import Found, fill
from ..xml.source import FaultLevel, Source
from .collision_visual import read_collision, read_visual
from .frame_graph import FrameTree
from .model_tables import INERTIAL, LINK
from .sensor_parameters import read_sensor


def relative_to(found: Found) -> str:
    """The frame (`relative_to`) of the `<pose>` of an element; "" for none."""
    for pose in found.get("pose", ()):
        return pose.get("relative_to") or ""
    return ""


class LinkReader:
    """Reads the links of one model.

    Attributes:
        elements: elements by id of the object that was read from them.
        world: name that a link called `world` was given; "" if there is none.
        given_in: (object with a pose, frame of that pose, its link or "") for each named frame.
    """

    def __init__(self, source: Source, frames: FrameTree, taken: Iterable[str] = ()) -> None:
        self._source = source
        self._frames = frames
        self.elements: Dict[int, Any] = {}
        self.given_in: List[Tuple[Any, str, str]] = []
        self.world = ""
        self._taken: Set[str] = set(taken)

    def read_all(self, elements: Sequence[Any], static: bool) -> List[Link]:
        """The links of the model, with unique names."""
        known = {element.get("name", "") for element in elements} | self._taken
        return [self.read(element, static, known) for element in elements]

    def _name(self, element: Any, known: Set[str]) -> str:
        """The link's name, changed if it is not unique or is that of the world.

        Of two links with one name Gazebo keeps both, and joints use the first.
        """
        name: str = element.get("name", "")
        if name == WORLD:
            self.world = name = free_name(WORLD, known)
            self._source.tolerate("name-reserved", f"a link is named 'world', which means the"
                                  f" world in joints; it is renamed to {name!r}", element)
        elif name and name in self._taken:
            name = free_name(name, known)
            self._source.tolerate("name-repeated", f"there are two links named"
                                  f" {element.get('name')!r}; the second is renamed to {name!r}",
                                  element, "names are unique within a model")
        known.add(name)
        self._taken.add(name)
        return name

    def read(self, element: Any, static: bool, known: Set[str]) -> Link:
        """A link. Source: SDF spec 1.7, link."""
        source = self._source
        link = Link(self._name(element, known))
        self.elements[id(link)] = element
        found = fill(link, element, LINK, source, link.extra)
        self._frames.add(link.name, link.pose, relative_to(found), element, link.name)
        if relative_to(found):
            self.given_in.append((link, link.name, ""))
        for child in found.get("inertial", ())[:1]:
            link.inertial = Inertial()
            # A static model ignores its inertia, whatever it says (SDF spec, model/static).
            inside = fill(link.inertial, child, INERTIAL, source, link.extra,
                          FaultLevel.WARNING if static else None)
            self.elements[id(link.inertial)] = child
            self._note_pose(link.inertial, inside, link)
        self.elements.setdefault(id(link.inertial), element)
        for child in found.get("collision", ()):
            collision = read_collision(child, source, link.extra)
            if collision is not None:
                link.collisions.append(collision[0])
                self.elements[id(collision[0])] = child
                self._note_pose(*collision, link)
        for child in found.get("visual", ()):
            visual = read_visual(child, source, link.extra)
            if visual is not None:
                link.visuals.append(visual[0])
                self.elements[id(visual[0])] = child
                self._note_pose(*visual, link)
        for child in found.get("sensor", ()):
            link.sensors.append(read_sensor(child, source))
            self.elements[id(link.sensors[-1])] = child
            pose = child.find("pose")
            if pose is not None and pose.get("relative_to"):
                self.given_in.append((link.sensors[-1], pose.get("relative_to"), link.name))
        if not (static or link.kinematic):
            self._complete_inertia(link)
        self._distinct("collision", link.collisions, link)
        self._distinct("visual", link.visuals, link)
        return link

    def _complete_inertia(self, link: Link) -> None:
        element = self.elements[id(link.inertial)]
        link.inertial = usable_inertia(link, self._source, element)
        self.elements[id(link.inertial)] = element

    def _note_pose(self, thing: Any, found: Found, link: Link) -> None:
        frame = relative_to(found)
        if frame:
            self.given_in.append((thing, frame, link.name))

    def _distinct(self, kind: str, items: List[Any], link: Link) -> None:
        """Add a suffix to repeated names, and a name to items without one."""
        used: Set[str] = set()
        for item in items:
            wanted = item.name or f"{link.name}_{kind}"
            name, count = wanted, 0
            while name in used:
                count += 1
                name = f"{wanted}_{count}"
            if name != item.name:
                self._source.warn(
                    "name-changed", f"{kind} {item.name!r} of link {link.name!r} is called"
                    f" {name!r}, since names are unique within a link", self.elements[id(item)],
                )
                item.name = name
            used.add(name)


def free_name(wanted: str, taken: Container[str]) -> str:
    """The first free name among `wanted_1`, `wanted_2`, ..."""
    count = 1
    while f"{wanted}_{count}" in taken:
        count += 1
    return f"{wanted}_{count}"


def must_be_static(link: Link) -> bool:
    """True for a link with a heightmap or image collision, which cannot move (Gazebo behaviour)."""
    return any(isinstance(one.geometry, (Heightmap, ImageMap)) for one in link.collisions)
