"""Terrains, map images and polylines as meshes."""
import math
import random
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from my_simulations.description.shapes import Heightmap, ImageMap, Polyline
from my_simulations.errors import InputError
from my_simulations.formats.image.levels import grey_levels, read_elevations
from my_simulations.formats.mesh.terrain import solid_mesh

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
HOLE = [(1, 1), (1, 2), (2, 2), (2, 1)]


def volume(mesh):
    """Signed volume inside a closed surface; right only where every face looks outwards."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def image_of(tmp_path, rows, name="image.png"):
    path = tmp_path / name
    Image.fromarray(np.array(rows, dtype=np.uint8)).save(path)
    return str(path)


def is_closed(mesh):
    edges = {}
    for a, b, c in mesh.triangles.tolist():
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] = edges.get(edge, 0) + 1
    return all(count == 1 and (b, a) in edges for (a, b), count in edges.items())


@pytest.mark.parametrize("loops, area", [
    ([SQUARE], 16), ([SQUARE[::-1]], 16), ([SQUARE, HOLE], 15), ([SQUARE, HOLE[::-1]], 15),
    ([SQUARE, HOLE, [(3, 3), (3.5, 3), (3.5, 3.5)]], 15 - 0.125),
    ([[(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)]], 10),
    ([[(0, 0), (2, 0), (4, 0), (4, 4), (0, 4)]], 16),
    ([SQUARE, *[[(x + .2, y + .2), (x + .6, y + .2), (x + .4, y + .7)]
                for x in range(4) for y in range(4)]], 16 - 16 * 0.1),
])
def test_a_polyline_becomes_a_closed_body_of_the_right_volume(loops, area):
    mesh = solid_mesh(Polyline(loops, 2.0))
    assert volume(mesh) == pytest.approx(2 * area)
    assert mesh.vertices[:, 2].min() == 0 and mesh.vertices[:, 2].max() == 2
    assert sum(volume(part) for part in mesh.parts) == pytest.approx(2 * area)


def test_a_polyline_with_a_hole_is_watertight():
    assert is_closed(solid_mesh(Polyline([SQUARE, HOLE], 1.0)))


def test_the_pieces_of_a_polyline_are_convex_and_few():
    star = [(math.cos(k * math.pi / 8) * (1 + k % 2), math.sin(k * math.pi / 8) * (1 + k % 2))
            for k in range(16)]
    parts = solid_mesh(Polyline([star], 1.0)).parts
    assert 8 <= len(parts) + 1 <= 14
    for part in parts:
        a, b, c = (part.vertices[part.triangles[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        assert ((part.vertices[None] - a[:, None]) @ normals[..., None]).max() < 1e-9


def test_a_convex_polyline_is_one_piece():
    circle = [(math.cos(k / 5), math.sin(k / 5)) for k in range(31)]
    assert len(solid_mesh(Polyline([circle], 1.0)).parts) == 1


def test_a_loop_that_crosses_itself_ends():
    draw = random.Random(7)
    tangle = [(draw.random(), draw.random()) for _ in range(60)]
    assert len(solid_mesh(Polyline([tangle], 1.0)).triangles)


@pytest.mark.parametrize("loop, code", [
    ([(0, 0), (1, 1), (2, 2)], "solid-empty"), ([(0, 0), (0, 0), (0, 0)], "solid-empty"),
    ([(math.cos(k), k) for k in range(5000)], "solid-complex"),
])
def test_a_polyline_that_is_no_body_is_refused(loop, code):
    with pytest.raises(InputError) as refused:
        solid_mesh(Polyline([loop], 1.0))
    assert [issue.code for issue in refused.value.issues] == [code]


def test_a_terrain_has_black_at_the_bottom_and_the_top_row_at_plus_y(tmp_path):
    path = image_of(tmp_path, [[255, 0, 0], [0, 0, 0], [0, 0, 51]])
    mesh = solid_mesh(Heightmap(path, path, (4, 6, 10), (1, 2, 3), 1))
    at = {(x, y): z for x, y, z in mesh.vertices.tolist()}
    assert at[-1, 5] == pytest.approx(13) and at[3, -1] == pytest.approx(5)
    assert sum(z == 3 for z in at.values()) == 7
    assert len(mesh.triangles) == 8 and mesh.parts is None
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_a_negative_height_turns_a_terrain_round(tmp_path):
    path = image_of(tmp_path, [[255, 0], [255, 255]])
    mesh = solid_mesh(Heightmap(path, path, (1, 1, -2), (0, 0, 0), 1))
    assert sorted(mesh.vertices[:, 2].tolist()) == [0, 0, 0, 2]


@pytest.mark.parametrize("side, sampling, vertices", [
    (5, 1, 5), (5, 2, 9), (5, 4, 17), (129, 4, 513), (513, 2, 513), (2049, 1, 1025),
])
def test_sampling_puts_points_in_between_up_to_a_bound(tmp_path, side, sampling, vertices):
    path = image_of(tmp_path, np.zeros((side, side)))
    mesh = solid_mesh(Heightmap(path, path, (1, 1, 1), (0, 0, 0), sampling))
    assert len(mesh.vertices) == vertices ** 2


def test_points_in_between_lie_on_straight_lines(tmp_path):
    path = image_of(tmp_path, [[0, 255], [0, 255]])
    mesh = solid_mesh(Heightmap(path, path, (4, 4, 4), (0, 0, 0), 4))
    assert np.allclose(mesh.vertices[:, 2], mesh.vertices[:, 0] + 2)


def test_dark_pixels_of_a_map_stand_as_merged_boxes(tmp_path):
    path = image_of(tmp_path, [[0, 0, 255], [0, 0, 255], [255, 255, 0]])
    mesh = solid_mesh(ImageMap(path, path, 0.5, 200, 3.0, 1))
    assert len(mesh.parts) == 2
    assert volume(mesh) == pytest.approx(5 * 0.25 * 3)
    low, high = mesh.parts[0].vertices.min(axis=0), mesh.parts[0].vertices.max(axis=0)
    assert low.tolist() == [-0.75, -0.25, 0] and high.tolist() == [0.25, 0.75, 3]


def test_granularity_makes_larger_boxes(tmp_path):
    path = image_of(tmp_path, np.zeros((4, 6)))
    mesh = solid_mesh(ImageMap(path, path, 0.1, 200, 1.0, 2))
    assert len(mesh.parts) == 1 and volume(mesh) == pytest.approx(0.24)


@pytest.mark.parametrize("content, code", [
    (None, "image-not-found"), (b"not an image", "image-unreadable"),
    (b"\x89PNG\r\n\x1a\n" + bytes(40), "image-unreadable"),
])
def test_an_image_that_cannot_be_read_is_refused(tmp_path, content, code):
    path = tmp_path / "x.png"
    if content is not None:
        path.write_bytes(content)
    for solid in (Heightmap("x.png", str(path)), ImageMap("x.png", str(path))):
        with pytest.raises(InputError) as refused:
            solid_mesh(solid)
        assert [issue.code for issue in refused.value.issues] == [code]


def test_a_white_map_and_a_chequered_one_are_refused(tmp_path):
    white = image_of(tmp_path, np.full((3, 3), 255), "white.png")
    chequers = image_of(tmp_path, np.indices((300, 300)).sum(axis=0) % 2 * 255, "chequers.png")
    found = []
    for path in (white, chequers):
        with pytest.raises(InputError) as refused:
            solid_mesh(ImageMap(path, path))
        found.append(refused.value.issues[0].code)
    assert found == ["solid-empty", "solid-complex"]


def test_16_bit_images_keep_their_levels(tmp_path):
    path = tmp_path / "deep.png"
    Image.fromarray(np.array([[0, 65535], [32768, 0]], dtype=np.uint16)).save(path)
    mesh = solid_mesh(Heightmap("deep.png", str(path), (1, 1, 1), (0, 0, 0), 1))
    assert sorted(mesh.vertices[:, 2].tolist()) == pytest.approx([0, 0, 32768 / 65535, 1])


def elevation_model(tmp_path, heights, geographic=False, no_data=None, dtype=np.float32):
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags.tagtype.update({33550: 12, 33922: 12, 34735: 3, 42113: 2})
    tags[33550] = (0.5, 0.25, 0.0) if not geographic else (0.001, 0.001, 0.0)
    tags[33922] = (0.0, 0.0, 0.0, 10.0, 60.0, 0.0)
    tags[34735] = (1, 1, 0, 1, 1024, 0, 1, 2 if geographic else 1)
    if no_data is not None:
        tags[42113] = str(no_data)
    path = tmp_path / "dem.tif"
    Image.fromarray(np.array(heights, dtype=dtype)).save(path, tiffinfo=tags)
    return str(path)


@pytest.mark.parametrize("size, bottom, top", [
    ((4, 4, 10), -20.0, -10.0), ((4, 4, 1), -20.0, -19.0), ((4, 4, -10), 10.0, 20.0),
])
def test_the_lowest_point_of_an_elevation_model_lies_at_its_height_and_size_scales_the_rest(
        tmp_path, size, bottom, top):
    path = elevation_model(tmp_path, [[-20, 30], [5, 5]])
    mesh = solid_mesh(Heightmap(path, path, size, (0, 0, 3), 1))
    heights = mesh.vertices[:, 2] - 3
    assert (heights.min(), heights.max()) == pytest.approx((bottom, top))
    north_west = mesh.vertices[(mesh.vertices[:, 0] < 0) & (mesh.vertices[:, 1] > 0)][0]
    assert north_west[2] - 3 == pytest.approx(bottom if size[2] > 0 else top)


@pytest.mark.parametrize("geographic, extent", [
    (False, (1.5, 0.5)), (True, (0.003 * 111194.93 * math.cos(math.radians(60)), 0.002 * 111194.93))
])
def test_without_a_size_an_elevation_model_is_as_large_as_the_land(tmp_path, geographic, extent):
    path = elevation_model(tmp_path, [[100, 200, 300], [150, 150, 150]], geographic)
    mesh = solid_mesh(Heightmap(path, path))
    spread = mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)
    assert spread[:2] == pytest.approx(extent, rel=1e-6)
    assert (mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()) == (100, 300)


@pytest.mark.parametrize("no_data", [-9999, "nan"])
def test_pixels_without_a_height_are_as_low_as_the_lowest(tmp_path, no_data):
    path = elevation_model(tmp_path, [[float(no_data), 8], [2, 5]], no_data=no_data)
    mesh = solid_mesh(Heightmap(path, path))
    assert sorted(set(mesh.vertices[:, 2].tolist()))[0] == 2


def test_an_elevation_model_of_whole_numbers_is_read_in_metres(tmp_path):
    path = elevation_model(tmp_path, [[10, 20], [30, 1040]], dtype=np.uint16)
    mesh = solid_mesh(Heightmap(path, path))
    assert (mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()) == (10, 1040)


def test_an_elevation_model_without_any_height_is_refused(tmp_path):
    path = elevation_model(tmp_path, [[7, 7], [7, 7]], no_data=7)
    with pytest.raises(InputError, match="holds no height"):
        solid_mesh(Heightmap(path, path))


@pytest.mark.parametrize("mode", ["L", "RGB", "I;16"])
def test_an_image_is_thinned_as_a_whole_however_it_is_read(tmp_path, mode):
    generator = np.random.default_rng(1)
    depth = {"L": (1000, 901), "RGB": (1000, 901, 3), "I;16": (1000, 901)}[mode]
    data = generator.integers(0, 65536 if mode == "I;16" else 256, depth,
                           dtype=np.uint16 if mode == "I;16" else np.uint8)
    path = tmp_path / "a.png"
    Image.fromarray(data).save(path)
    grey = data.max(axis=-1) if mode == "RGB" else data
    for widest, step in ((101, 10), (300, 4), (2000, 1)):
        assert np.array_equal(grey_levels(str(path), widest).values, grey[::step, ::step])
    for step in (1, 7, 300, 2000):
        assert np.array_equal(grey_levels(str(path), step=step).values, grey[::-step, ::step][::-1])


def test_an_elevation_model_keeps_its_extremes_when_it_is_thinned(tmp_path):
    heights = np.zeros((700, 900), dtype=np.float32)
    heights[333, 7], heights[1, 1], heights[650, 3] = -5.0, 9.0, np.nan
    path = tmp_path / "a.tif"
    Image.fromarray(heights).save(path)
    found = read_elevations(str(path), 101)
    assert (found.lowest, found.highest, found.shape) == (-5.0, 9.0, (700, 900))
    assert found.heights.shape == (78, 100) and np.isfinite(found.heights).all()


MEMORY = """
import sys
from my_simulations.description.shapes import Heightmap, ImageMap
from my_simulations.formats.image.levels import grey_levels, read_elevations
from my_simulations.formats.mesh.terrain import solid_mesh
for kind in (Heightmap, ImageMap):
    shape = kind()
    shape.uri = shape.path = sys.argv[1]
    solid_mesh(shape)
# Not ru_maxrss: that begins with what the process had that started this one.
with open("/proc/self/status") as status:
    print(next(int(line.split()[1]) >> 10 for line in status if line.startswith("VmHWM")))
"""


def test_a_small_file_of_many_pixels_costs_no_more_than_its_decoding(tmp_path):
    path = tmp_path / "a.png"
    Image.new("RGB", (8192, 8192)).save(path, compress_level=1)
    assert path.stat().st_size < 2_000_000
    done = subprocess.run([sys.executable, "-c", MEMORY, str(path)], capture_output=True,
                          text=True, check=True)
    # Pillow holds four bytes a pixel, which are 256 MB.
    assert int(done.stdout) < 600, done.stdout
