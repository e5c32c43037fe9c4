"""Links, joints and plugins as SDF text: solid bodies of even density with exact inertia."""
from __future__ import annotations

from typing import Mapping, Sequence, Tuple

Triple = Tuple[float, float, float]

PAINT: Mapping[str, Triple] = {
    "orange": (0.90, 0.42, 0.10), "dark": (0.12, 0.13, 0.15), "light": (0.82, 0.84, 0.86),
    "blue": (0.16, 0.40, 0.72), "glass": (0.05, 0.16, 0.26),
}
"""Diffuse colors, 0 to 1."""


def format_numbers(values: Sequence[float]) -> str:
    """Numbers with six significant digits, separated by blanks."""
    return " ".join(f"{value:.6g}" for value in values)


def pose(position: Triple, angles: Triple = (0.0, 0.0, 0.0)) -> str:
    """A pose element: m, and roll, pitch, yaw in rad."""
    return f"<pose>{format_numbers((*position, *angles))}</pose>"


def box(size: Triple) -> str:
    """The geometry of a box; m."""
    return f"<geometry><box><size>{format_numbers(size)}</size></box></geometry>"


def cylinder(radius: float, length: float) -> str:
    """The geometry of a cylinder along z; m."""
    return (f"<geometry><cylinder><radius>{radius:.6g}</radius><length>{length:.6g}</length>"
            "</cylinder></geometry>")


def sphere(radius: float) -> str:
    """The geometry of a sphere; m."""
    return f"<geometry><sphere><radius>{radius:.6g}</radius></sphere></geometry>"


def box_inertial(mass: float, size: Triple, center: Triple = (0.0, 0.0, 0.0)) -> str:
    """A solid box; kg, m."""
    x, y, z = size
    return _inertial(mass, (mass * (y * y + z * z) / 12.0, mass * (x * x + z * z) / 12.0,
                            mass * (x * x + y * y) / 12.0), center)


def cylinder_inertial(mass: float, radius: float, length: float,
                      center: Triple = (0.0, 0.0, 0.0)) -> str:
    """A solid cylinder along z; kg, m."""
    across = mass * (3.0 * radius * radius + length * length) / 12.0
    return _inertial(mass, (across, across, mass * radius * radius / 2.0), center)


def _inertial(mass: float, moments: Triple, center: Triple) -> str:
    ixx, iyy, izz = (f"{moment:.6g}" for moment in moments)
    return (f"<inertial>{pose(center)}<mass>{mass:.6g}</mass><inertia><ixx>{ixx}</ixx>"
            f"<ixy>0</ixy><ixz>0</ixz><iyy>{iyy}</iyy><iyz>0</iyz><izz>{izz}</izz></inertia>"
            "</inertial>")


def friction(mu: float) -> str:
    """A surface with one friction coefficient in both directions."""
    return f"<surface><friction><ode><mu>{mu:g}</mu><mu2>{mu:g}</mu2></ode></friction></surface>"


def collision(name: str, geometry: str, at: str = "", surface: str = "") -> str:
    """A collision; `at` is a pose element."""
    return f'<collision name="{name}">{at}{geometry}{surface}</collision>'


def visual(name: str, geometry: str, color: str, at: str = "") -> str:
    """A visual in one of the colors of PAINT; `at` is a pose element."""
    rgb = format_numbers((*PAINT[color], 1.0))
    return (f'<visual name="{name}">{at}{geometry}<material><ambient>{rgb}</ambient><diffuse>{rgb}'
            "</diffuse><specular>0.1 0.1 0.1 1</specular></material></visual>")


def collision_and_visual(name: str, geometry: str, color: str, at: str = "",
                         surface: str = "") -> str:
    """Return the SDF of a collision and a visual of one shape."""
    return (collision(f"{name}_collision", geometry, at, surface)
            + visual(f"{name}_visual", geometry, color, at))


def link(name: str, at: str, *content: str) -> str:
    """A link; `at` is a pose element in the model."""
    return f'<link name="{name}">{at}{"".join(content)}</link>'


def fixed_joint(name: str, parent: str, child: str) -> str:
    return (f'<joint name="{name}" type="fixed"><parent>{parent}</parent><child>{child}</child>'
            "</joint>")


def moving_joint(name: str, kind: str, parent: str, child: str, axis: Triple,
                 limits: Tuple[float, float, float, float], damping: float = 0.0) -> str:
    """Return the SDF of a revolute or prismatic joint.

    Args:
        name: of the joint.
        kind: `revolute` or `prismatic`.
        parent: name of a link.
        child: name of a link.
        axis: in the frame of the child link.
        limits: lower and upper in rad or m, effort in N m or N, velocity in rad/s or m/s.
        damping: N m s/rad or N s/m.
    """
    lower, upper, effort, velocity = limits
    xyz = format_numbers(axis)
    return (f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
            f"<axis><xyz>{xyz}</xyz><limit><lower>{lower:.6g}</lower><upper>{upper:.6g}"
            f"</upper><effort>{effort:.6g}</effort><velocity>{velocity:.6g}</velocity></limit>"
            f"<dynamics><damping>{damping:.6g}</damping></dynamics></axis></joint>")


def plugin(name: str, library: str, **parameters: object) -> str:
    """A plugin element with one child element for each parameter."""
    inner = "".join(f"<{key}>{value}</{key}>" for key, value in parameters.items())
    return f'<plugin name="{name}" filename="{library}">{inner}</plugin>'


def document(name: str, *content: str, static: bool = False) -> str:
    """A whole SDF file with one model."""
    fixed_in_world = "<static>true</static>" if static else ""
    return (f'<?xml version="1.0"?>\n<sdf version="1.6"><model name="{name}">{fixed_in_world}'
            f'{"".join(content)}</model></sdf>\n')
