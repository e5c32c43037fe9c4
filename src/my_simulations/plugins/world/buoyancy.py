"""libBuoyancyPlugin.so: a model that is wholly in a fluid.

Parameters and defaults are those of Gazebo: `<fluid_density>` in kg/m^3, and for a link `<link
name="..."><center_of_volume/><volume/></link>`; else volume and centre come from its collisions.
"""
from __future__ import annotations

import math
from typing import Dict, List, Optional, Tuple

from ...description.model import Link as LinkSpec
from ...description.shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, Sphere
from ...engine.wrench_laws import ForceAtPoint
from ...geometry import Vec3, add, scale
from ..base import Plugin
from ..context import Link
from ..parameters import Parameters

_WATER = 999.1026  # kg/m^3, at 15 degrees


class Buoyancy(Plugin):
    """Lifts each link by the weight of the fluid in its place."""

    def load(self) -> None:
        """Find volumes and their centres."""
        context, p = self.context, self.context.parameters
        self._density = p.number("fluid_density", _WATER)
        given = self._read_volumes(p.children("link"))
        self._floats: List[Tuple[Link, float, Vec3]] = []
        for spec in context.description.links:
            found = given.get(spec.name) or self._volume(spec)
            if found is not None and found[0] > 0.0:
                self._floats.append((context.link(spec.name), *found))
        self.update()
        context.on_world_change(self.update)

    def reset(self) -> None:
        """Forces ended with the reset."""
        self.update()

    def _read_volumes(self, blocks: "List[Parameters]") -> Dict[str, Tuple[float, Vec3]]:
        """Return volume and centre by link; report invalid ones, which collisions replace."""
        found: Dict[str, Tuple[float, Vec3]] = {}
        names = {link.name for link in self.context.description.links}
        for block in blocks:
            name, volume = block.attribute("name"), block.number("volume", 0.0)
            if name not in names:
                self.context.warn(f"there is no link '{name}'; its <volume> does nothing")
            elif volume <= 0.0:
                self.context.warn(f"link '{name}' has no <volume> above 0; it is that of its"
                                  " collisions")
            else:
                found[name] = (volume, block.vector("center_of_volume"))
        return found

    def _volume(self, spec: LinkSpec) -> Optional[Tuple[float, Vec3]]:
        total, moment = 0.0, (0.0, 0.0, 0.0)
        for collision in spec.collisions:
            volume = volume_of(collision.geometry)
            if volume is None:
                self.context.warn(f"link '{spec.name}' has a collision whose volume is not known;"
                                  " give its <volume>")
                return None
            total += volume
            moment = add(moment, scale(collision.pose.position, volume))
        return (total, scale(moment, 1.0 / total)) if total > 0.0 else None

    def update(self) -> None:
        """Apply buoyancy at the centres of volume, against the present gravity."""
        for link, volume, centre in self._floats:
            force = scale(self.context.gravity, -self._density * volume)
            self.context.set_wrench_law(link.name, ForceAtPoint(force, centre))


def volume_of(shape: object) -> Optional[float]:
    """Return the volume, m^3; None for shapes without a known one (meshes, planes)."""
    if isinstance(shape, Box):
        return shape.size[0] * shape.size[1] * shape.size[2]
    if isinstance(shape, Sphere):
        return 4.0 / 3.0 * math.pi * shape.radius ** 3
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius ** 2 * shape.length
    if isinstance(shape, Capsule):
        return math.pi * shape.radius ** 2 * (shape.length + 4.0 / 3.0 * shape.radius)
    if isinstance(shape, Ellipsoid):
        return 4.0 / 3.0 * math.pi * shape.radii[0] * shape.radii[1] * shape.radii[2]
    if isinstance(shape, Cone):
        return math.pi * shape.radius ** 2 * shape.length / 3.0
    return None
