"""Friction, bounces, resting and sleeping."""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import Lab, ball, box, ground, slab
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    MeshData,
    Sphere,
    Surface,
    mesh_key,
)
from my_simulations.engine.commands import FOREVER, SetJoints, SetModelState
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, Twist, quat_from_rpy

G = 9.8


def _flat(mu: float, name: str = "flat", mass: float = 1.0) -> Model:
    """Flat, so that it slides instead of tipping over."""
    return Model(name, links=[Link(
        "link", inertial=Inertial(mass, Pose(), .1 * mass, 0, 0, .1 * mass, 0, .2 * mass),
        collisions=[Collision("c", Box((1, 1, 0.1)), surface=Surface(mu=mu))])])


def _floor(mu: float) -> Model:
    floor = slab("floor", (30, 1.8, 0.2))
    floor.links[0].collisions[0].surface = Surface(mu=mu)
    return floor


def _jointed(model: Model) -> Model:
    """The same as an articulated body: half of the mass is a link that turns on the other half."""
    link = model.links[0]
    half = replace(link.inertial, **{name: getattr(link.inertial, name) / 2
                                     for name in ("mass", "ixx", "iyy", "izz")})
    return replace(model, links=[replace(link, inertial=half), Link("rider", inertial=half)],
                   joints=[Joint("axle", "revolute", "link", "rider", axis=JointAxis())])


def _plate(mu: float, name: str) -> Model:
    """Heavy and long, so that it stays where it is when something slides on it."""
    return Model(name, links=[Link(
        "link", inertial=Inertial(1000, Pose(), 1e3, 0, 0, 1e4, 0, 1e4),
        collisions=[Collision("c", Box((20, 1.8, 0.2)), surface=Surface(mu=mu))])])


def _as_built(model: Model, kind: str) -> Model:
    return _jointed(model) if kind == "articulated" else model


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
def test_pairs_have_the_smaller_friction_all_in_one_world(lab: Lab, laws: Laws, kind: str):
    pairs = [(ground_mu, mu) for ground_mu in (100.0, 1.0, 0.5) for mu in (0.3, 0.5, 1.0, 1.5)]
    sliding, plates = [], []
    for n, (ground_mu, mu) in enumerate(pairs):
        lab.load(_floor(ground_mu), (0, 2.0 * n, -0.1))
        body = lab.load(_as_built(_flat(mu, f"b{n}"), kind), (0, 2.0 * n, 0.05))
        sliding.append((body, min(mu, ground_mu), "on the ground"))
    for n, (below, above) in enumerate([(0.5, 0.5), (0.3, 0.5), (0.5, 0.3), (1.0, 1.5)]):
        y = -2.0 * (n + 1)
        lab.load(_floor(100.0), (0, y, -0.1))
        plates.append(lab.load(_plate(below, f"plate{n}"), (0, y, 0.1)))
        body = lab.load(_as_built(_flat(above, f"on{n}"), kind), (-2, y, 0.25))
        sliding.append((body, min(below, above), "on a body"))
    lab.steps(300)
    starts = [lab.pose(body).position[0] for body, _, _ in sliding]
    for body, _, _ in sliding:
        lab.push(body, (2, 0, 0))
    lab.seconds(1.5)
    for (body, mu, where), start in zip(sliding, starts):
        laws.near(f"friction of {kind} bodies {where}: way to a stop, m",
                  lab.pose(body).position[0] - start,
                  4 / (2 * mu * G) - lab.settings.step_size, rel=0.03)   # half a step less
    for plate in plates:
        assert abs(lab.pose(plate).position[0]) < 0.01


def _foot(mu: float) -> Model:
    """A foot joined to the world: it slides along x, and down onto what is below."""
    foot = _flat(mu).links[0]
    carriage = Link("carriage", inertial=replace(foot.inertial, mass=0.01))
    return Model("foot", links=[carriage, foot], joints=[
        Joint("rail", "prismatic", "world", "carriage", axis=JointAxis((1, 0, 0))),
        Joint("drop", "prismatic", "carriage", "link", axis=JointAxis((0, 0, 1)))])


