"""Pictures against closed forms: projection, depth, clipping, light, shadow, textures."""
from __future__ import annotations

import hashlib
import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from sensing_scene import body, table

from my_simulations.appearance.looks import Look
from my_simulations.appearance.materials import Materials
from my_simulations.appearance.terrain_layers import TerrainLayer
from my_simulations.appearance.textures import TextureFiles
from my_simulations.description.light import Light
from my_simulations.description.shapes import Box, Cylinder, Heightmap, Mesh, Plane, Sphere
from my_simulations.description.surroundings import Fog, Scene, Sky
from my_simulations.formats.reading import read_entity
from my_simulations.geometry import Pose, compose, quat_from_rpy, rotate
from my_simulations.resources.resolver import Resolver
from my_simulations.sensing.api import DEPTH, LABELS, RGB, CameraSpec, Distortion
from my_simulations.sensing.camera.distortion import distort
from my_simulations.sensing.camera.renderer import Renderer
from my_simulations.sensing.poses import matrix
from my_simulations.sensing.scene import body as body_of

ALL = (RGB, DEPTH, LABELS)
# White ground is drawn as bright as `palette.GROUND`, 231 of 255.
DARK = Scene(ambient=(0.0, 0.0, 0.0, 1.0), background=(0.0, 0.0, 0.0, 1.0))
BRIGHT = Scene(ambient=(1.0, 1.0, 1.0, 1.0), background=(0.0, 0.0, 0.0, 1.0))
FLAT_WHITE = Look(diffuse=(1.0, 1.0, 1.0, 1.0), lit=False)
SPEC = CameraSpec(640, 480)


@pytest.fixture(scope="module")
def renderer():
    return Renderer(lambda text: None)


@pytest.fixture
def view(renderer):
    names = []
    renderer.said = []
    renderer._trouble = renderer.said.append
    renderer.set_lights([], BRIGHT)

    def see(bodies, poses, eye=Pose(), spec=SPEC, outputs=ALL):
        for one in bodies:
            names.append(one.name)
            renderer.remove(one.name)
            renderer.add(one)
        return renderer.render(spec, matrix(eye), table(poses), outputs)

    see.renderer = renderer
    yield see
    for name in names:
        renderer.remove(name)
    assert not renderer._batches


def middle_of(mask):
    rows, columns = np.nonzero(mask)
    return columns.mean(), rows.mean()


@pytest.mark.parametrize("spec", [SPEC, CameraSpec(321, 241, 2.0), CameraSpec(1280, 720, 0.5)])
@pytest.mark.parametrize("place", [(4.0, 0.0, 0.0), (6.0, 1.0, -0.4), (3.0, -0.5, 0.35)])
def test_a_point_falls_on_the_pixel_that_the_pinhole_says_within_a_tenth(view, spec, place):
    # A plate that faces the camera keeps its middle under a perspective projection; it is turned
    # about the optical axis, so that its edges cross pixels in all their parts.
    eye = Pose((10.0, -3.0, 2.0), quat_from_rpy(0.1, -0.2, 0.7))
    ahead = place[0] - 0.0005
    size = (80.0 if spec.width > 400 else 30.0) * ahead / spec.focal_length
    turned = Pose(place, quat_from_rpy(0.3, 0.0, 0.0))
    found = view([body("b", Box((0.001, size, size)), 0)], [compose(eye, turned)], eye, spec,
                 (LABELS,))
    expected = ((spec.width - 1) / 2 - spec.focal_length * place[1] / ahead,
                (spec.height - 1) / 2 - spec.focal_length * place[2] / ahead)
    assert middle_of(found.labels == 0) == pytest.approx(expected, abs=0.1)


def test_an_edge_lies_between_the_pixels_that_the_pinhole_says(view):
    for offset in np.linspace(0.0, 0.01, 21):
        found = view([body("b", Box((0.001, 2.0, 2.0)), 0)],
                     [Pose((2.0005, 1.0 + offset, 0.0))], outputs=(LABELS,))
        edge = (found.labels[240] == 0).sum() - 0.5
        assert edge == pytest.approx(319.5 - SPEC.focal_length * offset / 2.0, abs=0.501)


def test_depth_is_the_distance_along_the_axis_within_a_fifth_of_a_millimetre(view):
    eye = Pose((100.0, 50.0, 3.0), quat_from_rpy(0.0, 0.3, 1.0))
    ground = Pose((100.0, 50.0, 0.0))
    found = view([body("g", Plane(size=(100.0, 100.0)), 0)], [ground], eye)
    column, row = np.meshgrid(np.arange(640), np.arange(480))
    ways = np.stack([np.ones((480, 640)), (319.5 - column) / SPEC.focal_length,
                     (239.5 - row) / SPEC.focal_length], axis=-1)
    down = np.array(rotate((-eye.orientation[0], -eye.orientation[1], -eye.orientation[2],
                            eye.orientation[3]), (0.0, 0.0, -1.0)))
    expected = 3.0 / (ways @ down)
    seen = np.isfinite(found.depth) & (expected > 0) & (expected < 10.0)
    assert seen.sum() > 100000
    errors = np.abs(found.depth[seen] - expected[seen])
    assert np.quantile(errors, 0.99) < 2e-4
    assert (found.labels[seen] == 0).all()


