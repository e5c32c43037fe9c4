"""One shipped model: what it looks like, what it collides with, and its files."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Dict, List, Optional, Tuple

import numpy as np

from my_simulations.description.model import Inertial
from my_simulations.description.shapes import Box, Collision, Cylinder, Geometry, Sphere
from my_simulations.formats.inertia import solid_inertial
from my_simulations.geometry import Pose, pose_from_xyzrpy, rpy_from_quat

from .collada import Color, collada
from .meshes import Mesh, block, joined, lathe

Vec3 = Tuple[float, float, float]
COLORS: Dict[str, Color] = {
    "white": (0.93, 0.93, 0.91),
    "cream": (0.91, 0.86, 0.76),
    "light_grey": (0.74, 0.76, 0.78),
    "grey": (0.5, 0.53, 0.56),
    "steel": (0.62, 0.66, 0.7),
    "dark_grey": (0.24, 0.26, 0.29),
    "black": (0.09, 0.1, 0.11),
    "red": (0.78, 0.16, 0.15),
    "orange": (0.93, 0.46, 0.1),
    "yellow": (0.95, 0.77, 0.16),
    "green": (0.26, 0.53, 0.3),
    "leaf": (0.33, 0.58, 0.25),
    "dark_leaf": (0.2, 0.42, 0.22),
    "teal": (0.13, 0.5, 0.52),
    "blue": (0.16, 0.38, 0.69),
    "navy": (0.13, 0.2, 0.36),
    "glass": (0.2, 0.29, 0.36),
    "screen": (0.1, 0.15, 0.24),
    "wood": (0.7, 0.52, 0.33),
    "light_wood": (0.83, 0.69, 0.5),
    "dark_wood": (0.38, 0.25, 0.17),
    "cardboard": (0.75, 0.58, 0.4),
    "skin": (0.87, 0.67, 0.54),
    "brown_skin": (0.5, 0.34, 0.25),
    "hair": (0.2, 0.14, 0.1),
    "denim": (0.2, 0.3, 0.46),
    "terracotta": (0.72, 0.39, 0.26),
    "soil": (0.27, 0.19, 0.13),
    "concrete": (0.66, 0.65, 0.62),
    "rock": (0.48, 0.46, 0.43),
    "rubber": (0.13, 0.13, 0.14),
    "light": (1.0, 0.94, 0.75),
    "pink": (0.87, 0.55, 0.58),
}


@dataclass
class Model:
    """A model of one link with one mesh.

    Attributes:
        name: of the model and its folder.
        title, description: for `model.config`.
        kind: a word that the Insert tab finds the model by, after the description.
        mass: kg; None for a static model.
        friction: coefficient mu.
        mesh_scale: size of the model relative to its mesh file.
    """

    name: str
    title: str
    description: str
    mass: Optional[float] = None
    friction: float = 0.6
    kind: str = ""
    mesh_scale: float = 1.0
    parts: List[Tuple[str, Mesh]] = field(default_factory=list)
    collisions: List[Collision] = field(default_factory=list)

    def look(self, color: str, *meshes: Mesh) -> None:
        """Adds meshes of a colour of `COLORS`."""
        self.parts += [(color, mesh) for mesh in meshes]

    def box(self, size: Vec3, at: Vec3, rpy: Vec3 = (0.0, 0.0, 0.0)) -> None:
        """Adds a box to collide with, `at` its centre."""
        self._collide(Box(size), at, rpy)

    def cylinder(self, radius: float, length: float, at: Vec3, rpy: Vec3 = (0.0, 0.0, 0.0)) -> None:
        """Adds a cylinder to collide with, `at` its centre."""
        self._collide(Cylinder(radius, length), at, rpy)

    def sphere(self, radius: float, at: Vec3) -> None:
        """Adds a sphere to collide with."""
        self._collide(Sphere(radius), at, (0.0, 0.0, 0.0))

    def block(self, color: str, size: Vec3, at: Vec3, bevel: float = 0.01) -> None:
        """Adds a box that is seen and collided with."""
        self.look(color, block(size, at, bevel))
        self.box(size, at)

    def drum(
        self,
        color: str,
        radius: float,
        length: float,
        at: Vec3,
        bevel: float = 0.01,
        sides: int = 20,
    ) -> None:
        """Adds an upright cylinder that is seen and collided with."""
        bevel = min(bevel, length * 0.4, radius * 0.4)
        half = length / 2
        self.look(
            color,
            lathe(
                [
                    (radius - bevel, -half),
                    (radius, bevel - half),
                    (radius, half - bevel),
                    (radius - bevel, half),
                ],
                sides,
            ).moved(*at),
        )
        self.cylinder(radius, length, at)

    def _collide(self, geometry: Geometry, at: Vec3, rpy: Vec3) -> None:
        self.collisions.append(
            Collision(
                name=f"collision_{len(self.collisions) + 1}",
                pose=pose_from_xyzrpy(*at, *rpy),
                geometry=geometry,
            )
        )

    def files(self) -> Dict[str, bytes]:
        """Content by path below the model's folder."""
        return {
            "model.config": self._config().encode(),
            "model.sdf": self._sdf().encode(),
            f"meshes/{self.name}.dae": self._mesh().encode(),
        }

    def _mesh(self) -> str:
        colors = list(dict.fromkeys(color for color, _ in self.parts))
        return collada(
            self.name,
            [
                (
                    color,
                    COLORS[color],
                    self._in_file(joined([mesh for other, mesh in self.parts if other == color])),
                )
                for color in colors
            ],
        )

    def _in_file(self, mesh: Mesh) -> Mesh:
        return replace(mesh, vertices=mesh.vertices / self.mesh_scale)

    def _config(self) -> str:
        return f"""<?xml version="1.0" ?>
<model>
  <name>{self.title}</name>
  <version>1.0</version>
  <sdf version="1.6">model.sdf</sdf>
  <author>
    <name>my_simulations</name>
  </author>
  <description>{self.description} {self.kind}.</description>
</model>
"""

    def _sdf(self) -> str:
        static = "    <static>true</static>\n" if self.mass is None else ""
        inertial = _inertial(self.inertial()) if self.mass is not None else ""
        collisions = "".join(map(self._collision, self.collisions))
        scale = (
            "" if self.mesh_scale == 1.0 else f"<scale>{_numbers((self.mesh_scale,) * 3)}</scale>"
        )
        return f"""<?xml version="1.0" ?>
<sdf version="1.6">
  <model name="{self.name}">
{static}    <link name="link">
{inertial}{collisions}      <visual name="visual">
        <geometry><mesh><uri>model://{self.name}/meshes/{self.name}.dae</uri>{scale}</mesh></geometry>
      </visual>
    </link>
  </model>
</sdf>
"""

    def _collision(self, collision: Collision) -> str:
        shape = collision.geometry
        if isinstance(shape, Box):
            text = f"<box><size>{_numbers(shape.size)}</size></box>"
        elif isinstance(shape, Sphere):
            text = f"<sphere><radius>{shape.radius:g}</radius></sphere>"
        else:
            assert isinstance(shape, Cylinder)
            text = (
                f"<cylinder><radius>{shape.radius:g}</radius>"
                f"<length>{shape.length:g}</length></cylinder>"
            )
        mu = f"{self.friction:g}"
        return (
            f'      <collision name="{collision.name}">\n'
            f"        <pose>{_pose(collision.pose)}</pose>\n"
            f"        <geometry>{text}</geometry>\n"
            f"        <surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction>"
            "</surface>\n      </collision>\n"
        )

    def inertial(self) -> Inertial:
        """Mass properties of the collision shapes at one density."""
        assert self.mass is not None
        found = solid_inertial(self.mass, self.collisions)
        assert found is not None, f"{self.name} has no solid shape"
        return found


def _inertial(i: Inertial) -> str:
    values = "".join(
        f"<{key}>{round(getattr(i, key), 9) + 0.0:.6g}</{key}>"
        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return (
        f"      <inertial>\n        <mass>{i.mass:g}</mass>\n"
        f"        <pose>{_pose(i.pose)}</pose>\n"
        f"        <inertia>{values}</inertia>\n      </inertial>\n"
    )


def _pose(pose: Pose) -> str:
    return _numbers((*pose.position, *rpy_from_quat(pose.orientation)))


def _numbers(values: Tuple[float, ...]) -> str:
    return " ".join(f"{value:.6g}" for value in (np.round(values, 7) + 0.0))
