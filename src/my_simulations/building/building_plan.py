"""The plan of a building: levels with walls, openings, stairs and floors, and a roof.

Metres and radians in the plan frame, x to the right and y up. Items of each kind have unique ids
over the whole plan, counted from 0; links of the model are named by them (`Wall_0`, `Floor_1`, …:
Gazebo behaviour).
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Dict, Iterator, List, Optional, Tuple

Point = Tuple[float, float]

WHITE = "#ffffff"

WALL_THICKNESS = 0.15
WALL_HEIGHT = 2.5
FLOOR_THICKNESS = 0.1
DEFAULT_NAME = "Untitled"


@dataclass
class Wall:
    """A straight wall along its centre line, from `start` to `end`.

    Walls of a level with a common end point are linked there.
    """

    id: int
    start: Point
    end: Point
    thickness: float = WALL_THICKNESS
    height: float = WALL_HEIGHT
    color: str = WHITE
    texture: str = ""

    @property
    def length(self) -> float:
        """Length of the centre line, m."""
        return math.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @property
    def yaw(self) -> float:
        """Direction from start to end, rad."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])


@dataclass
class Opening:
    """A window or door, in a wall or free-standing.

    In a wall (`wall` is its id), `along` is the distance of the opening's centre from the wall's
    start; `position` and `yaw` are unused. A free-standing one makes no hole.
    """

    id: int
    width: float
    height: float
    elevation: float = 0.0
    depth: float = 0.17
    wall: Optional[int] = None
    along: float = 0.0
    position: Point = (0.0, 0.0)
    yaw: float = 0.0


@dataclass
class Stairs:
    """A flight of stairs that ascends along its own +y; `position`: centre of its footprint."""

    id: int
    position: Point
    yaw: float = 0.0
    width: float = 1.0
    depth: float = 3.5
    height: float = 2.5
    steps: int = 15
    color: str = WHITE
    texture: str = ""

    def corners(self) -> List[Point]:
        """Corners of the footprint, counter-clockwise."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        x, y = self.width / 2, self.depth / 2
        return [(self.position[0] + cos * u - sin * v, self.position[1] + sin * u + cos * v)
                for u, v in ((-x, -y), (x, -y), (x, y), (-x, y))]

    @property
    def foot(self) -> Point:
        """Midpoint of the lower edge."""
        return (self.position[0] + math.sin(self.yaw) * self.depth / 2,
                self.position[1] - math.cos(self.yaw) * self.depth / 2)


@dataclass
class Floor:
    """A floor slab at the base of its level, with holes for the stairs of the level below.

    `fit`: what the editor fits the outline to: `walls` or `none`.
    """

    id: int
    outline: List[Point]
    holes: List[List[Point]] = field(default_factory=list)
    thickness: float = FLOOR_THICKNESS
    color: str = WHITE
    texture: str = ""
    fit: str = "none"


@dataclass
class FloorImage:
    """A floor-plan image, centred on the origin; `resolution` in pixels per metre.

    `data` is a `data:` URL in messages of the editor; in a folder the image is `file`.
    """

    file: str
    resolution: float = 100.0
    data: str = ""


@dataclass
class Level:
    """A storey; the base of the next one is `height` above its own."""

    name: str
    height: float = WALL_HEIGHT
    walls: List[Wall] = field(default_factory=list)
    windows: List[Opening] = field(default_factory=list)
    doors: List[Opening] = field(default_factory=list)
    stairs: List[Stairs] = field(default_factory=list)
    floors: List[Floor] = field(default_factory=list)
    image: Optional[FloorImage] = None

    def openings(self) -> Iterator[Tuple[str, Opening]]:
        """Windows, then doors, each with the name of its kind."""
        for opening in self.windows:
            yield "Window", opening
        for opening in self.doors:
            yield "Door", opening


@dataclass
class Roof:
    """A roof over the walls of the top level; `kind` is `flat` or `gable`.

    `overhang`: extent beyond the walls, m. `pitch`: angle of a gable roof, rad; its ridge is along
    the longer side.
    """

    kind: str = "flat"
    thickness: float = FLOOR_THICKNESS
    overhang: float = 0.0
    pitch: float = math.radians(30.0)
    color: str = WHITE
    texture: str = ""


@dataclass
class Plan:
    """A whole building; `next`: next free id of each kind (`wall`, `window`, …)."""

    name: str = DEFAULT_NAME
    levels: List[Level] = field(default_factory=lambda: [Level("Level 1")])
    roof: Optional[Roof] = None
    next: Dict[str, int] = field(default_factory=dict)

    def bases(self) -> List[float]:
        """Height of each level's base above the ground, m."""
        bases, z = [], 0.0
        for level in self.levels:
            bases.append(z)
            z += level.height
        return bases