def test_depth_of_a_ball(view):
    found = view([body("s", Sphere(1.0), 0)], [Pose((4.0, 0.0, 0.0))], outputs=(DEPTH,))
    assert found.rgb is None and found.labels is None
    assert found.depth[239:241, 319:321] == pytest.approx(3.0, abs=2e-3)
    assert found.depth[0, 0] == math.inf


def test_near_and_far_clip(view):
    spec = CameraSpec(64, 48, near=1.0, far=5.0)
    boxes = [body("a", Box((0.2, 9, 9)), 0), body("b", Box((0.2, 9, 9)), 1)]
    for places, label, depth in (((0.5, 3.0), 1, 2.9), ((1.2, 3.0), 0, 1.1),
                                 ((0.5, 5.2), -1, math.inf)):
        found = view(boxes, [Pose((x, 0, 0)) for x in places], spec=spec)
        assert found.labels[24, 32] == label
        assert found.depth[24, 32] == pytest.approx(depth, abs=1e-4)


def test_colours_come_through_unlit_and_under_full_ambient_light(view):
    color = (0.8, 0.4, 0.1, 1.0)
    for look in (Look(diffuse=color, lit=False), Look(ambient=color)):
        found = view([body("b", Box((1.0, 9, 9)), 0, look)], [Pose((3.0, 0, 0))])
        wanted = np.array(color[:3]) * 255
        factor = 1.0 if not look.lit else 0.8 ** (1 / 2.4)  # the sky half of the ambient light
        assert np.abs(found.rgb[240, 320] - wanted * factor).max() < (1.5 if not look.lit else 5)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2])
def test_a_lamp_falls_by_the_cosine_of_its_angle(view, angle):
    sun = Light("sun", "directional", direction=(math.cos(angle), 0.0, -math.sin(angle)),
                diffuse=(0.5, 0.5, 0.5, 1.0))
    view.renderer.set_lights([sun], DARK)
    white = Look(diffuse=(1.0, 1.0, 1.0, 1.0))
    found = view([body("b", Box((1.0, 9, 9)), 0, white)], [Pose((3.0, 0, 0))])
    shade = found.rgb[240, 320, 0] / 255.0
    linear = ((shade + 0.055) / 1.055) ** 2.4
    assert linear == pytest.approx(0.5 * math.cos(angle), abs=0.01)


def test_a_lamp_fades_as_its_attenuation_says_and_ends_at_its_range(view):
    lamp = Light("l", "point", Pose((1.0, 0, 0)), range=3.0, constant=0.5, linear=0.3,
                 quadratic=0.2)
    view.renderer.set_lights([lamp], DARK)
    white = Look(diffuse=(1.0, 1.0, 1.0, 1.0))
    for away, expected in ((2.0, 1.0 / (0.5 + 0.6 + 0.8)), (3.5, 0.0)):
        found = view([body("b", Box((1.0, 9, 9)), 0, white)], [Pose((1.5 + away, 0, 0))])
        linear = ((found.rgb[240, 320, 0] / 255.0 + 0.055) / 1.055) ** 2.4
        assert linear == pytest.approx(expected, abs=0.01)


def shadow_world(view, scene=DARK, casts=True, plate=Box((1.0, 1.0, 0.2)), **camera):
    sun = Light("sun", "directional", cast_shadows=casts, direction=(0.0, 0.0, -1.0))
    view.renderer.set_lights([sun], scene)
    bodies = [body("g", Plane(size=(20, 20)), 0, Look(diffuse=(1.0, 1.0, 1.0, 1.0))),
              body("b", plate, 1)]
    eye = Pose((3.0, 0.0, 0.9), quat_from_rpy(0.0, 0.4, 0.0))  # looks below the box
    return view(bodies, [Pose((6.0, 0, 0)), Pose((6.0, 0, 3.0))], eye,
                CameraSpec(640, 480, **camera))


def seen_at(x, y):
    """The pixel where `shadow_world`'s camera sees a point of the ground."""
    turn = np.array(rotate(quat_from_rpy(0.0, -0.4, 0.0), (x - 3.0, y, -0.9)))
    f = SPEC.focal_length
    return round(239.5 - f * turn[2] / turn[0]), round(319.5 - f * turn[1] / turn[0])


