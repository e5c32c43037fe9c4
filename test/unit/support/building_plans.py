"""Plans that the tests of buildings share."""
from __future__ import annotations

from my_simulations.building.building_plan import Floor, Level, Opening, Plan, Stairs, Wall


def two_rooms():
    """6 x 4 m with a wall in the middle, a door in it, a window, and stairs to a second level."""
    walls = [Wall(0, (0.0, 0.0), (6.0, 0.0)), Wall(1, (6.0, 0.0), (6.0, 4.0)),
             Wall(2, (6.0, 4.0), (0.0, 4.0)), Wall(3, (0.0, 4.0), (0.0, 0.0)),
             Wall(4, (3.0, 0.0), (3.0, 4.0), color="#c2a9a0")]
    ground = Level("Level 1", walls=walls, windows=[Opening(0, 0.8, 0.8, 0.5, wall=0, along=1.5)],
                   doors=[Opening(0, 0.9, 2.0, wall=4, along=2.0)],
                   stairs=[Stairs(0, (4.5, 2.0), width=1.0, depth=3.0)])
    upper = Level("Level 2", walls=[Wall(n + 5, wall.start, wall.end)
                                    for n, wall in enumerate(walls[:4])],
                  floors=[Floor(0, [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)])])
    return Plan("Two rooms", [ground, upper],
                next={"wall": 9, "window": 1, "door": 1, "stairs": 1, "floor": 1})


def one_wall(*openings, length=4.0, **changes):
    """A wall along x from the origin, with windows in it."""
    return Plan("wall", [Level("Level 1", walls=[Wall(0, (0.0, 0.0), (length, 0.0), **changes)],
                               windows=list(openings))])


def link(model, name):
    return next(found for found in model.links if found.name == name)
