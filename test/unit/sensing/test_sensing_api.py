"""What can be asked, without a process."""
from __future__ import annotations

import math
import pickle
import subprocess
import sys

import numpy as np
import pytest

from my_simulations.appearance.looks import Look
from my_simulations.appearance.materials import Materials
from my_simulations.appearance.textures import TextureFiles
from my_simulations.description.actor import Actor, Animation
from my_simulations.description.light import Light
from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import (
    Box,
    Cone,
    Cylinder,
    Material,
    Mesh,
    Sphere,
    Visual,
)
from my_simulations.description.surroundings import Road, Scene
from my_simulations.description.world import World
from my_simulations.geometry import Pose, compose, quat_from_rpy
from my_simulations.resources.resolver import Resolver
from my_simulations.sensing import scene
from my_simulations.sensing.api import (
    AddBody,
    Body,
    CameraSpec,
    Distortion,
    LoadScene,
    PaintedRoad,
    RayReturns,
    RemoveBody,
    SetLights,
    SetScenery,
)
from my_simulations.sensing.camera.distortion import (
    distort,
    sample_bilinear,
    sample_nearest,
    source_pixels,
)
from my_simulations.sensing.camera.pictures import draw_pattern, read_picture
from my_simulations.sensing.poses import matrices, matrix, transforms
from my_simulations.sensing.process import SensingProcess
from my_simulations.sensing.tessellation import side_count, triangles_of


def test_the_interface_imports_nothing_heavy():
    code = ("import sys; import my_simulations.sensing.process, my_simulations.sensing.scene; "
            "sys.exit(bool({'numpy', 'embreex', 'moderngl', 'PIL', 'trimesh'} & set(sys.modules)))")
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_client_that_nobody_asked_has_no_process_and_closes():
    sensing = SensingProcess()
    sensing.change(LoadScene([]))
    assert sensing.pid == 0
    sensing.close()
    assert sensing.pid == 0


def test_changes_sum_up():
    state = scene.SceneState()
    one, other = Body("a", Model("a"), 0), Body("b", Model("b"), 3)
    state.apply(LoadScene([one], [Light("l")]))
    state.apply(AddBody(other))
    state.apply(AddBody(Body("a", Model("a"), 5)))
    state.apply(SetLights([], Scene(shadows=False)))
    whole = state.load_command()
    assert [body.name for body in whole.bodies] == ["a", "b"]
    assert whole.bodies[0].first_link_row == 5
    assert whole.lights == [] and not whole.scene.shadows
    state.apply(RemoveBody("a"))
    state.apply(RemoveBody("a"))
    assert list(state.bodies) == ["b"]
    told = SetScenery((PaintedRoad(Road("r"), Look()),))
    state.apply(told)
    assert state.load_command().scenery == told
    state.apply(state.load_command())
    assert state.scenery == told and list(state.bodies) == ["b"]


def test_a_body_brings_the_look_of_each_visual_that_has_a_material():
    red = Material(script_uris=["file://media/materials/scripts/gazebo.material"],
                   script_name="Gazebo/Red")
    model = Model("m", links=[Link("a", visuals=[Visual("v", Box(), material=red),
                                                 Visual("w", Box())])])
    resolver = Resolver()
    found = scene.body("m", model, 4, Materials(resolver, TextureFiles(resolver)))
    assert found.first_link_row == 4 and list(found.looks) == [(0, 0)]
    assert found.looks[0, 0].diffuse == (1.0, 0.0, 0.0, 1.0)


def test_matrices_do_what_poses_do():
    first, second = (Pose((1, 2, 3), quat_from_rpy(0.1, -0.4, 2.0)),
                     Pose((-2, 0.5, 1), quat_from_rpy(1.0, 0.3, -1.0)))
    assert matrix(first) @ matrix(second) == pytest.approx(matrix(compose(first, second)))
    assert matrices(np.zeros((0, 7))).shape == (0, 4, 4)


@pytest.mark.parametrize("radius", [0.01, 0.3, 2.0, 5.0])
def test_circles_have_as_many_sides_as_rays_need(radius):
    assert radius * (1 - math.cos(math.pi / side_count(radius))) / 2 <= 5.1e-5