def test_a_shadow_lies_where_the_light_is_kept_off(view):
    found = shadow_world(view).rgb
    for x, y in ((5.6, 0.0), (6.4, 0.0), (6.0, 0.4), (6.0, -0.4)):
        assert found[seen_at(x, y)].max() < 5, (x, y)
    for x, y in ((5.35, 0.0), (6.65, 0.0), (6.0, 0.65), (6.0, -0.65)):
        assert found[seen_at(x, y)].min() > 228, (x, y)


def test_shadows_can_be_off_for_a_light_a_world_and_a_camera(view):
    dull = Scene(ambient=DARK.ambient, background=DARK.background, shadows=False)
    for found in (shadow_world(view, casts=False), shadow_world(view, dull),
                  shadow_world(view, shadows=False)):
        assert found.rgb[seen_at(6.0, 0.0)].min() > 228


def test_a_kept_shadow_map_gives_the_bytes_of_a_new_one_and_follows_what_moves(view):
    first = shadow_world(view).rgb.tobytes()
    again = shadow_world(view).rgb.tobytes()
    moved = view([], [Pose((6.0, 0, 0)), Pose((6.0, 2.0, 3.0))],
                 Pose((3.0, 0.0, 0.9), quat_from_rpy(0.0, 0.4, 0.0))).rgb
    back = shadow_world(view).rgb.tobytes()
    assert first == again == back
    assert moved[seen_at(6.0, 0.0)].min() > 228 and moved[seen_at(6.0, 1.6)].max() < 5


def test_a_texture_lies_upright_on_a_wall_and_repeats(view, tmp_path):
    from PIL import Image

    path = str(tmp_path / "four.png")
    Image.fromarray(np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]],
                             dtype=np.uint8).repeat(32, axis=0).repeat(32, axis=1)).save(path)
    wall = [Pose((3.0, 0, 0))]
    look = Look(diffuse=(1, 1, 1, 1), texture=path, lit=False)
    found = view([body("b", Box((1.0, 1.0, 1.0)), 0, look)], wall).rgb
    corners = {name: found[240 + dy, 320 + dx].tolist() for name, dy, dx in (
        ("upper left", -60, -60), ("upper right", -60, 60), ("lower left", 60, -60),
        ("lower right", 60, 60))}
    assert corners == {"upper left": [255, 0, 0], "upper right": [0, 255, 0],
                       "lower left": [0, 0, 255], "lower right": [255, 255, 255]}
    small = Look(diffuse=(1, 1, 1, 1), texture=path, scale=(0.5, 0.5), lit=False)
    found = view([body("b", Box((1.0, 1.0, 1.0)), 0, small)], wall).rgb
    assert found[240 - 90, 320 - 90].tolist() == found[240 - 90, 320 + 20].tolist() == [255, 0, 0]


def test_a_texture_file_that_changed_is_seen_when_its_model_comes_again(view, tmp_path):
    from PIL import Image

    picture = tmp_path / "label.png"
    look = Look(diffuse=(1, 1, 1, 1), texture=str(picture), lit=False)
    for n, color in enumerate([(255, 0, 0), (0, 0, 255)]):
        Image.new("RGB", (4, 4), color).save(str(picture))
        os.utime(str(picture), (n, n))
        found = view([body("b", Box((1.0, 9, 9)), 0, look)], [Pose((3.0, 0, 0))])
        assert found.rgb[240, 320].tolist() == list(color)


@pytest.mark.parametrize("material, faint", [
    ({}, [255, 255, 255]), ({"alpha_test": 0.5}, [255, 0, 0]), ({"blended": True}, None)])
def test_a_texture_s_alpha_counts_as_its_material_says(view, tmp_path, material, faint):
    from PIL import Image

    path = str(tmp_path / "leaf.png")
    pixels = np.full((32, 32, 4), 255, dtype=np.uint8)
    pixels[:, 8:24, 3] = 77
    Image.fromarray(pixels, "RGBA").save(path)
    leaf = Look(diffuse=(1, 1, 1, 1), texture=path, lit=False, **material)
    behind = Look(diffuse=(1, 0, 0, 1), lit=False)
    found = view([body("leaf", Box((0.01, 1.0, 1.0)), 0, leaf),
                  body("wall", Box((0.1, 4.0, 4.0)), 1, behind)],
                 [Pose((3.0, 0, 0)), Pose((4.0, 0, 0))]).rgb
    middle, edge = found[240, 320].tolist(), found[240, 320 - 70].tolist()
    assert edge == [255, 255, 255]
    if faint is None:  # only the front of the leaf is seen
        assert middle[0] == 255 and abs(middle[1] - 77) <= 2 and middle[1] == middle[2]
    else:
        assert middle == faint


def leaf_with_a_hole(tmp_path, alpha_test):
    """A material whose picture is faint between a quarter and three quarters of its width."""
    from PIL import Image

    pixels = np.full((32, 32, 4), 255, dtype=np.uint8)
    pixels[:, 8:24, 3] = 77
    path = str(tmp_path / "leaf.png")
    Image.fromarray(pixels, "RGBA").save(path)
    return Look(diffuse=(1, 1, 1, 1), texture=path, alpha_test=alpha_test)