def test_a_foot_of_a_body_joined_to_the_world_has_the_smaller_friction(lab: Lab, laws: Laws):
    lab.load(_floor(0.3), (0, 0, -0.1))
    foot = lab.load(_foot(0.5), (0, 0, 0.05))
    lab.steps(300)
    start = lab.pose(foot).position[0]
    lab.apply(SetJoints(((lab.joint_rows[foot, "rail"], start, 2.0),)))
    lab.seconds(1.5)
    laws.near("friction of articulated bodies on the ground: way to a stop, m",
              lab.pose(foot).position[0] - start, 4 * 1.01 / (2 * 0.3 * G), rel=0.03)


def test_boxes_side_by_side_keep_the_friction_of_what_carries_them(lab: Lab, laws: Laws):
    # A ring of contacts: the ground and two boxes that touch; what carries counts.
    lab.load(ground(100.0))
    left = lab.load(_flat(0.5, "left"), (0, 0, 0.05))
    right = lab.load(_flat(0.5, "right"), (1.0, 0, 0.05))
    lab.steps(300)
    start = lab.pose(left).position[0]
    for model in (left, right):
        lab.push(model, (2, 0, 0))
    lab.seconds(1.5)
    laws.near("friction of boxes side by side: way to a stop, m",
              lab.pose(left).position[0] - start, 4 / (2 * 0.5 * G), rel=0.03)
    assert lab.backend.events() == []


def test_friction_that_fits_no_ring_of_contacts_is_told_once(lab: Lab):
    # A plank with one end on a block and a foot at the other: all three pairs carry.
    lab.load(ground(100.0))
    lab.load(_flat(0.5, "block", mass=5.0), (0.8, 0, 0.05))
    slippery = Surface(mu=0.5)
    lab.load(Model("plank", links=[Link(
        "link", inertial=Inertial(5, Pose(), 1, 0, 0, 1, 0, 1), collisions=[
            Collision("long", Box((2.2, 1, 0.1)), surface=slippery),
            Collision("foot", Box((0.2, 1, 0.1)), Pose((-1.0, 0, -0.1)), surface=slippery)])]),
        (0, 0, 0.15))
    lab.seconds(2)
    (told,) = lab.backend.events()
    assert told.kind == "log" and "touches others in a ring" in told.message


def test_a_tower_of_slippery_boxes_still_stands(lab: Lab):
    lab.load(ground())
    tower = [lab.load(box(f"b{n}", surface=Surface(mu=0.4)), (0, 0, 0.5 + n)) for n in range(6)]
    lab.seconds(5)
    for n, model in enumerate(tower):
        assert lab.pose(model).position == pytest.approx((0, 0, 0.5 + n), abs=0.02)


