"""Mimic joints keep their ratio while a gripper presses an object."""
from __future__ import annotations

import numpy as np
import pytest

import my_simulations

_INERTIAL = """<inertial><mass value="0.02"/>
<inertia ixx="2e-6" iyy="2e-6" izz="2e-6" ixy="0" ixz="0" iyz="0"/></inertial>"""


def _joint(name, parent, child, xyz, axis, mimic=""):
    return f"""<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="{xyz}"/><axis xyz="{axis}"/><limit lower="-1" upper="1" effort="4" velocity="2"/>
{mimic}</joint>"""


def _finger(side, sign):
    """A knuckle, and a tip that mimics it to stay parallel."""
    lead = "" if side == "left" else '<mimic joint="left"/>'
    return f"""<link name="{side}_knuckle">{_INERTIAL}</link><link name="{side}_tip">{_INERTIAL}
<collision><origin xyz="0 0 0.03"/><geometry><box size="0.01 0.02 0.05"/></geometry></collision>
</link>{_joint(side, "palm", f"{side}_knuckle", f"{sign * 0.06} 0 0.05", f"0 {-sign} 0", lead)}
{_joint(f"{side}_tip", f"{side}_knuckle", f"{side}_tip", "0 0 0.06", f"0 {-sign} 0",
        '<mimic joint="left" multiplier="-1"/>')}"""


HAND = f"""<robot name="hand"><link name="world"/><link name="palm"><inertial><mass value="1"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="mount" type="fixed"><parent link="world"/><child link="palm"/></joint>
{_finger("left", 1)}{_finger("right", -1)}</robot>"""
WORLD = """<sdf version="1.6"><world name="w"><physics type="ode">
<max_step_size>{step}</max_step_size>
</physics><model name="cube"><pose>0 0 0.14 0 0 0</pose><link name="link"><inertial>
<mass>0.2</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial>
<gravity>0</gravity><collision name="c"><geometry><box><size>0.05 0.05 0.05</size></box></geometry>
</collision></link></model></world></sdf>"""


@pytest.mark.parametrize("step", [0.001, 0.002, 0.005])
def test_fingers_that_press_an_object_stay_together(tmp_path, step):
    file = tmp_path / "hand.world"
    file.write_text(WORLD.format(step=step))
    with my_simulations.open_world(file) as world:
        world.spawn(HAND, "hand")
        world.move_joint("hand::left", 0.8)
        world.step(round(1.0 / step))
        assert ("hand::left_tip", "cube::link") in {
            tuple(sorted(pair, reverse=True)) for pair in world.contact_forces()}
        worst = 0.0
        for _ in range(50):
            world.step(round(0.01 / step))
            positions = world.robot("hand").positions
            left = positions["left"]
            worst = max(worst, float(np.max(np.abs([
                positions["right"] - left, positions["left_tip"] + left,
                positions["right_tip"] + left]))))
        assert 0.1 < left < 0.7 and worst < 0.002, (left, worst)