@pytest.mark.parametrize("outputs", [ALL, (DEPTH, LABELS)])
@pytest.mark.parametrize("alpha_test, behind", [(0.5, True), (0.2, False), (0.0, False)])
def test_depth_and_labels_go_through_what_a_material_cuts_out(view, tmp_path, outputs, alpha_test,
                                                              behind):
    leaf = leaf_with_a_hole(tmp_path, alpha_test)
    found = view([body("leaf", Box((0.01, 1.0, 1.0)), 0, leaf),
                  body("wall", Box((0.1, 4.0, 4.0)), 1)],
                 [Pose((3.0, 0, 0)), Pose((4.0, 0, 0))], outputs=outputs)
    scale = SPEC.focal_length / 2.995
    near, far = np.float32(2.995), np.float32(3.95)
    for column, through in ((0, behind), (0.22 * scale, behind), (0.28 * scale, False)):
        at = 240, round(319.5 - column)
        assert found.depth[at] == pytest.approx(far if through else near, abs=2e-4), column
        assert found.labels[at] == (1 if through else 0), column


@pytest.mark.parametrize("alpha_test, lit", [(0.5, True), (0.2, False)])
def test_light_falls_through_what_a_material_cuts_out(view, tmp_path, alpha_test, lit):
    sun = Light("sun", "directional", cast_shadows=True, direction=(0.0, 0.0, -1.0))
    view.renderer.set_lights([sun], DARK)
    ground = body("g", Plane(size=(20, 20)), 0, Look(diffuse=(1.0, 1.0, 1.0, 1.0)))
    eye = Pose((3.0, 0.0, 0.9), quat_from_rpy(0.0, 0.4, 0.0))
    found = view([ground, body("b", Box((2.0, 2.0, 0.01)), 1,
                               leaf_with_a_hole(tmp_path, alpha_test))],
                 [Pose((6.0, 0, 0)), Pose((6.0, 0, 3.0))], eye).rgb
    hole = found[seen_at(6.0, 0.0)]
    assert hole.min() > 228 if lit else hole.max() < 5
    assert found[seen_at(6.0, 1.3)].min() > 228
    # The picture's width lies along x or y; the rim is in the shade on two sides at least.
    rim = [found[seen_at(6.0 + x, y)].max() < 5
           for x, y in ((0.8, 0.0), (-0.8, 0.0), (0.0, 0.8), (0.0, -0.8))]
    assert sum(rim) == (2 if lit else 4)


def test_an_unreadable_picture_is_told_and_the_rest_is_drawn(view):
    look = Look(diffuse=(1, 0, 0, 1), texture="/nowhere/wood.png", lit=False)
    found = view([body("b", Box((1.0, 9, 9)), 0, look)], [Pose((3.0, 0, 0))])
    assert found.rgb[240, 320].tolist() == [255, 0, 0]
    assert "/nowhere/wood.png" in view.renderer.said[0]


def test_a_mesh_that_its_reader_did_not_find_is_not_reported_again(view):
    view([body("stool", Mesh("model://gone/stool.dae"), 0)], [Pose()])
    assert view.renderer.said == []


def test_a_mesh_that_is_missing_is_told_with_its_link(view):
    view([body("stool", Mesh("/nowhere/stool.dae", "/nowhere/stool.dae"), 0)], [Pose()])
    (said,) = view.renderer.said
    assert "/nowhere/stool.dae" in said and "'stool::link'" in said


def test_a_mesh_brings_its_own_colours_unless_the_visual_says_others(view, tmp_path):
    (tmp_path / "m.mtl").write_text("newmtl a\nKd 0 1 0\n")
    path = tmp_path / "m.obj"
    path.write_text("mtllib m.mtl\nv 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nusemtl a\n"
                    "f 1 4 3\nf 1 3 2\n")
    mesh = Mesh("m.obj", str(path))
    view.renderer.set_lights([], Scene(ambient=(1, 1, 1, 1)))
    green = view([body("b", mesh, 0)], [Pose((3.0, 0, 0))]).rgb[240, 320]
    assert green[1] > 200 and green[0] == green[2] == 0
    red = view([body("b", mesh, 0, Look(diffuse=(1, 0, 0, 1)))], [Pose((3.0, 0, 0))]).rgb[240, 320]
    assert red[0] > 200 and red[1] == red[2] == 0


QUAD = "v 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"


def quad_of(folder, materials, faces):
    """A square across the camera's axis; `faces` name materials and corners."""
    (folder / "q.mtl").write_text(materials)
    (folder / "q.obj").write_text(f"mtllib q.mtl\n{QUAD}{faces}")
    return Mesh("q.obj", str(folder / "q.obj"))


