"""Roads and actors in pictures and under rays: where they are, what covers them, at each time."""
from __future__ import annotations

import math

import numpy as np
import pytest
from sensing_scene import body, table
from walking_figures import rod, swinging

from my_simulations.appearance.looks import Look
from my_simulations.appearance.palette import PATTERNS
from my_simulations.description.actor import Actor, Animation, Trajectory, Waypoint
from my_simulations.description.light import Light
from my_simulations.description.shapes import Box, Mesh, Plane
from my_simulations.description.surroundings import Road, Scene
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.sensing.api import (
    DEPTH,
    LABELS,
    NO_ROW,
    RGB,
    CameraSpec,
    Figure,
    PaintedRoad,
    SetScenery,
)
from my_simulations.sensing.camera.renderer import Renderer
from my_simulations.sensing.poses import matrix
from my_simulations.sensing.rays.embree import Embree
from my_simulations.sensing.rays.ray_scene import RayScene
from my_simulations.sensing.rays.ray_shapes import RayShape

ALL = (RGB, DEPTH, LABELS)
BRIGHT = Scene(ambient=(1.0, 1.0, 1.0, 1.0), background=(0.0, 0.0, 0.0, 1.0))
DARK = Scene(ambient=(0.0, 0.0, 0.0, 1.0), background=(0.0, 0.0, 0.0, 1.0))
RED = Look(diffuse=(1.0, 0.0, 0.0, 1.0), lit=False)
WHITE = Look(diffuse=(1.0, 1.0, 1.0, 1.0))
SPEC = CameraSpec(200, 200, math.pi / 2)
ABOVE = Pose((0.0, 0.0, 5.0), quat_from_rpy(0.0, math.pi / 2, 0.0))
"""Looks down; 20 pixels a metre, up in the picture is +x, left is +y."""
AHEAD = Pose((-5.0, 0.0, 1.0))
S = 1_000_000_000


@pytest.fixture(scope="module")
def renderer():
    return Renderer(lambda text: None)


@pytest.fixture
def view(renderer):
    renderer.said = []
    renderer._trouble = renderer.said.append
    renderer.set_lights([], BRIGHT)
    names = []

    def see(scenery, eye=ABOVE, ns=0, bodies=(), poses=(), outputs=ALL):
        for one in bodies:
            names.append(one.name)
            renderer.add(one)
        renderer.set_scenery(scenery)
        return renderer.render(SPEC, matrix(eye), table(poses), outputs, ns)

    see.renderer = renderer
    yield see
    renderer.set_scenery(SetScenery())
    for name in names:
        renderer.remove(name)
    assert not renderer._batches and not renderer._scenic


@pytest.fixture
def rays():
    said = []
    made = RayScene(Embree(), said.append)
    made.said = said
    yield made
    made.clear()


def pixel(x, y, height=0.0, eye=5.0):
    """Row and column of a point of the ground, seen by `ABOVE`."""
    scale = 100.0 / (eye - height)
    return round(99.5 - x * scale), round(99.5 - y * scale)


def laid(look=RED, width=2.0, points=((-2.0, 1.0, 0.0), (2.0, 1.0, 0.0))):
    return SetScenery((PaintedRoad(Road("road", width, list(points)), look),))


def cast(scene, origin, way, far=50.0):
    found = scene.cast(np.array(origin, dtype=float), np.array([way], dtype=float), 0.0, far)
    return [one[0] for one in found]


# -- roads -----------------------------------------------------------------------------------------


def test_a_road_is_seen_where_it_lies_in_its_colour_depth_and_without_a_label(view):
    found = view(laid())
    for x, y, there in ((0.0, 1.0, True), (1.9, 1.9, True), (-1.9, 0.1, True), (2.2, 1.0, False),
                        (0.0, 2.2, False), (0.0, -0.2, False)):
        at = pixel(x, y)
        assert (found.rgb[at].tolist() == [255, 0, 0]) == there, (x, y)
        assert math.isfinite(found.depth[at]) == there
        assert found.labels[at] == NO_ROW
    assert found.depth[pixel(0.0, 1.0)] == pytest.approx(4.99, abs=1e-4)


def test_a_road_lies_on_a_ground_of_its_height_and_below_what_stands_on_it(view):
    ground = body("g", Plane(size=(20.0, 20.0)), 0, WHITE)
    crate = body("b", Box((0.5, 0.5, 0.5)), 1, WHITE)
    found = view(laid(), bodies=[ground, crate], poses=[Pose(), Pose((0.0, 1.0, 0.25))])
    assert found.rgb[pixel(1.0, 1.0)].tolist() == [255, 0, 0]
    assert found.labels[pixel(1.0, 1.0)] == NO_ROW and found.labels[pixel(1.0, -1.0)] == 0
    assert found.labels[pixel(0.0, 1.0, 0.5)] == 1


