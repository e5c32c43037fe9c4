"""The `<gripper>` of a model holds an object in worlds of the Python library."""
from __future__ import annotations

import pytest

import my_simulations

STEPS = (0.001, 0.002, 0.005)
MASS = 0.2
CUBE = f"""<model name="cube"><pose>0 0 0.025 0 0 0</pose><link name="link">
<inertial><mass>{MASS}</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>
</inertial><collision name="c"><geometry><box><size>.05 .05 .05</size></box></geometry>
</collision></link></model>"""
GRIPPER = """<gripper name="grasp"><grasp_check><attach_steps>1</attach_steps>
<detach_steps>1</detach_steps></grasp_check><gripper_link>left</gripper_link>
<gripper_link>right</gripper_link><palm_link>palm</palm_link></gripper>"""


def finger(name, x):
    return f"""<link name="{name}"><pose>{x} 0 -0.06 0 0 0</pose><inertial><mass>.1</mass>
<inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial><collision name="c">
<geometry><box><size>.02 .05 .1</size></box></geometry></collision></link>
<joint name="{name}_rail" type="prismatic"><parent>palm</parent><child>{name}</child>
<axis><xyz>{-1 if x > 0 else 1} 0 0</xyz><limit><lower>-0.05</lower><upper>0.06</upper>
<effort>20</effort></limit></axis></joint>"""


HAND = f"""<model name="hand"><pose>0 0 0.12 0 0 0</pose><link name="palm"><inertial><mass>1</mass>
<inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia></inertial></link>
<joint name="lift" type="prismatic"><parent>world</parent><child>palm</child><axis>
<xyz>0 0 1</xyz><limit><lower>0</lower><upper>1</upper><effort>500</effort></limit></axis></joint>
{finger("left", -0.06)}{finger("right", 0.06)}{GRIPPER}</model>"""


class Hand:
    """A hand above a cube."""

    def __init__(self, world):
        self.world = world

    def seconds(self, seconds):
        self.world.step(round(seconds / self.world.step_size))

    def close(self, seconds=2.5):
        self._move_fingers(0.06, seconds)

    def open(self, seconds):
        self._move_fingers(-0.02, seconds)

    def _move_fingers(self, position, seconds):
        for name in ("left", "right"):
            self.world.move_joint(f"hand::{name}_rail", position)
        self.seconds(seconds)

    def lift(self, height, seconds=1.0):
        self.world.move_joint("hand::lift", height, rate=0.4)
        self.seconds(seconds)

    @property
    def height(self):
        return self.world.states().pose["cube"][2]

    def assert_holds(self):
        """Pull with 1.5 times the greatest friction of the fingers."""
        before = self.height
        self.world.apply_wrench("cube::link", force=[0, 0, -60], duration=0.3)
        for _ in range(2):   # during the pull, and after it
            self.seconds(0.2)
            assert self.height == pytest.approx(before, abs=2e-4)


@pytest.fixture
def open_hand(tmp_path):
    opened = []

    def make(step, hand=HAND):
        file = tmp_path / "hand.world"
        file.write_text(f"""<sdf version="1.6"><world name="w"><physics type="ode">
<max_step_size>{step}</max_step_size></physics><model name="floor"><static>1</static>
<link name="link"><collision name="c"><geometry><plane><normal>0 0 1</normal></plane></geometry>
</collision></link></model>{hand}{CUBE}</world></sdf>""")
        opened.append(my_simulations.open_world(file))
        return Hand(opened[-1])

    yield make
    for world in opened:
        world.close()


@pytest.mark.parametrize("step", STEPS)
def test_a_gripped_cube_is_fixed_to_the_palm_and_released(open_hand, step):
    hand = open_hand(step)
    hand.close()
    hand.lift(0.2)
    assert hand.height == pytest.approx(0.225, abs=2e-4)
    hand.assert_holds()
    hand.open(1.0)
    assert hand.height == pytest.approx(0.225, abs=2e-4)   # one update without contact
    hand.seconds(1.5)
    assert hand.height == pytest.approx(0.025, abs=0.001)


def test_without_a_gripper_the_cube_slips_from_the_fingers(open_hand):
    hand = open_hand(0.001, HAND.replace(GRIPPER, ""))
    hand.close()
    hand.lift(0.2)
    assert hand.height == pytest.approx(0.225, abs=1e-3)
    hand.world.apply_wrench("cube::link", force=[0, 0, -60], duration=0.3)
    hand.seconds(0.4)
    assert hand.height < 0.1


