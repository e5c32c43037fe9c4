"""What plugins that act cost: the same models without, and with them, in one run."""
from __future__ import annotations

import statistics
from typing import Dict, List, NamedTuple

from row_table import Row
from server import Server
from stock_robots import measure, settle

TURNS, SETTLE_S, MEASURE_S = 5, 1.5, 3.0
INERTIAL = ("<inertial><mass>{mass}</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz>"
            "</inertia></inertial>")
FLOATS = INERTIAL.format(mass=1.0) + "<gravity>false</gravity>"


class Case(NamedTuple):
    """Models whose plugin is measured.

    Attributes:
        models: SDF; PLUGIN stands for what is left out in the case without plugins.
        plugin: SDF.
        world_plugin: of the world.
    """

    models: str
    plugin: str = ""
    world_plugin: str = ""


def _rockers() -> str:
    rockers = "".join(f"""<link name="{name}"><pose>0 {y} 1 0 0 0</pose>
      <inertial><pose>0.1 0 0 0 0 0</pose>{INERTIAL.format(mass=0.5)[10:]}</link>
      <joint name="{name}_joint" type="revolute"><parent>base</parent><child>{name}</child>
      <axis><xyz>0 1 0</xyz><dynamics><damping>0.05</damping></dynamics></axis></joint>"""
                      for name, y in (("a", 0.2), ("b", -0.2)))
    return f"""<model name="rockers"><link name="base"><pose>0 0 1 0 0 0</pose>
      {INERTIAL.format(mass=5.0)}</link><joint name="hung" type="fixed"><parent>world</parent>
      <child>base</child></joint>{rockers}PLUGIN</model>"""


def _floating(name: str, x: float, extra: str = "") -> str:
    return (f'<model name="{name}"><pose>{x} 0 1 0 0 0</pose><link name="link">{FLOATS}'
            f'<velocity_decay><linear>0.01</linear><angular>0.01</angular></velocity_decay></link>'
            f"{extra}</model>")


def _magnet() -> str:
    return """<plugin name="magnet" filename="libgazebo_dipole_magnet.so">
      <bodyName>link</bodyName><dipole_moment>0 0 0.1</dipole_moment></plugin>"""


CASES: Dict[str, Case] = {
    "bar between rockers": Case(_rockers(), """<plugin name="bar"
      filename="libleo_gazebo_differential_plugin.so"><jointA>a_joint</jointA>
      <jointB>b_joint</jointB><forceConstant>5</forceConstant></plugin>"""),
    "two magnets": Case(_floating("m0", 0.0, "PLUGIN") + _floating("m1", 0.5, "PLUGIN"), _magnet()),
    "hand_of_god": Case(_floating("held", 0.0, "PLUGIN"), """<plugin name="hand"
      filename="libgazebo_ros_hand_of_god.so"><linkName>link</linkName></plugin>"""),
    "wind on five links": Case(
        "".join(_floating(f"w{n}", 0.5 * n, "<enable_wind>true</enable_wind>") for n in range(5)),
        world_plugin="""<wind><linear_velocity>0.1 0.05 0</linear_velocity></wind>
        <plugin name="wind" filename="libWindPlugin.so"><force_approximation_scaling_factor>1
        </force_approximation_scaling_factor><horizontal><magnitude><time_for_rise>1
        </time_for_rise></magnitude></horizontal></plugin>"""),
}


def _world(case: Case, plugins: bool) -> str:
    models = case.models.replace("PLUGIN", case.plugin if plugins else "")
    return f"""<?xml version='1.0'?><sdf version='1.6'><world name='default'>
      <physics type='ode'><max_step_size>0.001</max_step_size>
      <real_time_update_rate>1000</real_time_update_rate></physics>
      {case.world_plugin if plugins else ""}{models}</world></sdf>"""


def acting(names: "List[str] | None" = None) -> List[Row]:
    """Processor time with and without each plugin: of each turn both, of all turns the median."""
    import rospy

    rows: List[Row] = []
    for name in names or CASES:
        shares: Dict[bool, List[float]] = {False: [], True: []}
        for _ in range(TURNS):
            for plugins, found in shares.items():
                with Server(_world(CASES[name], plugins)) as server:
                    rospy.wait_for_service("/gazebo/get_world_properties", 60)
                    settle(SETTLE_S)
                    found.append(measure(server, MEASURE_S).share)
        without, used = (statistics.median(shares[one]) for one in (False, True))
        rows.append((f"{name}: processor time without and with the plugin",
                     f"{1e3 * without:.0f} and {1e3 * used:.0f} ms a sim s", "", True))
    return rows