@pytest.mark.parametrize("order", [("a", "b"), ("b", "a")])
def test_of_two_faces_at_one_place_the_one_seen_from_its_front_is_drawn(view, tmp_path, order):
    faces = {"a": "usemtl a\nf 1 4 3\nf 1 3 2\n", "b": "usemtl b\nf 1 2 3\nf 1 3 4\n"}
    mesh = quad_of(tmp_path, "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 0 1\n",
                   "".join(faces[one] for one in order))
    view.renderer.set_lights([], Scene(ambient=(1, 1, 1, 1)))
    for yaw, front in ((0.0, 0), (math.pi, 2)):
        at = Pose((3.0, 0.1, 0.1), quat_from_rpy(0.0, 0.0, yaw))
        part = view([body("q", mesh, 0)], [at]).rgb[180:300, 260:380].reshape(-1, 3)
        assert part[:, front].min() > 150 and part[:, 2 - front].max() == 0, yaw


@pytest.mark.parametrize("shape", [Box((0.05, 0.05, 0.05)), Sphere(0.03), Cylinder(0.03, 0.05)])
def test_a_camera_in_the_middle_of_its_own_housing_sees_the_world(view, shape):
    # The usual template of a robot's camera: a box of 5 cm with the sensor in its middle.
    housing = body("housing", shape, 0, Look(diffuse=(1.0, 0.0, 0.0, 1.0), lit=False))
    wall = body("wall", Box((0.1, 9.0, 9.0)), 1, FLAT_WHITE)
    found = view([housing, wall], [Pose(), Pose((2.05, 0.0, 0.0))],
                 spec=CameraSpec(64, 48, near=0.02))
    assert (found.rgb[5:-5, 5:-5] == 255).all()
    assert (found.labels[5:-5, 5:-5] == 1).all()
    assert found.depth[24, 32] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("look, seen", [
    (FLAT_WHITE, 0), (replace(FLAT_WHITE, double_sided=True), 231)])
def test_faces_are_seen_from_behind_only_if_their_material_is_double_sided(view, look, seen):
    found = view([body("b", Plane((-1.0, 0.0, 0.0), (9.0, 9.0)), 0, look)],
                 [Pose((-2.0, 0.0, 0.0))], Pose((-3.0, 0.0, 0.0)), CameraSpec(64, 48))
    assert (found.rgb[24, 32] == 231).all()  # from its front, as bright as a ground
    found = view([body("b", Plane((1.0, 0.0, 0.0), (9.0, 9.0)), 0, look)],
                 [Pose((-2.0, 0.0, 0.0))], Pose((-3.0, 0.0, 0.0)), CameraSpec(64, 48))
    assert (found.rgb[24, 32] == seen).all()
    assert (found.labels[24, 32] == 0) == bool(seen)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
def test_a_face_keeps_light_off_from_either_side(view, normal):
    found = shadow_world(view, plate=Plane(normal, (1.0, 1.0))).rgb
    assert found[seen_at(6.0, 0.0)].max() < 5
    assert found[seen_at(6.65, 0.0)].min() > 228


def test_what_glows_has_the_colours_of_its_picture(view, tmp_path):
    from PIL import Image

    Image.new("RGB", (4, 4), (200, 0, 0)).save(tmp_path / "red.png")
    mesh = quad_of(tmp_path, "newmtl a\nKd 1 1 1\nKe 1 1 1\nmap_Kd red.png\n",
                   "usemtl a\nf 1/1 4/4 3/3\nf 1/1 3/3 2/2\n")
    view.renderer.set_lights([], DARK)
    assert view([body("q", mesh, 0)], [Pose((3.0, 0, 0))]).rgb[240, 320].tolist() == [200, 0, 0]
    look = Look(diffuse=(1, 1, 1, 1), emissive=(1, 1, 1, 1), texture=str(tmp_path / "red.png"))
    found = view([body("b", Box((1.0, 1.0, 1.0)), 0, look)], [Pose((3.0, 0, 0))]).rgb
    assert found[240, 320].tolist() == [200, 0, 0]


