"""Where bodies are, read without how fast they go."""
from __future__ import annotations

import math
from array import array

import pybullet
from conftest import STILL, Lab, arm, ball, box, ground, inertial_of_box

from my_simulations.description.model import JointAxis, Link, Model
from my_simulations.engine.bullet.bodies import mark_asleep
from my_simulations.engine.commands import Restart
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.ring import LINK_WIDTH, pose_and_twist
from my_simulations.geometry import Pose


def _rows(lab: Lab) -> bytes:
    return b"".join(bytes(table) for table in lab.backend.tables())


def _uneven() -> Model:
    """A link whose centre of mass is elsewhere, and turned."""
    return Model("uneven", links=[Link("link", inertial=inertial_of_box(
        2, 1, 2, 3, Pose((0.4, 0.1, -0.2), (0.6, 0.0, 0.0, 0.8))))])


def test_poses_read_alone_are_those_of_a_whole_read_out(lab):
    uneven, hinged = lab.load(_uneven(), (0, 0, 9)), lab.load(
        arm("revolute", JointAxis((0, 1, 0))), (5, 0, 9))
    lab.push(uneven, (1, 2, 3), (4, 5, 6))
    lab.steps(10)
    twist = lab.twist(uneven)
    lab.backend.step(10, 10)
    assert lab.backend.read_poses()
    poses = [lab.pose(uneven), lab.pose(hinged, "bob")]
    assert lab.twist(uneven) == twist   # as it was
    assert lab.backend.read()
    assert [lab.pose(uneven), lab.pose(hinged, "bob")] == poses
    assert lab.twist(uneven) != twist


def test_a_body_at_rest_that_was_hit_is_seen_by_who_only_looks(lab):
    lab.load(ground())
    sleeper, hitter = lab.load(box("sleeper"), (0, 0, 0.5)), lab.load(ball("hitter"), (-4, 0, 0.5))
    lab.seconds(4.0)
    before = lab.pose(sleeper).position[0]
    lab.push(hitter, (6, 0, 0))
    for n in range(100):
        lab.backend.step(5000 + 10 * n, 10)
        lab.backend.read_poses()
    assert lab.pose(sleeper).position[0] > before + 0.1


def test_reading_poses_changes_nothing_for_the_next_whole_read_out(lab):
    def run(looking: bool) -> bytes:
        found = b""
        for n in range(40):
            lab.backend.step(20 * n, 20)
            if looking:
                lab.backend.read_poses()
            lab.backend.read()
            found += _rows(lab)
        return found

    numbers = [lab.load(ground()), lab.load(box("a"), (0, 0, 0.6)), lab.load(_uneven(), (4, 0, 3)),
               lab.load(ball(), (0.1, 0, 3))]
    starts = tuple((number, Pose((0, 0, 0.6 * n))) for n, number in enumerate(numbers))
    lab.apply(Restart(starts))
    expected = run(False)
    lab.apply(Restart(starts))
    assert run(True) == expected


def test_poses_are_read_only_when_something_may_have_moved(lab):
    lab.load(box(), (0, 0, 5))
    lab.backend.step(0, 1)
    assert lab.backend.read_poses() and lab.backend.read()
    assert not lab.backend.read_poses()


def test_a_motor_moves_nothing_before_the_next_step(lab):
    model = lab.load(arm("revolute", JointAxis((0, 0, 1))))
    lab.steps(1)
    lab.apply(SetMotors((JointMotor(lab.joint_rows[model, "hinge"], 2.0, 100.0),)))
    assert not lab.backend.read()
    lab.backend.step(lab.step, 1)
    assert lab.backend.read()


def test_a_pose_that_is_no_number_is_put_back_also_when_only_poses_are_read(lab):
    number = lab.load(box(), (0, 0, 5))
    lab.steps(1)
    pybullet.resetBasePositionAndOrientation(pybullet.getBodyUniqueId(0), (math.nan, 0, 5),
                                             (0, 0, 0, 1))
    lab.backend.step(1, 1)
    lab.backend.read_poses()
    assert lab.pose(number).position == pybullet.getBasePositionAndOrientation(0)[0]
    assert lab.pose(number).position[2] > 4.9
    assert [event.kind for event in lab.backend.events()] == ["diverged"]


def test_rows_for_records_are_those_of_a_whole_read_out_to_the_bit(lab):
    uneven = lab.load(_uneven(), (0, 0, 9))
    lab.load(arm("revolute", JointAxis((0, 1, 0))), (5, 0, 9))
    lab.push(uneven, (1, 2, 3), (4, 5, 6))
    lab.steps(10)
    lab.backend.step(10, 10)
    links, axes = lab.backend.tables()
    rows = tuple(range(len(links) // (8 * LINK_WIDTH)))
    recorded = lab.backend.read_rows(rows), lab.backend.read_axes((0,))
    before = bytes(links)
    assert lab.backend.read()   # the rows were read, and their change is still reported
    links, axes = lab.backend.tables()
    assert recorded == (bytes(links), axes.cast("d").tolist()[:2]) and bytes(links) != before


def test_rows_for_records_show_the_hit_of_a_body_at_rest_in_its_step(lab):
    lab.load(ground(1.0))
    struck = lab.load(box("struck", 0.2), (1.0, 0, 0.1))
    lab.seconds(3.0)
    striker = lab.load(ball("striker", 0.1, 5.0), (0.7, 0, 0.1))
    lab.push(striker, (2, 0, 0))
    lab.steps(1)
    before = lab.pose(struck)
    row = lab.rows[struck, "link"]
    for _ in range(200):
        lab.backend.step(lab.step, 1)
        lab.step += 1
        place = pybullet.getBasePositionAndOrientation(lab.backend._rows[row][0].uid)[0]
        assert pose_and_twist(array("d", lab.backend.read_rows((row,))))[0].position == place
    assert place[0] > before.position[0] + 0.01


def test_what_a_record_of_the_world_has_read_is_still_a_change_for_snapshots(lab):
    lab.load(_uneven(), (0, 0, 9))
    lab.steps(1)
    lab.backend.step(1, 1)
    recorded = bytes(lab.backend.read_world())
    assert lab.backend.read_poses() and lab.backend.read()
    assert bytes(lab.backend.tables()[0]) == recorded
    assert not lab.backend.read()


def test_a_body_that_came_to_rest_beside_a_slow_one_is_read_once_that_pushes_it(lab):
    lab.load(ground(0.0))
    for n in range(100):   # the turns of resting bodies that are read in any case come late
        lab.load(box(f"other{n}", 0.1), (5.0 + 0.3 * (n % 10), 0.3 * (n // 10), 0.05))
    lab.seconds(3.0)
    slow = box("slow", 0.2, 5.0)
    slow.allow_auto_disable = False
    pusher = lab.load(slow, (0, 0, 0.1))
    pushed = lab.load(box("pushed", 0.2), (0.248, 0, 0.1))
    lab.push(pusher, (0.04, 0, 0))
    row = lab.rows[pushed, "link"]
    uid = lab.backend._rows[row][0].uid
    lab.steps(1)   # it finds the neighbours of the slow one, of which none rests
    pybullet.resetBaseVelocity(uid, *STILL)
    mark_asleep(uid)
    lab.steps(1)
    lab.steps(1)
    assert lab.twist(pushed) == STILL
    while lab.pose(pusher).position[0] < 0.055:
        lab.steps(1)
        assert lab.pose(pushed).position == pybullet.getBasePositionAndOrientation(uid)[0]
    assert lab.pose(pushed).position[0] > 0.25