def test_a_gripper_holds_again_after_a_reset(open_hand):
    hand = open_hand(0.002)
    for _ in range(2):
        hand.close()
        hand.lift(0.2)
        hand.assert_holds()
        hand.world.reset()
        hand.open(0.5)
        hand.lift(0.2)
        assert hand.height == pytest.approx(0.025, abs=0.001)
        hand.world.reset()


GRASP_FIX = """<plugin name="fix" filename="libgazebo_grasp_fix.so"><arm><arm_name>arm</arm_name>
<palm_link>palm</palm_link><gripper_link>left</gripper_link><gripper_link>right</gripper_link>
</arm></plugin>"""


@pytest.mark.parametrize("element", [GRIPPER, GRASP_FIX])
def test_an_object_of_a_restored_state_is_held_and_released(open_hand, element):
    hand = open_hand(0.002, HAND.replace(GRIPPER, element))
    free = hand.world.save()
    hand.close()
    hand.lift(0.2)
    held = hand.world.save()
    for state in (held, free, held):
        hand.world.restore(state)
        if state is held:
            hand.close(1.0)
            hand.assert_holds()
        else:
            assert hand.height == pytest.approx(0.025, abs=0.001)
        hand.open(2.5)
        assert hand.height == pytest.approx(0.025, abs=0.001)


def test_a_cube_that_is_removed_and_spawned_again_is_held(open_hand):
    hand = open_hand(0.002)
    hand.close()
    hand.world.remove("cube")
    hand.open(0.5)
    hand.world.spawn(f"<sdf version='1.6'>{CUBE}</sdf>")
    hand.close()
    hand.lift(0.2)
    hand.assert_holds()
    assert not [issue for issue in hand.world.issues if issue.severity.name != "NOTE"]


def test_a_cube_falls_when_its_hand_is_removed(open_hand):
    hand = open_hand(0.002)
    hand.close()
    hand.lift(0.2)
    hand.world.remove("hand")
    hand.seconds(1.0)
    assert hand.height == pytest.approx(0.025, abs=0.001)


def test_a_gripper_of_a_saved_world_holds(open_hand, tmp_path):
    hand = open_hand(0.002)
    hand.close()
    saved = tmp_path / "saved.world"
    hand.world.save_world(saved)
    with my_simulations.open_world(saved) as world:
        again = Hand(world)
        again.close()
        again.lift(0.2)
        again.assert_holds()


def test_a_gripper_of_an_included_model_holds(open_hand):
    """Its links belong to a nested model."""
    inner = HAND.replace("<pose>0 0 0.12 0 0 0</pose>", "").replace(
        '<model name="hand">', '<model name="inner">').replace(
        "<parent>world</parent>", "<parent>base</parent>").replace(
        '<link name="palm">', '<link name="base"/><link name="palm">')
    hand = open_hand(0.002, f"""<model name="hand"><pose>0 0 0.12 0 0 0</pose>{inner}
<joint name="mount" type="fixed"><parent>world</parent><child>inner::base</child></joint>
</model>""")
    world = hand.world
    for name in ("left", "right"):
        world.move_joint(f"hand::inner::{name}_rail", 0.06)
    hand.seconds(2.5)
    world.move_joint("hand::inner::lift", 0.2)
    hand.seconds(1.0)
    assert hand.height == pytest.approx(0.225, abs=2e-4)
    hand.assert_holds()


def test_a_gripper_in_a_robot_description_holds(open_hand):
    """A lumped palm stands for the link that the gripper names."""
    hand = open_hand(0.002, "")
    rails = "".join(f"""<link name="{name}"><inertial><mass value="0.1"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial><collision>
<geometry><box size="0.02 0.05 0.1"/></geometry></collision></link>
<joint name="{name}_rail" type="prismatic"><parent link="palm"/><child link="{name}"/>
<origin xyz="{x} 0 -0.06"/><axis xyz="{-1 if x > 0 else 1} 0 0"/>
<limit lower="-0.05" upper="0.06" effort="20" velocity="1"/></joint>"""
                    for name, x in (("left", -0.06), ("right", 0.06)))
    inertial = """<inertial><mass value="1"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>"""
    hand.world.spawn(f"""<robot name="hand"><link name="world"/><link name="wrist">{inertial}</link>
<link name="palm">{inertial}</link><joint name="lift" type="prismatic"><parent link="world"/>
<child link="wrist"/><origin xyz="0 0 0.12"/><axis xyz="0 0 1"/>
<limit lower="0" upper="1" effort="500" velocity="1"/></joint>
<joint name="flange" type="fixed"><parent link="wrist"/><child link="palm"/></joint>
{rails}<gazebo>{GRIPPER}</gazebo></robot>""")
    hand.close()
    hand.lift(0.2)
    assert hand.height == pytest.approx(0.225, abs=2e-4)
    hand.assert_holds()