def test_layers_of_a_terrain_are_blended_by_height_and_repeat_by_their_size(view, tmp_path):
    from PIL import Image

    slope = np.repeat(np.linspace(0, 255, 65).round().astype(np.uint8)[None], 65, axis=0)
    Image.fromarray(slope).save(tmp_path / "slope.png")
    halves = np.zeros((8, 8, 3), dtype=np.uint8)
    halves[:, :4] = (255, 0, 0)
    Image.fromarray(halves).save(tmp_path / "red_left.png")
    Image.new("RGB", (4, 4), (0, 0, 255)).save(tmp_path / "blue.png")
    terrain = Heightmap("slope.png", str(tmp_path / "slope.png"), size=(64.0, 64.0, 8.0),
                        position=(0.0, 0.0, 1.0))
    look = Look(lit=False, layers=(
        TerrainLayer(str(tmp_path / "red_left.png"), size=16.0),
        TerrainLayer(str(tmp_path / "blue.png"), size=4.0, min_height=4.0, fade_dist=2.0)))
    eye = Pose((0.0, 0.0, 100.0), quat_from_rpy(0.0, math.pi / 2, 0.0))   # x is up, y to the left
    found = view([body("t", terrain, 0, look)], [Pose()], eye).rgb

    def at(x, y):
        """The pixel that shows a point of the slope, whose height is 1 at x = -32 and 9 at 32."""
        away = 100.0 - 1.0 - 8.0 * (x + 32.0) / 64.0
        return found[round(239.5 - SPEC.focal_length * x / away),
                     round(319.5 - SPEC.focal_length * y / away)].tolist()

    assert at(-30.0, 5.0) == at(-14.0, -20.0) == [255, 0, 0]   # the left half of 16 m
    assert at(-20.0, 5.0) == at(-4.0, -20.0) == [0, 0, 0]
    assert at(28.0, 5.0) == at(20.0, -20.0) == [0, 0, 255]
    middle = at(4.0, 5.0)   # 4.5 m up: a quarter of the way, in linear units
    assert middle[2] == pytest.approx(255 * (1.055 * 0.25 ** (1 / 2.4) - 0.055), abs=6)


def gradient(folder, size=17):
    """A terrain of 64 m that rises evenly along x, by its image."""
    from PIL import Image

    slope = np.repeat(np.linspace(0, 255, size).round().astype(np.uint8)[None], size, axis=0)
    Image.fromarray(slope).save(folder / "even.png")
    return str(folder / "even.png")


@pytest.mark.parametrize("tilt", [-0.5, 0.0, 0.5])
def test_normal_maps_of_a_terrain_turn_its_normals(view, tmp_path, tilt):
    from PIL import Image

    normal = np.array([math.sin(tilt), 0.0, math.cos(tilt)])   # x is eastwards
    Image.new("RGB", (8, 8), tuple(round(127.5 * (one + 1.0)) for one in normal)).save(
        tmp_path / "tilted.png")
    terrain = Heightmap("even.png", gradient(tmp_path), size=(64.0, 64.0, 0.001))
    layer = TerrainLayer("", "", str(tmp_path / "tilted.png"), 4.0)
    sun = Light("sun", "directional", direction=(-math.sin(0.5), 0.0, -math.cos(0.5)),
                diffuse=(1.0, 1.0, 1.0, 1.0), cast_shadows=False)
    view.renderer.set_lights([sun], DARK)
    eye = Pose((0.0, 0.0, 40.0), quat_from_rpy(0.0, math.pi / 2, 0.0))
    found = view([body("t", terrain, 0, Look(layers=(layer,)))], [Pose()], eye).rgb
    grey = (0.7 + 0.055) / 1.055
    light = grey ** 2.4 * math.cos(0.5 - tilt)
    assert found[240, 320].tolist() == pytest.approx(
        [255 * (1.055 * light ** (1 / 2.4) - 0.055)] * 3, abs=2)


def test_light_goes_over_smoothly_from_one_triangle_of_a_terrain_to_the_next(view, tmp_path):
    from PIL import Image

    ridge = np.repeat((255 - 255 * np.abs(np.linspace(-1, 1, 17))).round().astype(
        np.uint8)[None], 17, axis=0)
    Image.fromarray(ridge).save(tmp_path / "ridge.png")
    terrain = Heightmap("ridge.png", str(tmp_path / "ridge.png"), size=(64.0, 64.0, 32.0),
                        sampling=1)
    sun = Light("sun", "directional", direction=(-0.7, 0.0, -0.7), diffuse=(1.0, 1.0, 1.0, 1.0),
                cast_shadows=False)
    view.renderer.set_lights([sun], DARK)
    eye = Pose((0.0, 0.0, 80.0), quat_from_rpy(0.0, math.pi / 2, 0.0))
    column = view([body("t", terrain, 0, Look(diffuse=(1, 1, 1, 1)))], [Pose()], eye).rgb[
        60:420, 320, 0].astype(int)
    # From the lit side to the dark one over the ridge; between flat triangles it is one step.
    assert column.max() - column.min() > 100 and np.abs(np.diff(column)).max() < 80