@pytest.mark.parametrize("mu", [0.3, 0.5, 1.0])
def test_a_box_slides_beyond_the_angle_of_friction(lab: Lab, laws: Laws, mu: float):
    critical = math.atan(mu)
    slides = []
    for n in range(17):   # slopes a quarter of a degree apart
        angle = critical + math.radians(0.25 * (n - 8))
        tilt = quat_from_rpy(0.0, angle, 0.0)
        slope = slab(f"slope{n}", (20, 1.5, 0.2))
        slope.links[0].collisions[0].surface = Surface(mu=100.0)
        lab.load(slope, (0, 2.0 * n, 0), tilt)
        at = (0.15 * math.sin(angle), 2.0 * n, 0.15 * math.cos(angle))
        slides.append((angle, at, lab.load(_flat(mu, f"b{n}"), at, tilt)))
    lab.seconds(3)
    moving = [math.dist(lab.pose(body).position, at) > 0.01 for _, at, body in slides]
    first = moving.index(True)
    assert 0 < first and all(moving[first:])
    # At half a degree too much it has gone 0.4 m after 3 s.
    laws.near("slopes: the angle at which a box starts to slide, degrees",
              math.degrees(slides[first][0]) - 0.125, math.degrees(critical), abs=0.5)


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
@pytest.mark.parametrize("height", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("e", [1.0, 0.8, 0.5])
def test_a_bounce_rises_to_e_squared_of_the_height_from_any_height(lab: Lab, laws: Laws, e: float,
                                                                   height: float, kind: str):
    lab.load(ground(surface=Surface(restitution=1.0, bounce_threshold=0.0)))
    drops = [height + 0.001 * n for n in range(10)]
    dropped = [lab.load(_as_built(ball(f"b{n}", surface=Surface(restitution=e,
                                                                bounce_threshold=0.0)), kind),
                        (3.0 * n, 0, 0.5 + drop)) for n, drop in enumerate(drops)]
    heights = []
    fall = math.sqrt(2 * height / G)
    for _ in range(round(1000 * fall * (1 + 1.2 * e))):   # beyond the top of the first bounce
        lab.steps(1)
        heights.append([lab.pose(model).position[2] - 0.5 for model in dropped])
    for drop, track in zip(drops, np.array(heights).T):
        bottom = int(np.argmin(track[:round(1050 * fall)]))
        laws.near(f"bounces of {kind} bodies from ten heights: top, m", max(track[bottom:]),
                  e * e * drop, rel=0.03)


def _bouncing(e: float, threshold: float) -> Surface:
    return Surface(restitution=e, bounce_threshold=threshold)


def _rebound(lab: Lab, number: int, rest: float) -> float:
    """The ratio of the speeds after and before the first impact from 1 m, by the heights."""
    heights = []
    for _ in range(900):
        lab.steps(1)
        heights.append(lab.pose(number).position[2] - rest)
    bottom = int(np.argmin(heights[:500]))
    return math.sqrt(max(0.0, *heights[bottom:]))


DEFAULT = 1e5  # m/s, SDF's threshold
PAIRS = [((0.5, 0.0), (0.5, 0.0), 0.5), ((0.8, 1.0), (0.8, 1.0), 0.8),
         ((0.9, 0.0), (0.6, 0.0), 0.6), ((0.5, 0.0), (1.0, DEFAULT), 0.5),
         ((0.5, DEFAULT), (0.7, 0.0), 0.5), ((0.8, 6.0), (1.0, 6.0), 0.0),
         ((0.8, DEFAULT), (0.8, DEFAULT), 0.0), ((0.8, 0.0), (0.0, DEFAULT), 0.0)]


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
@pytest.mark.parametrize("one,other,expected", PAIRS)
def test_a_pair_bounces_by_the_smaller_restitution_and_threshold(lab: Lab, laws: Laws, one, other,
                                                                 expected, kind: str):
    lab.load(ground(surface=_bouncing(*other)))
    number = lab.load(_as_built(ball(surface=_bouncing(*one)), kind), (0, 0, 1.5))
    laws.near("pairs of bouncing surfaces: rebound by impact", _rebound(lab, number, 0.5), expected,
              abs=0.03)


def test_two_moving_bodies_that_are_alike_bounce_by_their_own_restitution(lab: Lab):
    lab.load(ground(surface=_bouncing(1.0, 0.0)))
    lab.configure(gravity=(0.0, 0.0, 0.0))
    left, right = (lab.load(ball(name, surface=_bouncing(0.6, 0.0)), (x, 0, 3.0))
                   for name, x in (("left", -1.0), ("right", 1.0)))
    lab.push(left, (2.0, 0, 0))
    lab.seconds(1.0)
    speeds = [lab.twist(one).linear[0] for one in (left, right)]
    assert speeds[1] - speeds[0] == pytest.approx(0.6 * 2.0, rel=0.02)
    assert not lab.backend.events()


def test_surfaces_that_come_and_go_leave_the_pairs_that_stay_right(lab: Lab):
    lab.load(ground(surface=_bouncing(0.8, 0.0)))
    guest = lab.load(ball("guest", surface=_bouncing(0.4, 0.0)), (5.0, 0, 1.5))
    lab.steps(10)
    lab.remove(guest)
    number = lab.load(ball(surface=_bouncing(0.9, 0.0)), (0, 0, 1.5))
    assert _rebound(lab, number, 0.5) == pytest.approx(0.8, abs=0.03)


def test_unlike_moving_bodies_bounce_right_off_the_ground_and_the_rest_is_told(lab: Lab):
    lab.load(ground(surface=_bouncing(1.0, 0.0)))
    numbers = {e: lab.load(ball(f"b{e}", surface=_bouncing(e, 0.0)), (5.0 * e * 10, 0, 1.5))
               for e in (0.5, 0.7, 0.9)}
    assert _rebound(lab, numbers[0.5], 0.5) == pytest.approx(0.5, abs=0.03)
    (event,) = lab.backend.events()
    assert "restitution" in event.message


def test_surfaces_do_not_bounce_by_default(lab: Lab):
    lab.load(ground())
    dropped = lab.load(ball(surface=Surface(restitution=1.0)), (0, 0, 1.5))
    lab.seconds(2)
    assert lab.pose(dropped).position[2] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
def test_a_body_spawned_in_the_ground_settles_without_leaving_it(lab: Lab, laws: Laws, kind: str):
    lab.load(ground())
    deep = lab.load(_as_built(box(), kind), (0, 0, 0.3))
    for _ in range(300):
        lab.steps(10)
        laws.at_most("0.2 m in the ground: how far it leaves it, m",
                     lab.pose(deep).position[2] - 0.5, 1e-3)
    laws.near("0.2 m in the ground: height after 3 s, m", lab.pose(deep).position[2], 0.5,
              abs=1e-3)


@pytest.mark.parametrize("asleep", [True, False])
def test_ten_boxes_on_each_other_stand(lab: Lab, laws: Laws, asleep: bool):
    lab.load(ground())
    tower = [lab.load(replace(box(f"b{n}"), allow_auto_disable=asleep), (0, 0, 0.5 + n))
             for n in range(10)]
    lab.seconds(30)
    for n, model in enumerate(tower):
        laws.near("ten boxes on each other for 30 s: off their place, m",
                  lab.pose(model).position, (0, 0, 0.5 + n), abs=0.02)


def test_a_table_on_four_legs_does_not_creep(lab: Lab, laws: Laws):
    legs = [Collision(f"leg{n}", Box((0.05, 0.05, 0.7)), Pose((0.5 * x, 0.3 * y, 0.35)))
            for n, (x, y) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)])]
    top = Collision("top", Box((1.2, 0.8, 0.05)), Pose((0, 0, 0.725)))
    inertial = Inertial(20, Pose((0, 0, 0.6)), 1.5, 0, 0, 2.5, 0, 3)
    lab.load(ground())
    table = lab.load(Model("table", allow_auto_disable=False, links=[
        Link("link", inertial=inertial, collisions=[*legs, top])]))
    lab.seconds(1)
    start = lab.pose(table).position
    lab.seconds(30)
    laws.at_most("table on four legs: creep in 30 s, m",
                 math.dist(start, lab.pose(table).position), 1e-3)