def test_a_road_of_one_point_leaves_the_others_in_their_places(view):
    bare, whole = laid(points=((9.0, 9.0, 0.0),)), laid()
    found = view(SetScenery((*bare.roads, *whole.roads)))
    assert found.rgb[pixel(0.0, 1.0)].tolist() == [255, 0, 0]
    assert found.rgb[pixel(2.2, 1.0)].tolist() != [255, 0, 0]


def test_a_road_without_a_material_is_asphalt_with_lines_along_it(view):
    asphalt = Look(pattern="road", lit=False)
    found = view(laid(asphalt, 4.0, [(-4.0, 0.0, 0.0), (4.0, 0.0, 0.0)])).rgb
    ground, line = ([color >> shift & 255 for shift in (16, 8, 0)]
                    for color in PATTERNS["road"].colors)
    # Lines begin 4 of 256 pixels from the sides: 6.3 cm, 1.5 pixels of this picture.
    assert np.abs(found[pixel(0.0, 1.0)].astype(int) - ground).max() < 25
    assert np.abs(found[pixel(0.0, 1.9)].astype(int) - line).max() < 90
    # The middle line is dashed: half of each repetition, 4 m, has it; as the page draws it.
    middle = found[:, 99:101].max(axis=(1, 2))
    dashed = {x: middle[pixel(x, 0.0)[0]] > 150 for x in (-3.0, -1.0, 1.0, 3.0)}
    assert dashed == {-3.0: False, -1.0: True, 1.0: False, 3.0: True}


def sun(x, z):
    return Light("sun", "directional", direction=(x, 0.0, z), diffuse=(1.0, 1.0, 1.0, 1.0),
                 cast_shadows=True)


def test_a_shadow_falls_on_a_road_and_a_road_throws_none(view):
    view.renderer.set_lights([sun(1.0, -1.0)], DARK)
    plate, ground = body("b", Box((1.0, 1.0, 0.1)), 0, WHITE), body("g", Plane(size=(9.0, 9.0)), 1,
                                                                    WHITE)
    raised = laid(WHITE, points=((-2.0, 1.0, 0.5), (2.0, 1.0, 0.5)))
    found = view(raised, bodies=[plate, ground], poses=[Pose((0.0, 1.0, 1.5)), Pose()]).rgb
    assert found[pixel(1.2, 1.0, 0.5)].max() < 5
    assert found[pixel(-1.2, 1.0, 0.5)].min() > 200
    assert found[pixel(2.2, 1.0)].min() > 180   # the ground where the road's shadow were


def test_rays_meet_a_road_and_tell_no_link(rays):
    rays.set_scenery(laid())
    rays.add("wall", [(0, [RayShape(Box((0.1, 9.0, 9.0)), Pose(), 5.0)])])
    rays.move(table([Pose((4.0, 0.0, 0.0))]))
    assert cast(rays, (0.0, 1.0, 3.0), (0.0, 0.0, -1.0)) == [pytest.approx(2.99, abs=1e-4), 0.0,
                                                             NO_ROW]
    assert cast(rays, (0.0, -1.0, 3.0), (0.0, 0.0, -1.0))[0] == math.inf
    assert cast(rays, (0.0, 1.0, 3.0), (1.0, 0.0, 0.0)) == [pytest.approx(3.95, abs=1e-4), 5.0, 0]
    rays.set_scenery(SetScenery())
    rays.move(table([Pose((4.0, 0.0, 0.0))]))
    assert cast(rays, (0.0, 1.0, 3.0), (0.0, 0.0, -1.0))[0] == math.inf
    assert cast(rays, (0.0, 1.0, 3.0), (1.0, 0.0, 0.0))[0] == pytest.approx(3.95, abs=1e-4)


# -- actors ----------------------------------------------------------------------------------------


def actor(**fields):
    return Actor("man", **fields)


def path(*places, loop=False, delay=0.0):
    """Through these places, a second apart."""
    return {"loop": loop, "delay_start": delay, "trajectories": [Trajectory(waypoints=[
        Waypoint(float(n), Pose(place)) for n, place in enumerate(places)])]}


def figure(folder, skin, one, scale=1.0, animations=()):
    file = folder / "skin.dae"
    file.write_text(skin)
    return Figure(one, Mesh("skin.dae", str(file), (scale,) * 3), animations)