def test_a_terrain_of_a_file_is_drawn_under_its_textures(view, tmp_path):
    from PIL import Image

    resolver = Resolver()
    for name, colour in (("red", (220, 0, 0)), ("blue", (0, 0, 220))):
        Image.new("RGB", (4, 4), colour).save(tmp_path / f"{name}.png")
    textures = "".join(f"<texture><diffuse>file://{tmp_path}/{name}.png</diffuse><size>4</size>"
                       "</texture>" for name in ("red", "blue"))
    model, issues = read_entity(
        "<sdf version='1.6'><model name='t'><static>true</static><link name='l'><visual name='v'>"
        f"<geometry><heightmap><uri>file://{gradient(tmp_path)}</uri><size>64 64 4</size>{textures}"
        "<blend><min_height>1.5</min_height><fade_dist>1</fade_dist></blend>"
        "</heightmap></geometry></visual></link></model></sdf>", resolver)
    assert not issues
    terrain = body_of("t", model, 0, Materials(resolver, TextureFiles(resolver)))
    eye = Pose((0.0, 0.0, 80.0), quat_from_rpy(0.0, math.pi / 2, 0.0))
    found = view([terrain], [Pose()], eye).rgb.astype(int)
    high, low = found[80, 320], found[400, 320]
    assert low[0] > 100 and low[2] < 20 and high[2] > 100 and high[0] < 20


def test_what_did_not_change_is_not_drawn_again(view):
    place = [Pose((3.0, 0, 0))]
    first = view([body("b", Box((1, 1, 1)), 0)], place).rgb
    again = view.renderer.render(SPEC, matrix(Pose()), table(place), ALL)
    assert again.rgb is first
    moved = view.renderer.render(SPEC, matrix(Pose()), table([Pose((3.0, 0.2, 0))]), ALL)
    assert not np.array_equal(moved.rgb, first)
    view.renderer.set_lights([], DARK)
    assert view.renderer.render(SPEC, matrix(Pose()), table(place), ALL).rgb.max() == 0


def test_what_is_half_transparent_is_mixed_and_invisible_is_not_there(view):
    back = body("w", Box((0.2, 9, 9)), 0, Look(diffuse=(1, 1, 1, 1), lit=False))
    glass = Look(diffuse=(1, 0, 0, 1), transparency=0.5, lit=False)
    places = [Pose((5.0, 0, 0)), Pose((3.0, 0, 0))]
    found = view([back, body("g", Box((0.2, 1, 1)), 1, glass)], places).rgb[240, 320]
    assert found[0] == 255 and abs(int(found[1]) - 127) < 4  # once: its back faces are not seen
    found = view([back, body("g", Box((0.2, 1, 1)), 1, glass, transparency=1.0)], places)
    assert found.rgb[240, 320].tolist() == [255] * 3 and found.labels[240, 320] == 0


def test_each_of_many_lamps_lights_the_pictures_taken_beside_it(view):
    places = [20.0 * n for n in range(10)]
    walls = [body(f"wall {n}", Box((0.1, 4.0, 4.0)), n, Look(diffuse=(1.0, 1.0, 1.0, 1.0)))
             for n in range(len(places))]
    view.renderer.set_lights([Light(f"lamp {n}", "point", Pose((1.0, place, 0.0)), linear=0.0)
                              for n, place in enumerate(places)], DARK)
    poses = [Pose((3.0, place, 0.0)) for place in places]
    seen = [view(walls, poses, Pose((0.0, place, 0.0)), outputs=(RGB,)).rgb[240, 320, 0]
            for place in places]
    assert seen[0] > 200 and np.ptp(np.array(seen, dtype=int)) <= 1


@pytest.mark.parametrize("near, far", [(1.0, 4.0), (4.0, 2.0)])
@pytest.mark.parametrize("shift", [0.0, 50.0])
def test_the_nearer_of_two_panes_is_drawn_over_the_other_whatever_their_size(view, near, far,
                                                                             shift):
    red, blue = (Look(diffuse=color, transparency=0.5, lit=False)
                 for color in ((1, 0, 0, 1), (0, 0, 1, 1)))
    view.renderer.set_lights([], DARK)
    # The origin of the nearer one's link lies further away, what is seen of it does not.
    panes = [body("near", Box((0.01, near, near)), 0, red, pose=Pose((-shift, 0, 0))),
             body("far", Box((0.01, far, far)), 1, blue)]
    seen = view(panes, [Pose((2.0 + shift, 0, 0)), Pose((4.0, 0, 0))]).rgb[240, 320].astype(int)
    assert seen.tolist() == pytest.approx([128, 0, 64], abs=4)


def test_the_background_the_sky_and_fog(view):
    view.renderer.set_lights([], Scene(background=(0.2, 0.4, 0.6, 1.0)))
    assert view([], []).rgb[0, 0] == pytest.approx([51, 102, 153], abs=1)
    view.renderer.set_lights([], Scene(sky=Sky()))
    sky = view([], []).rgb
    assert sky[0, 0, 2] > sky[0, 0, 0] and sky[0].tobytes() != sky[200].tobytes()
    view.renderer.set_lights([], Scene(fog=Fog("linear", (0, 0, 1, 1), 1.0, 3.0)))
    wall = view([body("b", Box((1.0, 9, 9)), 0, FLAT_WHITE)], [Pose((5.0, 0, 0))])
    assert wall.rgb[240, 320].tolist() == [0, 0, 255]


