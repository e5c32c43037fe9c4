"""The world file of tasks, and documents of their boxes and marks."""
from __future__ import annotations

from typing import Optional, Sequence

Size = Sequence[float]


def world_file(accurate_friction: bool) -> str:
    """Return the world of a task; with False, the one that takes the least processor time."""
    return "worlds/empty.world" if accurate_friction else "worlds/learning.world"


_MODEL = ('<sdf version="1.6"><model name="{name}">{static}<link name="link">{parts}</link></model>'
          '</sdf>')
_VISUAL = ('<visual name="visual"><pose>0 0 {rise} 0 0 0</pose><geometry>{shape}</geometry>'
           '<material><ambient>{colour}</ambient><diffuse>{colour}</diffuse></material></visual>')
_COLLISION = ('<collision name="collision"><geometry>{shape}</geometry><surface><friction><ode>'
              '<mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface></collision>')
_INERTIAL = ('<inertial><mass>{mass}</mass><inertia><ixx>{x!r}</ixx><iyy>{y!r}</iyy>'
             '<izz>{z!r}</izz></inertia></inertial>')


def box(name: str, size: Size, colour: str, mass: Optional[float] = None, mu: float = 1.0) -> str:
    """Return the SDF document of a box whose origin is its centre.

    Args:
        name: of the model; its link is `link`.
        size: of the edges, m.
        colour: red, green, blue and alpha, 0 to 1.
        mass: kg; None for a static box.
        mu: coefficient of friction.
    """
    shape = "<box><size>{} {} {}</size></box>".format(*size)
    parts = _COLLISION.format(shape=shape, mu=mu) + _VISUAL.format(shape=shape, colour=colour,
                                                                   rise=0.0)
    if mass is not None:
        x, y, z = (edge * edge * mass / 12.0 for edge in size)
        parts = _INERTIAL.format(mass=mass, x=y + z, y=x + z, z=x + y) + parts
    return _MODEL.format(name=name, static="" if mass is not None else "<static>1</static>",
                         parts=parts)


def disc(name: str, radius: float, colour: str) -> str:
    """Return the SDF document of a disc on the ground that nothing collides with; m."""
    shape = f"<cylinder><radius>{radius}</radius><length>0.004</length></cylinder>"
    return _mark(name, shape, colour, 0.002)


def ball(name: str, radius: float, colour: str) -> str:
    """Return the SDF document of a ball that nothing collides with; m."""
    return _mark(name, f"<sphere><radius>{radius}</radius></sphere>", colour, 0.0)


def _mark(name: str, shape: str, colour: str, rise: float) -> str:
    return _MODEL.format(name=name, static="<static>1</static>",
                         parts=_VISUAL.format(shape=shape, colour=colour, rise=rise))