def volume(surface) -> float:
    corners = surface.vertices[surface.triangles]
    return float(np.einsum("ij,ij->i", corners[:, 0],
                           np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


@pytest.mark.parametrize("shape, expected", [
    (Box((1, 2, 3)), 6.0), (Sphere(0.5), math.pi / 6), (Cylinder(0.5, 2.0), math.pi / 2),
    (Cone(0.5, 1.0), math.pi / 12)])
def test_surfaces_are_closed_and_look_outwards(shape, expected):
    surface = triangles_of(shape)
    assert volume(surface) == pytest.approx(expected, rel=2e-3)
    corners = surface.vertices[surface.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    mean = surface.normals[surface.triangles].mean(axis=1)
    large = np.linalg.norm(facing, axis=1) > 1e-12
    assert (np.einsum("ij,ij->i", facing[large], mean[large]) > 0).all()
    assert np.linalg.norm(surface.normals, axis=1) == pytest.approx(1.0)


def test_the_lens_is_undone_where_it_can_be():
    spec = CameraSpec(320, 240, 1.0, distortion=Distortion(-0.2, 0.03, 0.0, 0.001, -0.001))
    column, row = source_pixels(spec)
    f = spec.focal_length
    x, y = distort(spec.distortion, (column - 159.5) / f, (row - 119.5) / f)
    pixels_x, pixels_y = np.meshgrid(np.arange(320), np.arange(240))
    assert np.abs(x * f + 159.5 - pixels_x).max() < 1e-6
    assert np.abs(y * f + 119.5 - pixels_y).max() < 1e-6
    ideal = CameraSpec(320, 240, 1.0, distortion=Distortion())
    assert source_pixels(ideal)[0] == pytest.approx(pixels_x)


@pytest.mark.parametrize("lens", [
    Distortion(0.3), Distortion(0.5), Distortion(0.2, 0.1, 0.05), Distortion(5.0),
    Distortion(0.4, p1=0.02, p2=-0.01), Distortion(0.4, center=(0.45, 0.6))])
@pytest.mark.parametrize("hfov", [1.57, 2.2])
def test_a_pincushion_lens_leaves_no_pixel_black(lens, hfov):
    column, row = source_pixels(CameraSpec(160, 120, hfov, distortion=lens))
    assert (column >= 0).all() and (column <= 159).all() and (row >= 0).all() and (row <= 119).all()
    f = 80 / math.tan(hfov / 2)
    middle = (160 * lens.center[0] - 0.5, 120 * lens.center[1] - 0.5)
    x, y = distort(lens, (column - middle[0]) / f, (row - middle[1]) / f)
    pixels_x, pixels_y = np.meshgrid(np.arange(160), np.arange(120))
    assert np.abs(x * f + middle[0] - pixels_x).max() < 1e-6
    assert np.abs(y * f + middle[1] - pixels_y).max() < 1e-6


def test_where_a_barrel_lens_folds_the_picture_only_its_inner_part_is_seen():
    lens = Distortion(-1.0)  # folds at 0.577, which it puts at 0.385; -1.19 would fall on 0.5, too
    column, row = source_pixels(CameraSpec(161, 121, 2.4, distortion=lens))
    f = 80.5 / math.tan(1.2)
    seen = np.hypot(*np.meshgrid(np.arange(161) - 80, np.arange(121) - 60)) / f
    assert np.array_equal(np.isfinite(column[np.abs(seen - 0.385) > 1 / f]),
                          seen[np.abs(seen - 0.385) > 1 / f] < 0.385)
    ideal = np.hypot(column - 80, row - 60)[np.isfinite(column)] / f
    assert ideal.max() < 0.6


def test_pictures_are_looked_up_between_pixels_and_black_outside():
    picture = np.array([[[0, 0, 0], [100, 0, 0]], [[50, 0, 0], [150, 0, 0]]], dtype=np.uint8)
    column, row = np.array([[0.5, 1.0, -0.1, np.inf]]), np.array([[0.5, 0.0, 0.0, 0.0]])
    assert sample_bilinear(picture, column, row)[0, :, 0].tolist() == [75, 100, 0, 0]
    depth = np.array([[1.0, 2.0], [3.0, 4.0]], dtype=np.float32)
    assert sample_nearest(depth, column + 0.1, row, math.inf)[0].tolist() == [
        2.0, 2.0, 1.0, math.inf]


def test_textures_come_from_files_small_enough_and_from_patterns(tmp_path):
    from PIL import Image

    path = str(tmp_path / "Large.PNG")
    Image.new("RGB", (3000, 1500), (10, 20, 30)).save(path)
    found = read_picture(str(tmp_path / "large.png"))  # in any letter case
    assert found.shape == (512, 1024, 4) and found[0, 0].tolist() == [10, 20, 30, 255]
    (tmp_path / "broken.png").write_bytes(b"no picture")
    assert read_picture(str(tmp_path / "broken.png")) is None
    assert read_picture(str(tmp_path / "none.png")) is None
    assert draw_pattern("bricks").shape == (256, 256, 4)
    assert draw_pattern("no such") is None


def test_transforms_are_the_matrices_by_columns():
    poses = np.random.default_rng(3).normal(size=(5, 7))
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1)[:, None]
    assert transforms(poses) == pytest.approx(matrices(poses)[:, :3].transpose(0, 2, 1), abs=1e-15)


def test_what_rays_have_met_comes_whole_between_processes_and_is_the_caller_s_own():
    sent = RayReturns(np.array([1.5, np.inf]), np.array([0.5, 0.0], np.float32),
                      np.array([3, -1], np.int32))
    came = pickle.loads(pickle.dumps(sent, protocol=pickle.HIGHEST_PROTOCOL))
    for name in ("ranges", "retro", "link_rows"):
        one, other = getattr(came, name), getattr(sent, name)
        assert one.dtype == other.dtype and one.tolist() == other.tolist() and one.flags.writeable


def world_of(*actors, roads=()):
    return World(actors=list(actors), roads=list(roads))


@pytest.fixture
def resolved(tmp_path):
    for name in ("man.dae", "run.dae", "run.bvh"):
        (tmp_path / name).write_text("")
    resolver = Resolver()

    def of(world):
        return scene.scenery(world, Materials(resolver, TextureFiles(resolver)), resolver)
    return of


def test_the_files_of_an_actor_are_found_beside_its_world(resolved, tmp_path):
    [man] = resolved(world_of(Actor("man", skin="man.dae", skin_scale=2.0,
                                    base_dir=str(tmp_path)))).figures
    assert man.skin == Mesh("man.dae", str(tmp_path / "man.dae"), (2.0, 2.0, 2.0))
    [lost, bare] = resolved(world_of(Actor("lost", skin="other.dae", base_dir=str(tmp_path)),
                                     Actor("bare"))).figures
    assert (lost.skin.uri, lost.skin.path) == ("other.dae", "") and bare.skin.uri == ""


@pytest.mark.parametrize(("files", "expected"), [
    (["run.dae", "man.dae"], ["run.dae", ""]), (["man.dae", "run.dae"], ["", "run.dae"]),
    (["man.dae"], [""]), (["run.bvh"], ["run.bvh"]), (["gone.dae"], [""]), ([], [])])
def test_limbs_move_by_animations_of_other_files_or_the_skin_s_own(
        resolved, tmp_path, files, expected):
    [man] = resolved(world_of(Actor("man", skin="man.dae", base_dir=str(tmp_path), animations=[
        Animation("a", file) for file in files]))).figures
    assert man.animations == tuple(str(tmp_path / one) if one else "" for one in expected)


def test_a_road_is_asphalt_unless_it_says_otherwise(resolved):
    green = Material(diffuse=(0.0, 1.0, 0.0, 1.0))
    plain, painted = resolved(world_of(roads=[Road("a"), Road("b", material=green)])).roads
    assert plain.look == Look(pattern="road") and painted.look.diffuse == (0.0, 1.0, 0.0, 1.0)
