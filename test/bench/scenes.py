"""The worlds that the benchmark runs, as positions and as SDF."""
from __future__ import annotations

from typing import List, Tuple


def positions(kind: str, count: int) -> List[Tuple[float, float, float]]:
    """Centres of unit boxes: `boxes` in a grid on the ground, `stacks` of ten."""
    if kind == "stacks":
        return [(4.0 * (n // 10), 0.0, 0.5 + n % 10) for n in range(count)]
    side = max(1, round(count ** 0.5))
    return [(2.0 * (n % side), 2.0 * (n // side), 0.5) for n in range(count)]


def world(kind: str, count: int, sleeping: bool, rate: float) -> str:
    """The same as a world file; `rate` steps a second, 0 = as fast as possible."""
    boxes = "".join(
        f"""<model name='b{n}'><pose>{x} {y} {z} 0 0 0</pose>
        <allow_auto_disable>{str(sleeping).lower()}</allow_auto_disable>{box_link()}</model>"""
        for n, (x, y, z) in enumerate(positions(kind, count)))
    return f"""<?xml version='1.0'?><sdf version='1.6'><world name='default'>
      <physics type='ode'><max_step_size>0.001</max_step_size>
      <real_time_update_rate>{rate}</real_time_update_rate></physics>
      <include><uri>model://ground_plane</uri></include>{boxes}</world></sdf>"""


def box_link() -> str:
    """A unit box of 1 kg."""
    i = 1.0 / 6.0
    return f"""<link name='link'><inertial><mass>1</mass><inertia><ixx>{i}</ixx><iyy>{i}</iyy>
      <izz>{i}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
      <collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link>"""


def box_urdf(name: str) -> str:
    """The same as a robot description."""
    i = 1.0 / 6.0
    return f"""<robot name="{name}"><link name="link"><inertial><mass value="1"/>
      <inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial>
      <collision><geometry><box size="1 1 1"/></geometry></collision>
      <visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>"""