def _asleep(lab: Lab, model: int) -> bool:
    before = lab.pose(model)
    lab.steps(50)
    return lab.twist(model) == Twist() and lab.pose(model) == before


def _sleeper(lab: Lab) -> int:
    lab.load(ground())
    model = lab.load(box(), (0, 0, 0.5))
    lab.seconds(4)
    assert _asleep(lab, model)
    return model


def test_a_slow_body_is_not_frozen(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    coasting = lab.load(box())
    lab.push(coasting, (0.15, 0, 0))
    lab.seconds(5)
    assert lab.pose(coasting).position[0] == pytest.approx(0.75, abs=1e-6)


def test_a_sleeper_takes_a_commanded_velocity(lab: Lab):
    sleeper = _sleeper(lab)
    lab.push(sleeper, (0, 0, 3))
    lab.steps(100)
    assert lab.pose(sleeper).position[2] > 0.7


def test_a_sleeper_falls_when_its_support_is_deleted(lab: Lab):
    table = lab.load(slab("table", (2, 2, 0.5)), (0, 0, 2))
    lower = lab.load(box("lower"), (0, 0, 2.75))
    upper = lab.load(box("upper"), (0, 0, 3.75))
    lab.seconds(5)
    assert _asleep(lab, lower) and _asleep(lab, upper)
    lab.remove(table)
    lab.seconds(0.5)
    assert lab.pose(lower).position[2] < 1.7
    assert lab.pose(upper).position[2] < 2.7


def test_a_sleeper_falls_when_its_support_is_moved_away(lab: Lab):
    table = lab.load(slab("table", (2, 2, 0.5)), (0, 0, 2))
    sleeper = lab.load(box(), (0, 0, 2.75))
    lab.seconds(5)
    assert _asleep(lab, sleeper)
    lab.apply(SetModelState(table, Pose((10, 0, 2)), Twist()))
    lab.seconds(0.5)
    assert lab.pose(sleeper).position[2] < 2.0


@pytest.mark.parametrize("rate", [-0.5, 0.5])
def test_boxes_on_a_lift_that_stood_follow_it(lab: Lab, rate: float):
    tray = slab("tray", (2, 2, 0.2)).links[0]
    lift = Model("lift", links=[replace(tray, inertial=Inertial(50.0, Pose(), 5, 0, 0, 5, 0, 5))],
                 joints=[Joint("rail", "prismatic", "world", tray.name,
                               axis=JointAxis((0.0, 0.0, 1.0)))])
    row = lab.joint_rows[lab.load(lift, (0, 0, 5)), "rail"]
    lab.apply(SetMotors((JointMotor(row, 0.0, 1e4),)))
    boxes = [lab.load(box(f"b{n}"), (0, 0, 5.6 + n)) for n in range(2)]
    lab.seconds(5)
    lab.apply(SetMotors((JointMotor(row, rate, 1e4),)))
    lab.seconds(2)
    for n, model in enumerate(boxes):
        assert lab.pose(model).position[2] == pytest.approx(5.6 + n + 2 * rate, abs=0.01)


def test_a_sleeper_moves_when_a_static_body_is_put_into_it(lab: Lab):
    sleeper = _sleeper(lab)
    block = lab.load(slab("block", (1, 1, 1)), (5, 0, 0.5))
    lab.apply(SetModelState(block, Pose((0.9, 0, 0.5)), Twist()))
    lab.seconds(1)
    assert lab.pose(sleeper).position[0] < -0.05


def test_a_sleeper_answers_a_wrench(lab: Lab):
    sleeper = _sleeper(lab)
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[sleeper, "link"], lab.step, FOREVER,
                             force=(0, 0, 20.0)),)))
    lab.steps(500)
    assert lab.pose(sleeper).position[2] > 0.9


