"""Contact as files ask for it: directions of friction, soft contacts, filters, torsion."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import Lab, ball, box, ground, inertial_of_box, slab
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Sphere, Surface
from my_simulations.engine.commands import ReadContacts, SetModelState
from my_simulations.geometry import STILL, Pose, quat_from_rpy, rotate

G = 9.8


def _plate(name: str, surface: Surface, collision: Pose = Pose(), inertia: Pose = Pose()) -> Model:
    """A flat plate, 0.1 m high, that slides instead of tipping over."""
    return Model(name, links=[Link("link", inertial=Inertial(1, inertia, .1, 0, 0, .12, 0, .2),
                                   collisions=[Collision("c", Box((1, 1, 0.1)), collision,
                                                         surface=surface)])])


def _jointed(model: Model) -> Model:
    link = model.links[0]
    half = replace(link.inertial, mass=.5, ixx=.05, iyy=.06, izz=.1)
    return replace(model, links=[replace(link, inertial=half), Link("rider", inertial=half)],
                   joints=[Joint("axle", "revolute", "link", "rider", axis=JointAxis())])


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
@pytest.mark.parametrize("mu, mu2", [(0.5, 0.2), (0.2, 0.5)])
def test_friction_has_two_coefficients_about_the_first_direction(lab: Lab, laws: Laws, mu: float,
                                                                 mu2: float, kind: str):
    # On slabs, along and across fdir1, which turns with the collision and with the body.
    surface = Surface(mu=mu, mu2=mu2, fdir1=(1, 0, 0))
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    bodies = []
    for n, (yaw, turned) in enumerate([(0.0, 0.0), (math.pi / 2, 0.0), (0.0, math.pi / 2)]):
        turn = Pose((0, 0, 0), quat_from_rpy(0, 0, turned))
        model = _plate(f"p{n}", surface, turn)
        made = lab.load(_jointed(model) if kind == "articulated" else model, (0, 4.0 * n, 0.05),
                        quat_from_rpy(0, 0, yaw))
        bodies.append((made, mu if n == 0 else mu2))
    lab.steps(300)
    starts = [lab.pose(body).position[0] for body, _ in bodies]
    for body, _ in bodies:
        lab.push(body, (1.5, 0, 0))
    lab.seconds(1.5)
    for (body, expected), start in zip(bodies, starts):
        laws.near(f"mu along fdir1, mu2 across it, {kind}: way to a stop, m",
                  lab.pose(body).position[0] - start, 1.5 ** 2 / (2 * expected * G), rel=0.03)


def _sled(front: float, back: float) -> Model:
    """Four round feet 0.3 m ahead of and behind a centre of mass 0.1 m high, and a rider."""
    feet = [Collision(f"foot{x}{y}", Sphere(0.02), Pose((0.3 * x, 0.2 * y, -0.08)),
                      surface=Surface(mu=front if x > 0 else back)) for x in (1, -1)
            for y in (1, -1)]
    return Model("sled", links=[
        Link("link", inertial=inertial_of_box(5.0, 0.6, 0.4, 0.1), collisions=feet),
        Link("rider", inertial=inertial_of_box(1.0, 0.1, 0.1, 0.1))], joints=[
            Joint("axle", "revolute", "link", "rider", axis=JointAxis())])


@pytest.mark.parametrize("self_collide", [False, True])
@pytest.mark.parametrize("jointed", [True, False])
@pytest.mark.parametrize("front, back", [(0.0, 0.8), (0.8, 0.0), (0.2, 0.6), (0.6, 0.2)])
def test_each_collision_of_a_link_has_its_own_friction(lab: Lab, laws: Laws, front: float,
                                                       back: float, jointed: bool,
                                                       self_collide: bool):
    lab.load(ground(1.0))
    model = _sled(front, back)
    model.self_collide = self_collide
    if not jointed:
        model.joints, model.links[1:] = [], []
        model.links[0].inertial = inertial_of_box(6.0, 0.6, 0.4, 0.1)
    sled = lab.load(model, (0, 0, 0.1))
    lab.steps(300)
    start = lab.pose(sled).position[0]
    lab.push(sled, (1, 0, 0))
    lab.seconds(2)
    # Braking presses the front feet down: (N1 - N2) 0.3 = (front N1 + back N2) 0.1.
    rear = (0.3 - 0.1 * front) / (0.6 + 0.1 * (back - front))
    laws.near("feet of one link, each with its own mu: way to a stop, m",
              lab.pose(sled).position[0] - start,
              1.0 / (2 * G * (front * (1 - rear) + back * rear)), rel=0.02)
    contacts = lab.apply(ReadContacts())
    assert {max(each.row_a, each.row_b) for each in contacts} == {lab.rows[sled, "link"]}
    laws.near("the same: sum of normal forces, N", sum(each.force for each in contacts), 6 * G,
              rel=1e-3)


def _tiles(*surfaces: Surface, kinematic: bool = False) -> Model:
    """One link of tiles, 20 m wide, whose tops are level; their centres are 40 m apart in y."""
    tiles = [Collision(f"tile{n}", Box((20, 20, 1)), Pose((0, 40.0 * n, -0.5)), surface=surface)
             for n, surface in enumerate(surfaces)]
    return Model("tiles", static=not kinematic,
                 links=[Link("link", collisions=tiles, kinematic=kinematic)])


@pytest.mark.parametrize("kinematic", [False, True])
def test_each_collision_of_a_static_link_has_its_own_friction(lab: Lab, laws: Laws,
                                                              kinematic: bool):
    across = Surface(mu=0.6, mu2=0.2, fdir1=(0, 1, 0))
    model = _tiles(Surface(mu=0.2), Surface(mu=0.6), across, Surface(mu=0.6),
                   kinematic=kinematic)
    tiles = lab.load(model, (1, 2, 3))
    lab.apply(SetModelState(tiles, Pose(), STILL))    # all tiles follow their link
    plates = [lab.load(_plate(f"plate{n}", Surface()), (0, 40.0 * n, 0.05)) for n in range(4)]
    lab.steps(100)
    for plate in plates:
        lab.push(plate, (2, 0, 0))
    starts = [lab.pose(plate).position[0] for plate in plates]
    lab.seconds(1.5)
    for plate, start, mu in zip(plates, starts, (0.2, 0.6, 0.2, 0.6)):
        laws.near("tiles of one static link, each with its own mu: way to a stop, m",
                  lab.pose(plate).position[0] - start, 2.0 ** 2 / (2 * mu * G), rel=0.02)
    for contact in lab.apply(ReadContacts()):
        assert lab.rows[tiles, "link"] in (contact.row_a, contact.row_b)


def test_each_collision_of_a_static_link_has_its_own_restitution(lab: Lab, laws: Laws):
    def surface(restitution: float) -> Surface:
        return Surface(restitution=restitution, bounce_threshold=0.0)
    lab.load(_tiles(surface(0.9), surface(0.4)))
    balls = [lab.load(ball(f"ball{n}", 0.1, surface=surface(1.0)), (0, 40.0 * n, 1.1))
             for n in range(2)]
    lab.steps(round(math.sqrt(2 / G) * 1000) + 10)
    tops = [0.0, 0.0]
    for _ in range(1000):
        lab.steps(1)
        for n, body in enumerate(balls):
            if lab.twist(body).linear[2] > 0.0:
                tops[n] = max(tops[n], lab.pose(body).position[2] - 0.1)
    for top, restitution in zip(tops, (0.9, 0.4)):
        laws.near("tiles of one static link, each with its own restitution: height of a bounce, m",
                  top, restitution ** 2, rel=0.02)


@pytest.mark.parametrize("jointed", [False, True])
@pytest.mark.parametrize("directed_touches", [False, True])
def test_the_surface_that_touches_tells_coefficient_and_directions(lab: Lab, laws: Laws,
                                                                   directed_touches: bool,
                                                                   jointed: bool):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    surfaces = [Surface(mu=1.0, mu2=0.2, fdir1=(1, 0, 0)), Surface(mu=0.8)]
    if directed_touches:
        surfaces.reverse()
    plate = Model("plate", links=[Link("link", inertial=inertial_of_box(2.0, 0.4, 0.4, 0.1),
                                       collisions=[
        Collision(f"c{n}", Box((0.4, 0.4, 0.1)), Pose((0, 0, height)), surface=surface)
        for n, (height, surface) in enumerate(zip((0.1, 0.0), surfaces))])])
    for yaw, mu in ((0.0, 1.0), (math.pi / 2, 0.2)):
        moving = lab.load(plate, (0, 0, 0.05), quat_from_rpy(0, 0, yaw), articulated=jointed)
        lab.steps(100)
        lab.push(moving, (1.5, 0, 0))
        start = lab.pose(moving).position[0]
        lab.seconds(1.0)
        laws.near("directions of the collision that touches: way to a stop, m",
                  lab.pose(moving).position[0] - start,
                  1.5 ** 2 / (2 * (mu if directed_touches else 0.8) * G), rel=0.04)
        lab.remove(moving)


@pytest.mark.parametrize("soft_first", [False, True])
@pytest.mark.parametrize("soft_touches", [False, True])
def test_the_surface_that_touches_tells_how_soft_it_is(lab: Lab, laws: Laws, soft_touches: bool,
                                                       soft_first: bool):
    lab.load(ground())
    found = [(Surface(mu=0.9, kp=1e3), 0.0 if soft_touches else 0.2),
             (Surface(mu=0.8), 0.2 if soft_touches else 0.0)]
    link = Link("link", inertial=inertial_of_box(1, 1, 1, 1), collisions=[
        Collision(f"c{n}", Box((1, 1, 1)), Pose((0, 0, height)), surface=surface)
        for n, (surface, height) in enumerate(found if soft_first else found[::-1])])
    block = lab.load(Model("block", links=[link]), (0, 0, 0.5))
    lab.seconds(5)
    # A spring at each of four points.
    laws.near("softness of the collision that touches: how deep it rests, m",
              0.5 - lab.pose(block).position[2], G / 4e3 if soft_touches else 0.0, abs=1e-4)


def test_a_slippery_direction_lets_the_other_one_hold(lab: Lab, laws: Laws):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    along = lab.load(_plate("along", Surface(mu=0.0, mu2=1.0, fdir1=(1, 0, 0))), (0, 0, 0.05))
    across = lab.load(_plate("across", Surface(mu=0.0, mu2=1.0, fdir1=(0, 1, 0))), (0, 4, 0.05))
    lab.seconds(0.5)
    lab.configure(gravity=(2.0, 0.0, -G))
    starts = [lab.pose(body).position[0] for body in (along, across)]
    lab.seconds(1)
    laws.near("mu 0 along fdir1: way in 1 s, m", lab.pose(along).position[0] - starts[0], 1.0,
              rel=0.03)
    laws.at_most("mu2 1 across fdir1 with mu 0: way in 1 s, m",
                 abs(lab.pose(across).position[0] - starts[1]), 1e-4)


def test_without_a_first_direction_mu_holds_in_all(lab: Lab, laws: Laws):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    bodies = [lab.load(_plate(f"p{n}", Surface(mu=0.5, mu2=0.1)), (4.0 * n, 0, 0.05))
              for n in range(2)]
    lab.steps(300)
    starts = [lab.pose(body).position for body in bodies]
    lab.push(bodies[0], (1.5, 0, 0))
    lab.push(bodies[1], (0, 1.5, 0))
    lab.seconds(1.0)
    for body, start in zip(bodies, starts):
        laws.near("mu2 without fdir1: way to a stop, m",
                  math.dist(lab.pose(body).position, start), 1.5 ** 2 / (2 * 0.5 * G), rel=0.03)


@pytest.mark.parametrize("kp", [1e3, 1e4])
@pytest.mark.parametrize("kind", ["rigid", "articulated"])
def test_a_soft_contact_gives_way_by_force_over_kp(lab: Lab, laws: Laws, kp: float, kind: str):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    model = ball(radius=0.5, surface=Surface(kp=kp, kd=10.0))
    if kind == "articulated":
        model = _jointed(model)
    body = lab.load(model, (0, 0, 0.5))
    lab.seconds(4)
    laws.near(f"kp of a contact: depth of 1 kg, {kind}, m", 0.5 - lab.pose(body).position[2],
              G / kp, rel=0.03, )


def test_two_soft_surfaces_give_way_as_springs_in_a_row(lab: Lab, laws: Laws):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    lower = lab.load(ball("lower", surface=Surface(kp=1e4, kd=10.0)), (0, 0, 0.5))
    lab.load(_guided(1e4), (0, 0, 1.5))
    lab.seconds(4)
    low = lab.pose(lower).position[2]
    laws.near("kp on the floor: depth of 2 kg, m", 0.5 - low, 2 * G / 1e4, rel=0.03)
    laws.near("kp of two surfaces: depth of 1 kg, m",
              low + 1.0 - lab.pose(lab._id, "bob").position[2], G / 5e3, rel=0.03)


def _guided(kp: float) -> Model:
    """A ball of 1 kg on a vertical rail."""
    model = ball("upper", surface=Surface(kp=kp, kd=10.0))
    return replace(model, links=[replace(model.links[0], name="bob")],
                   joints=[Joint("rail", "prismatic", "world", "bob", axis=JointAxis((0, 0, 1)))])


def test_a_spring_of_a_contact_with_a_large_max_vel_swings(lab: Lab, laws: Laws):
    # Half a period of a mass on a spring that only pushes: it comes up again after 2 pi sqrt(m/k).
    lab.configure(gravity=(0.0, 0.0, 0.0))
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    body = lab.load(ball(radius=0.5, surface=Surface(kp=1e3, kd=0.0, max_vel=100.0)),
                    (0, 0, 0.505))
    lab.push(body, (0, 0, -0.5))
    inside = 0
    for _ in range(400):
        lab.steps(1)
        inside += lab.pose(body).position[2] < 0.5
    laws.near("a springy contact: time inside, s", 1e-3 * inside, math.pi * math.sqrt(1 / 1e3),
              rel=0.1)


def test_an_overlap_of_a_soft_contact_does_not_throw(lab: Lab, laws: Laws):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    body = lab.load(ball(radius=0.5, surface=Surface(kp=1e5, kd=1.0)), (0, 0, 0.45))
    highest = 0.0
    for _ in range(300):
        lab.steps(10)
        highest = max(highest, lab.pose(body).position[2])
    laws.at_most("kp 1e5, 5 cm in the floor: how far it leaves it, m", highest - 0.5, 1e-3)


@pytest.mark.parametrize("max_vel", [0.01, 0.1, 0.3])
def test_a_soft_contact_parts_at_most_at_max_vel(lab: Lab, laws: Laws, max_vel: float):
    # 5e5 N/m and 10 N s/m are the wheels of many robots; as a spring alone 1 kg would jump 0.3 m.
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    body = lab.load(_jointed(ball(radius=0.1, surface=Surface(kp=5e5, kd=10.0, max_vel=max_vel))),
                    (0, 0, 0.6))
    lab.steps(300)
    fastest = -1.0
    for _ in range(500):
        lab.steps(1)
        fastest = max(fastest, lab.twist(body).linear[2])
    laws.at_most(f"max_vel {max_vel}: speed after a fall of 0.5 m, m/s", fastest, max_vel)


@pytest.mark.parametrize("one, other, meet", [
    (0x01, 0x01, True), (0x01, 0x02, False), (0x03, 0x02, True), (0x00, 65535, False),
    (65535, 65535, True)])
@pytest.mark.parametrize("static_first", [True, False])
def test_surfaces_meet_when_their_masks_have_a_bit_in_common(lab: Lab, one: int, other: int,
                                                             meet: bool, static_first: bool):
    floor = slab("floor", (6, 6, 1))
    floor.links[0].collisions[0].surface = Surface(collide_bitmask=one)
    falling = box(surface=Surface(collide_bitmask=other))
    if static_first:
        lab.load(floor, (0, 0, -0.5))
    body = lab.load(falling, (0, 0, 0.5))
    if not static_first:
        lab.load(floor, (0, 0, -0.5))
    lab.seconds(0.5)
    assert (lab.pose(body).position[2] > 0.4) == meet


def test_a_surface_without_contact_takes_no_forces(lab: Lab):
    lab.load(ground())
    body = lab.load(box(surface=Surface(collide_without_contact=True)), (0, 0, 0.5))
    lab.seconds(0.5)
    assert lab.pose(body).position[2] < 0.0


def test_torsional_friction_stops_a_spinning_ball(lab: Lab, laws: Laws):
    # Torque 3 pi / 16 a c N; moment 0.4 m r^2.
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    body = lab.load(ball(radius=0.2, surface=Surface(torsion=0.8, patch_radius=0.02)), (0, 0, 0.2))
    lab.steps(300)
    lab.push(body, angular=(0, 0, 5.0))
    lab.seconds(0.5)
    slowing = 3 * math.pi / 16 * 0.02 * 0.8 * G / (0.4 * 0.2 ** 2)
    laws.near("torsional friction: rate after 0.5 s, rad/s", lab.twist(body).angular[2],
              5.0 - slowing * 0.5, rel=0.03)


@pytest.mark.parametrize("shape", [Box((0.2, 0.2, 0.2)), Sphere(0.1)])
def test_bodies_that_are_apart_have_no_contact(lab: Lab, shape):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    lab.load(slab("wall", (0.2, 2, 1)))
    body = lab.load(Model("box", links=[Link("link", inertial=Inertial(1, Pose(), .01, 0, 0, .01, 0,
                                                                       .01),
                                             collisions=[Collision("c", shape)])]), (0.1999, 0, 0))
    lab.steps(10)
    assert lab.apply(ReadContacts())
    lab.push(body, (0.1, 0, 0))
    lab.steps(25)   # 2.4 mm: Bullet still keeps the points
    assert lab.apply(ReadContacts()) == ()


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
def test_contacts_carry_the_weight_and_what_holds_a_body_on_a_slope(lab: Lab, laws: Laws,
                                                                    kind: str):
    tilt = quat_from_rpy(0.0, math.radians(15), 0.0)
    floor = lab.load(slab("floor", (6, 6, 1)), orientation=tilt)
    model = _plate("p", Surface())
    x, _, z = rotate(tilt, (0.0, 0.0, 0.55))
    body = lab.load(_jointed(model) if kind == "articulated" else model, (x, 0, z), tilt)
    lab.seconds(1)
    total = [0.0, 0.0, 0.0]
    for contact in lab.apply(ReadContacts()):
        assert {contact.row_a, contact.row_b} == {lab.rows[body, "link"], lab.rows[floor, "link"]}
        sign = 1.0 if contact.row_a == lab.rows[body, "link"] else -1.0
        assert abs(contact.depth) < 1e-3
        for n in range(3):
            total[n] += sign * (contact.normal[n] * contact.force + contact.friction[n])
    for name, found, expected in zip("xyz", total, (0.0, 0.0, G)):
        laws.near(f"sum of the contact forces on a plate of 1 kg, {name}, N", found, expected,
                  abs=0.05)