def scenery(*figures):
    return SetScenery((), figures)


def ahead(y, z, distance=4.9):
    """Row and column of a point that far before `AHEAD`."""
    return round(99.5 - 100.0 * (z - 1.0) / distance), round(99.5 - 100.0 * y / distance)


def is_red(found, y, z):
    return found.rgb[ahead(y, z)].tolist() == [255, 0, 0]


def test_an_actor_is_seen_where_it_is_at_the_time_of_the_picture(view, tmp_path):
    walk = scenery(figure(tmp_path, rod(), actor(**path((0.0, -2.0, 0.0), (0.0, 2.0, 0.0)))))
    quarter = 1.1875   # from the middle: 2 - (2 u + 6 u^2 - 4 u^3) for u = 1/4
    for ns, y in ((0, -2.0), (S // 4, -quarter), (S * 3 // 4, quarter), (5 * S, 2.0)):
        found = view(walk, AHEAD, ns)
        for other in (-2.0, -quarter, 0.0, quarter, 2.0):
            assert is_red(found, other, 0.5) == is_red(found, other, 1.5) == (other == y)
        assert found.depth[ahead(y, 0.5)] == pytest.approx(4.9, abs=1e-4)
        assert found.labels[ahead(y, 0.5)] == NO_ROW
    assert view.renderer.said == []


def test_pictures_are_a_function_of_sim_time(view, tmp_path):
    walk = scenery(figure(tmp_path, swinging(), actor(**path((0.0, -2.0, 0.0), (0.0, 2.0, 0.0)))))
    def taken(ns):
        found = view(walk, AHEAD, ns)
        return found.rgb.tobytes() + found.depth.tobytes()
    first = [taken(ns) for ns in (0, S // 3, S // 2, 7 * S)]
    assert len(set(first)) == 4
    assert [taken(ns) for ns in (7 * S, S // 2, S // 3, 0)] == first[::-1]
    view(SetScenery())
    assert taken(S // 3) == first[1]


def test_limbs_follow_their_bones(view, tmp_path):
    stand = scenery(figure(tmp_path, swinging(seconds=2.0), actor()))
    for ns, angle in ((0, 0.0), (S, math.pi / 4), (S * 3 // 2, math.pi * 3 / 8),
                      (3 * S, math.pi / 4)):
        found = view(stand, AHEAD, ns)
        assert is_red(found, 0.0, 0.5)
        for other in (0.0, math.pi / 4, math.pi * 3 / 8):
            tip = (-0.8 * math.sin(other), 1.0 + 0.8 * math.cos(other))
            assert is_red(found, *tip) == (other == angle), (ns, other)


def test_an_actor_waits_in_the_shape_of_its_file(view, tmp_path):
    late = scenery(figure(tmp_path, swinging(), actor(delay_start=10.0)))
    assert is_red(view(late, AHEAD, 9 * S), 0.0, 1.8)
    assert not is_red(view(late, AHEAD, 11 * S), 0.0, 1.8)
    never = scenery(figure(tmp_path, swinging(), actor(auto_start=False)))
    assert is_red(view(never, AHEAD, 11 * S), 0.0, 1.8)


def test_an_actor_has_the_scale_of_its_skin_and_the_orientation_of_its_pose(view, tmp_path):
    lying = Pose((0.0, 0.0, 1.0), quat_from_rpy(math.pi / 2, 0.0, 0.0))  # up becomes -y
    found = view(scenery(figure(tmp_path, rod(), actor(pose=lying), scale=0.5)), AHEAD)
    for y, there in ((-0.25, True), (-0.8, True), (-1.2, False), (0.25, False)):
        assert (found.rgb[ahead(y, 1.0, 4.95)].tolist() == [255, 0, 0]) == there, y
    assert found.depth[ahead(-0.25, 1.0, 4.95)] == pytest.approx(4.95, abs=1e-4)


def test_another_file_s_animation_turns_bones_of_the_same_names(view, tmp_path):
    mover = tmp_path / "mover.dae"
    mover.write_text(swinging(seconds=4.0))
    borrowed = scenery(figure(tmp_path, rod(), actor(animations=[Animation("fall", "mover.dae")]),
                              animations=(str(mover),)))
    found = view(borrowed, AHEAD, 2 * S)
    assert is_red(found, -0.8 * math.sqrt(0.5), 1.0 + 0.8 * math.sqrt(0.5))
    mover.write_text(rod())
    still = scenery(figure(tmp_path, swinging(), actor(), animations=(str(mover),)))
    assert is_red(view(still, AHEAD, S), 0.0, 1.8)


def test_limbs_move_by_the_animation_that_the_trajectory_names(view, tmp_path):
    for name, text in (("fall.dae", swinging(seconds=4.0)), ("stand.dae", rod())):
        (tmp_path / name).write_text(text)
    there = [Waypoint(time, Pose()) for time in (0.0, 2.0)]
    man = actor(animations=[Animation("fall", "fall.dae"), Animation("stand", "stand.dae")],
                trajectories=[Trajectory(0, "stand", waypoints=there),
                              Trajectory(1, "fall", waypoints=there)], loop=False)
    files = tuple(str(tmp_path / one.filename) for one in man.animations)
    shown = scenery(figure(tmp_path, rod(), man, animations=files))
    half = math.sqrt(0.5)
    for ns, fallen in ((S, False), (4 * S, True)):
        found = view(shown, AHEAD, ns)
        assert is_red(found, 0.0, 1.8) != fallen
        assert is_red(found, -0.8 * half, 1.0 + 0.8 * half) == fallen


def test_an_actor_throws_a_shadow_that_goes_with_it(view, tmp_path):
    walk = figure(tmp_path, rod(), actor(**path((0.0, -2.0, 0.0), (0.0, 2.0, 0.0))))
    view.renderer.set_lights([sun(1.0, -1.0)], DARK)
    ground = body("g", Plane(size=(20.0, 20.0)), 0, WHITE)
    for ns, y in ((0, -2.0), (S, 2.0)):
        found = view(scenery(walk), ns=ns, bodies=[ground] if not ns else [], poses=[Pose()]).rgb
        assert (found[pixel(0.5, y)].max() < 5, found[pixel(0.5, -y)].min() > 150) == (True, True)


def test_a_skin_that_is_not_there_is_told_and_the_rest_is_seen(view, rays, tmp_path):
    lost = Figure(Actor("lost"), Mesh("nowhere.dae", ""))
    both = scenery(lost, figure(tmp_path, rod(), actor()), Figure(Actor("bare"), Mesh("", "")))
    assert is_red(view(both, AHEAD), 0.0, 0.5)
    [told] = view.renderer.said
    assert told.startswith("cameras do not see the actor 'lost'") and "nowhere.dae" in told
    rays.set_scenery(both)
    rays.move(table([]))
    assert cast(rays, (-5.0, 0.0, 0.5), (1.0, 0.0, 0.0))[0] == pytest.approx(4.9, abs=1e-4)
    [told] = rays.said
    assert told.startswith("rays do not see the actor 'lost'")


def test_a_skin_whose_bones_are_wrong_is_seen_as_its_file_has_it(view, tmp_path):
    wrong = rod().replace("low high", "low arm")
    found = view(scenery(figure(tmp_path, wrong, actor())), AHEAD)
    assert found.depth[ahead(0.0, 0.5)] == pytest.approx(4.9, abs=1e-4)
    assert found.depth[ahead(0.0, 1.8)] == pytest.approx(4.9, abs=1e-4)
    assert view.renderer.said == ["cameras see the actor 'man' in one shape: a skin has a joint "
                                  "'arm', which no node is"]


def test_rays_meet_an_actor_where_it_is_and_as_it_moves(rays, tmp_path):
    rays.set_scenery(scenery(figure(tmp_path, swinging(seconds=2.0), actor(
        **path((0.0, -2.0, 0.0), (0.0, 2.0, 0.0))))))
    rays.add("wall", [(0, [RayShape(Box((0.1, 9.0, 9.0)), Pose(), 5.0)])])
    poses = table([Pose((4.0, 0.0, 0.0))])
    for ns in (0, S // 2, S, S // 2):
        rays.move(poses, ns)
        y, angle = -2.0 + 4.0 * ns / S, math.pi / 4 * ns / S
        assert cast(rays, (-5.0, y, 0.5), (1.0, 0.0, 0.0)) == [
            pytest.approx(4.9, abs=1e-4), 0.0, NO_ROW]
        tip = (-5.0, y - 0.8 * math.sin(angle), 1.0 + 0.8 * math.cos(angle))
        assert cast(rays, tip, (1.0, 0.0, 0.0))[0] == pytest.approx(4.9, abs=1e-4)
        raised = cast(rays, (-5.0, y, 1.95), (1.0, 0.0, 0.0))[0]
        assert raised == pytest.approx(4.9 if angle == 0.0 else 8.95, abs=1e-4)
        assert cast(rays, (-5.0, y + 1.0, 0.5), (1.0, 0.0, 0.0))[2] == 0