def test_a_sleeper_hit_by_a_moving_body_is_read_at_once(lab: Lab):
    sleeper = _sleeper(lab)
    hitter = lab.load(ball(mass=5.0), (-3, 0, 0.5))
    lab.push(hitter, (6, 0, 0))
    for _ in range(700):
        lab.steps(1)
        linear = lab.twist(sleeper).linear
        if abs(linear[0]) > 1e-3:
            break
    import pybullet
    real = pybullet.getBaseVelocity(lab.backend._rows[lab.rows[sleeper, "link"]][0].uid)[0]
    assert real[0] != 0.0 and linear == pytest.approx(real)


def test_a_domino_chain_of_sleepers_is_read_as_it_falls(lab: Lab):
    import pybullet
    lab.load(ground())
    thin = Inertial(0.2, Pose(), 2e-3, 0, 0, 2e-3, 0, 5e-4)
    stones = [lab.load(Model(f"d{n}", links=[Link("link", inertial=thin, collisions=[
        Collision("c", Box((0.04, 0.2, 0.4)))])]), (0.15 * n, 0, 0.2)) for n in range(12)]
    lab.seconds(5)
    assert all(_asleep(lab, stone) for stone in stones)
    lab.push(stones[0], (0.0, 0, 0), (0, 3.0, 0))
    lab.seconds(3)
    for stone in stones:
        uid = lab.backend._rows[lab.rows[stone, "link"]][0].uid
        position, turn = pybullet.getBasePositionAndOrientation(uid)
        assert lab.pose(stone).position == pytest.approx(position, abs=1e-6)
        assert lab.pose(stone).orientation == pytest.approx(turn, abs=1e-6)
    assert lab.pose(stones[-1]).position[2] < 0.15