@pytest.mark.parametrize("kind, seen", [("exp", math.exp(-0.5)), ("exp2", math.exp(-0.25))])
def test_exponential_fog_is_as_dense_as_in_gazebo(view, kind, seen):
    view.renderer.set_lights([], Scene(fog=Fog(kind, (0, 0, 0, 1), density=0.1)))
    wall = view([body("b", Box((1.0, 9, 9)), 0, FLAT_WHITE)], [Pose((5.5, 0, 0))])
    assert ((wall.rgb[240, 320, 0] / 255.0 + 0.055) / 1.055) ** 2.4 == pytest.approx(seen, abs=0.01)


def test_the_same_picture_has_the_same_sum_in_another_context(view):
    view.renderer.set_lights([Light("s", "directional", cast_shadows=True,
                                    direction=(0.3, 0.1, -1.0))], Scene(sky=Sky()))
    bodies = [body("g", Plane(size=(20, 20)), 0, Look(pattern="bricks", diffuse=(1, 1, 1, 1))),
              body("s", Sphere(0.5), 1, Look(diffuse=(1, 0, 0, 1), specular=(1, 1, 1, 1)))]
    places, eye = [Pose(), Pose((4.0, 0, 0.5))], Pose((0.0, 0.0, 1.0))

    def sum_of(picture):
        return hashlib.md5(picture.rgb.tobytes() + picture.depth.tobytes()).hexdigest()

    here = sum_of(view(bodies, places, eye))
    def elsewhere():  # a context belongs to its thread
        other = Renderer(lambda text: None)
        for one in bodies:
            other.add(one)
        other.set_lights(view.renderer._lights, view.renderer._scene)
        return sum_of(other.render(SPEC, matrix(eye), table(places), ALL))

    with ThreadPoolExecutor(1) as thread:
        assert thread.submit(elsewhere).result() == here


def test_smooth_edges_have_shades_and_plain_ones_have_none(view):
    def shades(samples):
        found = view([body("s", Sphere(1.0), 0, FLAT_WHITE)], [Pose((4.0, 0, 0))],
                     spec=CameraSpec(160, 120, samples=samples), outputs=(RGB,))
        return set(np.unique(found.rgb)) - {0, 255}

    assert not shades(1)
    assert shades(4)


@pytest.mark.parametrize("k1", [-0.25, 0.1])
def test_distortion_moves_points_as_browns_model_says(view, k1):
    lens = Distortion(k1=k1, k2=0.01, p1=0.001, p2=-0.002)
    spec = CameraSpec(640, 480, 1.2, distortion=lens)
    for y, z in ((0.5, 0.3), (-0.9, -0.6), (0.0, 0.8)):
        found = view([body("b", Box((0.001, 0.4, 0.4)), 0, FLAT_WHITE)],
                     [Pose((3.0005, y, z), quat_from_rpy(0.3, 0.0, 0.0))], spec=spec)
        rim = np.array([(side * 0.2, part) for side in (-1, 1)
                        for part in np.linspace(-0.2, 0.2, 50) * side])
        rim = np.concatenate([rim[:50], np.flip(rim[:50], 1) * (-1, 1), rim[50:],
                              np.flip(rim[50:], 1) * (-1, 1)])
        turned = rim @ np.array([[math.cos(0.3), math.sin(0.3)], [-math.sin(0.3), math.cos(0.3)]])
        u, v = distort(lens, -(y + turned[:, 0]) / 3.0, -(z + turned[:, 1]) / 3.0)
        expected = centroid(319.5 + spec.focal_length * u, 239.5 + spec.focal_length * v)
        weight = found.rgb[..., 0] / found.rgb[..., 0].sum(dtype=float)
        column, row = np.meshgrid(np.arange(640), np.arange(480))
        assert ((weight * column).sum(), (weight * row).sum()) == pytest.approx(expected, abs=0.1)
        # Labels are never mixed: an edge is off by a part of a pixel.
        assert middle_of(found.labels == 0) == pytest.approx(expected, abs=0.5)


def centroid(x, y):
    following_x, following_y = np.roll(x, -1), np.roll(y, -1)
    cross = x * following_y - following_x * y
    return (((x + following_x) * cross).sum() / (3 * cross.sum()),
            ((y + following_y) * cross).sum() / (3 * cross.sum()))


def test_a_cropped_barrel_distortion_leaves_no_border_empty(view):
    wall = body("b", Box((1.0, 99, 99)), 0, FLAT_WHITE)
    for crop in (False, True):
        spec = CameraSpec(320, 240, 1.2, distortion=Distortion(k1=-0.3, crop=crop))
        found = view([wall], [Pose((3.0, 0, 0))], spec=spec)
        assert (found.rgb[120, 0].min() == 255) == crop
        assert (found.depth[120, 0] < 10.0) == crop