def _cube_mesh() -> MeshData:
    corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7],
             [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return MeshData(corners, np.array(faces, dtype=np.int32))


def test_a_moving_mesh_collides_as_its_hull(lab: Lab):
    mesh = Mesh("cube", "/cube")
    cube = Model("cube", links=[Link("link", inertial=Inertial(1, Pose(), 1/6, 0, 0, 1/6, 0, 1/6),
                                     collisions=[Collision("c", mesh)])])
    lab.load(ground())
    falling = lab.load(cube, (0, 0, 1), meshes={mesh_key(mesh): _cube_mesh()})
    lab.seconds(3)
    assert lab.pose(falling).position[2] == pytest.approx(0.5, abs=2e-3)


def test_a_static_mesh_collides_as_triangles(lab: Lab):
    # An open tray: a ball dropped inside stays at floor height, which a hull would not allow.
    tray = [Collision(f"c{n}", Box(size), Pose(at)) for n, (size, at) in enumerate([
        ((2, 2, 0.1), (0, 0, 0)), ((0.1, 2, 1), (1, 0, 0.5)), ((0.1, 2, 1), (-1, 0, 0.5)),
        ((2, 0.1, 1), (0, 1, 0.5)), ((2, 0.1, 1), (0, -1, 0.5))])]
    cube = _cube_mesh()
    vertices, triangles = [], []
    for piece in tray:
        triangles.append(cube.triangles + 8 * len(vertices))
        vertices.append(cube.vertices * piece.geometry.size + piece.pose.position)
    mesh = Mesh("tray", "/tray")
    data = MeshData(np.concatenate(vertices), np.concatenate(triangles))
    lab.load(Model("tray", static=True, links=[Link("link", collisions=[Collision("c", mesh)])]),
             meshes={mesh_key(mesh): data})
    dropped = lab.load(ball(radius=0.2), (0, 0, 2))
    lab.seconds(3)
    assert lab.pose(dropped).position[2] == pytest.approx(0.25, abs=5e-3)


@pytest.mark.parametrize("static", [True, False])
def test_a_link_may_have_more_collisions_than_a_bullet_compound(lab: Lab, static: bool):
    posts = [Collision(f"c{n}", Box((0.5, 0.5, 0.2)), Pose((n, 0, 0))) for n in range(40)]
    posts.append(Collision("round", Cylinder(0.25, 0.2), Pose((40, 0, 0))))
    row = Model("row", static=static, links=[Link(
        "link", inertial=Inertial(40, Pose((20, 0, 0)), 1, 0, 0, 6000, 0, 6000), collisions=posts)])
    lab.load(ground())
    model = lab.load(row, (0, 0, 0.1))
    probes = [lab.load(ball(f"p{n}", radius=0.1), (x, 0, 0.6)) for n, x in enumerate((0, 33, 40))]
    lab.seconds(1.5)
    for probe in probes:
        assert lab.pose(probe).position[2] == pytest.approx(0.3, abs=0.01)
    assert lab.pose(model).position[2] == pytest.approx(0.1, abs=5e-3)


def test_links_of_one_model_do_not_collide(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = Inertial(1, Pose(), 0.1, 0, 0, 0.1, 0, 0.1)
    pair = Model("pair", links=[
        Link("a", Pose(), inertial, [Collision("c", Sphere(0.5))]),
        Link("b", Pose((0.6, 0, 0)), inertial, [Collision("c", Sphere(0.5))])])
    model = lab.load(pair)
    lab.steps(500)
    assert lab.pose(model, "a").position == pytest.approx((0, 0, 0), abs=1e-9)
    assert lab.pose(model, "b").position == pytest.approx((0.6, 0, 0), abs=1e-9)


@pytest.mark.parametrize("geometry, height", [
    (Capsule(0.3, 1.0), 0.8), (Ellipsoid((0.6, 0.6, 0.2)), 0.2), (Cone(0.5, 1.0), 0.5)])
def test_newer_shapes_rest_at_their_height(lab: Lab, geometry, height: float):
    upright = Inertial(1, Pose(), 10, 0, 0, 10, 0, 10)   # it does not fall over in the time
    lab.load(ground())
    model = lab.load(Model("m", links=[Link("link", inertial=upright, collisions=[
        Collision("c", geometry)])]), (0, 0, height))
    lab.seconds(0.3)
    assert lab.pose(model).position[2] == pytest.approx(height, abs=0.01)


def test_a_moving_mesh_of_convex_parts_is_hollow_where_it_is_hollow(lab: Lab):
    # A U of three boxes: a ball falls between its arms, where the hull would hold it up.
    cube = _cube_mesh()
    boxes = [((2, 1, 0.2), (0, 0, 0)), ((0.2, 1, 1), (-0.9, 0, 0.5)), ((0.2, 1, 1), (0.9, 0, 0.5))]
    parts = [MeshData(cube.vertices * size + at, cube.triangles) for size, at in boxes]
    whole = MeshData(np.concatenate([part.vertices for part in parts]),
                     np.concatenate([cube.triangles + 8 * n for n in range(3)]), parts)
    mesh = Mesh("u", "/u")
    lab.load(ground())
    lab.load(Model("u", links=[Link("link", inertial=Inertial(50, Pose(), 9, 0, 0, 9, 0, 9),
                                    collisions=[Collision("c", mesh)])]), (0, 0, 0.1),
             meshes={mesh_key(mesh): whole})
    dropped = lab.load(ball(radius=0.3), (0, 0, 1.0))
    lab.seconds(1.5)
    assert lab.pose(dropped).position[2] == pytest.approx(0.5, abs=0.02)
