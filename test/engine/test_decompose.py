"""Convex parts of meshes: which there are, what happens to meshes without volume, the cache."""
from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from my_simulations.description.shapes import MeshData
from my_simulations.engine.convex import batch, decomposition
from my_simulations.engine.convex.cache import (
    Decomposition,
    PartsCache,
    content_key,
    default_folder,
    load,
    save,
)
from my_simulations.engine.convex.decomposition import decomposition_issues
from my_simulations.engine.convex.hulls import (
    full_hull,
    hull_of,
    is_convex,
    is_flat,
    moved_onto_hull,
    stretch_parts,
    thicken_points,
)


def mesh_of(solid):
    return MeshData(np.array(solid.vertices, dtype=np.float64),
                    np.array(solid.faces, dtype=np.int32))


def box(size=(1.0, 1.0, 1.0), at=(0.0, 0.0, 0.0)):
    made = trimesh.creation.box(size)
    made.apply_translation(at)
    return made


def decompose(mesh, **limits):
    with decomposition.MeshDecomposer(**limits) as decomposer:
        return decomposer.decompose(mesh)


def angle():
    """An L, 2 m by 3 m, 1 m thick and deep, from the origin."""
    outline = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
    vertices = np.concatenate([np.c_[outline, np.zeros(6)], np.c_[outline, np.ones(6)]])
    fan = [(0, k, k + 1) for k in range(1, 5)]
    faces = [(a, c, b) for a, b, c in fan] + [(a + 6, b + 6, c + 6) for a, b, c in fan]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(i, j, j + 6), (i, j + 6, i + 6)]
    return MeshData(vertices, np.array(faces, dtype=np.int32))


def bounds(parts):
    points = np.concatenate([part.vertices for part in parts])
    return points.min(axis=0).tolist(), points.max(axis=0).tolist()


def volume(parts):
    return sum(float(trimesh.Trimesh(p.vertices, p.triangles).volume) for p in parts)


def holds(part, point):
    solid = trimesh.Trimesh(part.vertices, part.triangles, process=False)
    return bool((np.einsum("ij,ij->i", solid.face_normals,
                           np.asarray(point) - solid.triangles[:, 0]) < 0).all())


def divided(mesh, folder):
    told = []
    (made,) = batch.decompose_all([("m::l", mesh)], told.append, cache_dir=str(folder))
    return made.parts, [issue.code for issue in decomposition_issues(made)], told


def test_a_convex_mesh_is_its_own_hull(tmp_path):
    parts, codes, told = divided(mesh_of(box((1, 2, 3))), tmp_path)
    assert [len(p.vertices) for p in parts] == [8] and codes == []
    assert bounds(parts) == (pytest.approx([-0.5, -1, -1.5]), pytest.approx([0.5, 1, 1.5]))
    assert parts[0].triangles.dtype == np.int32
    assert told == [] and os.listdir(tmp_path) == []  # no process, nothing to wait for


def test_triangles_without_area_and_corners_of_their_own_do_not_make_a_mesh_concave(tmp_path):
    soup = box()
    vertices = np.concatenate([soup.triangles.reshape(-1, 3), [[0.5, 0.5, 0.5]] * 3])
    faces = np.arange(len(vertices), dtype=np.int32).reshape(-1, 3)
    assert [len(p.vertices) for p in divided(MeshData(vertices, faces), tmp_path)[0]] == [8]


def test_a_mesh_that_is_inside_out_gives_parts_that_are_not(tmp_path):
    mesh = mesh_of(box())
    parts, _, _ = divided(MeshData(mesh.vertices, mesh.triangles[:, ::-1]), tmp_path)
    assert volume(parts) == pytest.approx(1.0)


def test_a_large_hull_keeps_its_bounding_box_with_few_corners(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=4, radius=2.0)
    parts, codes, _ = divided(mesh_of(ball), tmp_path)
    assert len(parts) == 1 and len(parts[0].vertices) <= 256 and codes == []
    assert bounds(parts) == (pytest.approx([-2] * 3), pytest.approx([2] * 3))
    assert volume(parts) > 0.97 * ball.volume


def test_a_wheel_of_128_sides_keeps_all_corners_of_both_rims(tmp_path):
    wheel = trimesh.creation.cylinder(0.1, 0.05, sections=128)
    parts, _, _ = divided(mesh_of(wheel), tmp_path)
    assert len(parts) == 1 and len(parts[0].vertices) == 256
    assert volume(parts) == pytest.approx(wheel.volume)


def test_a_reduced_tyre_keeps_its_tread_before_its_shoulders(tmp_path):
    """A rounded rim of 1200 corners, of which no place may be lower than 1 % of the radius."""
    turns = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    rings = [np.stack([(0.9 + 0.1 * np.cos(bend)) * np.cos(turns),
                       (0.9 + 0.1 * np.cos(bend)) * np.sin(turns),
                       np.full(100, 0.1 * np.sin(bend))], 1) for bend in np.linspace(-1.5, 1.5, 12)]
    solid = full_hull(np.concatenate(rings))
    (part,), _, _ = divided(MeshData(solid.vertices, solid.faces), tmp_path)
    planes = full_hull(part.vertices).planes
    beyond = (solid.vertices @ planes[:, :3].T + planes[:, 3]).max()
    assert len(part.vertices) == 256 and beyond < 0.01


def test_several_convex_pieces_share_their_corners(tmp_path):
    balls = [trimesh.creation.icosphere(subdivisions=3, radius=1.0) for _ in range(3)]
    for n, one in enumerate(balls):
        one.apply_translation((3.0 * n, 0.0, 0.0))
    parts, _, _ = divided(mesh_of(trimesh.util.concatenate(balls)), tmp_path)
    assert [len(part.vertices) for part in parts] == [85, 85, 85]


def test_separate_convex_pieces_are_kept_exactly(tmp_path):
    table = trimesh.util.concatenate([box((2, 1, 0.1), (0, 0, 1)), box((0.1, 0.1, 0.9))])
    parts, codes, _ = divided(mesh_of(table), tmp_path)
    assert [len(p.vertices) for p in parts] == [8, 8] and codes == []
    assert volume(parts) == pytest.approx(2 * 0.1 + 0.009)


def test_what_is_closed_is_solid_and_its_inner_side_is_no_part(tmp_path):
    outer, inner = box((1, 1, 1)), box((0.9, 0.9, 0.9))
    inner.invert()
    parts, codes, _ = divided(mesh_of(trimesh.util.concatenate([inner, outer])), tmp_path)
    assert [len(p.vertices) for p in parts] == [8] and codes == []
    assert volume(parts) == pytest.approx(1.0)


def test_a_concave_mesh_is_divided_and_its_notch_stays_free(tmp_path):
    parts, codes, told = divided(angle(), tmp_path)
    assert len(parts) > 1 and codes == []
    assert bounds(parts) == (pytest.approx([0, 0, 0], abs=1e-6), pytest.approx([2, 3, 1], abs=1e-6))
    assert all(is_convex(trimesh.Trimesh(p.vertices, p.triangles)) for p in parts)
    assert volume(parts) == pytest.approx(4.0, rel=0.1)
    assert not any(holds(part, (1.5, 2.0, 0.5)) for part in parts)
    assert any(holds(part, (0.5, 2.0, 0.5)) for part in parts)
    assert any("mesh 1 of 1 (m::l): " in words and "convex parts in" in words for words in told)


def test_the_size_and_place_of_a_mesh_do_not_count(tmp_path):
    small = angle()
    small.vertices = small.vertices * 0.001 + (100.0, 0.0, 0.0)
    parts, _, _ = divided(small, tmp_path)
    assert len(parts) > 1 and volume(parts) == pytest.approx(4e-9, rel=0.1)
    assert bounds(parts) == (pytest.approx([100, 0, 0], abs=1e-8),
                             pytest.approx([100.002, 0.003, 0.001], abs=1e-8))


def test_a_box_whose_corners_lie_a_hair_apart_is_convex_and_one_without_a_lid_is_not():
    soup = box()
    apart = soup.triangles.reshape(-1, 3) + np.tile([[0.0], [1e-6], [-1e-6]], (12, 3))
    torn = trimesh.Trimesh(apart, np.arange(36).reshape(-1, 3), process=False)
    assert not torn.is_watertight and is_convex(torn)
    open_box = trimesh.Trimesh(soup.vertices, soup.faces[soup.face_normals[:, 2] < 0.5])
    assert not is_convex(open_box)


def test_a_wall_inside_a_solid_does_not_make_it_concave():
    walled = box()
    corners = [(0.0, y, z) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    mesh = trimesh.Trimesh(np.concatenate([walled.vertices, corners]),
                           np.concatenate([walled.faces, [(8, 9, 11), (8, 11, 10)]]), process=False)
    assert not mesh.is_watertight and is_convex(mesh)


@pytest.mark.parametrize("edge, expected", [(0.1, True), (0.3, False)])
def test_a_notch_counts_by_its_share_of_the_volume(edge, expected):
    """A square hole of `edge` m through a cube of 1 m takes 1 % or 9 % of it."""
    outer = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    points = [(x, y, z) for z in (-0.5, 0.5) for half in (1.0, edge) for x, y in
              [(half * p[0], half * p[1]) for p in outer]]
    faces = []
    for i in range(4):
        j = (i + 1) % 4
        for a, b, c, d in ((i, j, j + 8, i + 8), (j + 4, i + 4, i + 12, j + 12),
                           (i + 4, j + 4, j, i), (i + 8, j + 8, j + 12, i + 12)):
            faces += [(a, b, c), (a, c, d)]
    mesh = trimesh.Trimesh(points, faces, process=False)
    assert mesh.is_watertight and mesh.volume == pytest.approx(1 - edge**2)
    assert is_convex(mesh) is expected


def test_an_open_vessel_stays_hollow(tmp_path):
    closed = box()
    up = closed.face_normals[:, 2] > 0.5
    parts, _, _ = divided(MeshData(np.array(closed.vertices),
                                   np.array(closed.faces[~up], dtype=np.int32)), tmp_path)
    assert len(parts) > 1
    assert not any(holds(part, (0, 0, 0)) for part in parts)


@pytest.mark.parametrize("points, expected", [
    ([(0, 0, 0), (2, 0, 0), (0, 1, 0)], [2, 1, 0.01]),
    ([(0, 0, 0), (1, 0, 0), (3, 0, 0)], [3, 0.01, 0.01]),
    ([(7, 7, 7), (7, 7, 7), (7, 7, 7)], [0.001, 0.001, 0.001]),
    ([(0, 0, 0), (0.02, 0, 0), (0, 0.01, 0)], [0.02, 0.01, 0.001])])
def test_a_mesh_without_volume_is_made_thin_with_a_warning(tmp_path, points, expected):
    parts, codes, _ = divided(MeshData(np.array(points, float), np.array([[0, 1, 2]])), tmp_path)
    low, high = bounds(parts)
    assert np.subtract(high, low) == pytest.approx(np.array(expected), abs=1e-6)
    assert len(parts) == 1 and volume(parts) > 0 and codes == ["mesh-flat"]


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """A cache that has the parts of the L, and these parts."""
    folder = tmp_path_factory.mktemp("known")
    return folder, divided(angle(), folder)[0]


@pytest.fixture
def filled(known, tmp_path):
    """A cache of one's own with the parts of the L, and these parts."""
    folder, parts = known
    return Path(shutil.copytree(folder, tmp_path / "filled")), parts


def test_a_second_call_finds_the_parts_in_the_cache(filled):
    folder, first = filled
    again, _, told = divided(angle(), folder)
    assert told == []
    for one, other in zip(first, again):
        assert np.array_equal(one.vertices, other.vertices)
        assert np.array_equal(one.triangles, other.triangles)


def entry(folder):
    (name,) = os.listdir(folder)
    return folder / name


@pytest.mark.parametrize("damage", [
    lambda content: b"", lambda content: b"no archive", lambda content: content[:len(content) // 2],
    lambda content: content[:200] + bytes(100) + content[300:]])
def test_a_damaged_entry_of_the_cache_is_made_anew(filled, damage):
    folder, first = filled
    path = entry(folder)
    path.write_bytes(damage(path.read_bytes()))
    parts, _, told = divided(angle(), folder)
    assert len(parts) == len(first) and told != []
    assert len(load(str(entry(folder))).parts) == len(first)


@pytest.mark.parametrize("change", ["triangle", "vertex", "nothing"])
def test_parts_that_do_not_fit_each_other_are_not_taken_from_a_file(tmp_path, change):
    part = mesh_of(box())
    if change == "triangle":
        part.triangles[0, 0] = 99
    elif change == "vertex":
        part.vertices[0, 0] = np.nan
    else:
        part.triangles = part.triangles[:0]
    save(str(tmp_path / "a.parts"), Decomposition([part]))
    with pytest.raises(ValueError):
        load(str(tmp_path / "a.parts"))


def test_the_cache_gives_up_what_was_longest_unused(tmp_path):
    made = Decomposition([mesh_of(box())])
    PartsCache(str(tmp_path)).put("a", made)
    size = (tmp_path / "a.parts").stat().st_size
    PartsCache(str(tmp_path)).put("b", made)
    for age, name in ((30, "a"), (20, "b")):
        os.utime(tmp_path / f"{name}.parts", (1e9 - age, 1e9 - age))
    cache = PartsCache(str(tmp_path), limit=int(2.5 * size))
    assert cache.get("a") is not None  # used now, so that b is the older one
    cache.put("c", made)
    assert sorted(os.listdir(tmp_path)) == ["a.parts", "c.parts"]
    PartsCache(str(tmp_path), limit=1).put("d", made)
    assert os.listdir(tmp_path) == ["d.parts"]


def test_an_entry_that_belongs_to_somebody_else_is_used(filled, monkeypatch):
    """As in a cache on a read-only disk, or one that root has made."""
    folder, first = filled

    def refuse(path, *times):
        raise PermissionError(13, "Permission denied", path)

    monkeypatch.setattr(os, "utime", refuse)
    parts, _, told = divided(angle(), folder)
    assert told == []
    assert [part.vertices.tolist() for part in parts] == [p.vertices.tolist() for p in first]


def test_what_an_interrupted_writer_left_is_removed_in_time(tmp_path):
    for name, at in (("old.new", 1e9), ("new.new", None)):
        (tmp_path / name).write_bytes(b"")
        os.utime(tmp_path / name, at and (at, at))
    PartsCache(str(tmp_path)).put("a", Decomposition([mesh_of(box())]))
    assert sorted(os.listdir(tmp_path)) == ["a.parts", "new.new"]


def test_a_cache_that_cannot_be_written_costs_the_caching_only(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_bytes(b"")
    parts, codes, _ = divided(angle(), blocked)
    assert len(parts) > 1 and codes == []


def test_the_key_tells_content_and_parameters_apart():
    mesh = mesh_of(box())
    moved = MeshData(mesh.vertices + 1.0, mesh.triangles)
    turned = MeshData(mesh.vertices, mesh.triangles[:, ::-1])
    keys = {content_key(mesh, "a"), content_key(moved, "a"), content_key(turned, "a"),
            content_key(mesh, "b")}
    assert len(keys) == 4
    assert content_key(MeshData(mesh.vertices.copy(order="F"), mesh.triangles.astype(np.int64)),
                       "a") in keys


def test_the_cache_lies_where_the_user_keeps_caches(monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert default_folder() == "/somewhere/my_simulations/decompositions"
    monkeypatch.setenv("HOME", "/home/someone")
    for value in ("", "not/absolute"):
        monkeypatch.setenv("XDG_CACHE_HOME", value)
        assert default_folder() == "/home/someone/.cache/my_simulations/decompositions"


def with_vhacd(monkeypatch, folder, body):
    """Let the child find another `pybullet`, whose vhacd does what is told."""
    folder.mkdir()
    (folder / "pybullet.py").write_text(f"import os, time\n\n\ndef vhacd(*a, **k):\n    {body}\n")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), *filter(None, sys.path)]))


@pytest.mark.parametrize("body", ["os.abort()", "raise ValueError", "open(a[1], 'w').close()"])
def test_a_crash_leaves_the_hull_and_a_warning(tmp_path, monkeypatch, body):
    with_vhacd(monkeypatch, tmp_path / "fake", body)
    parts, codes, told = divided(angle(), tmp_path / "cache")
    assert codes == ["mesh-not-decomposed"] and volume(parts) == pytest.approx(5.0)
    assert any("hull" in words for words in told)
    parts, codes, told = divided(angle(), tmp_path / "cache")  # it would crash again
    assert codes == ["mesh-not-decomposed"] and told == []


def test_work_that_stands_still_is_ended_and_not_kept(tmp_path, monkeypatch):
    with_vhacd(monkeypatch, tmp_path / "fake", "time.sleep(600)")
    made = decompose(angle(), cache_dir=str(tmp_path / "cache"), deadline=3.0)
    assert len(made.parts) == 1
    assert [one.code for one in decomposition_issues(made)] == ["mesh-not-decomposed"]
    assert not (tmp_path / "cache").exists()


def test_a_mesh_that_takes_too_much_processor_time_keeps_its_hull_at_once_the_next_time(
        tmp_path, monkeypatch):
    with_vhacd(monkeypatch, tmp_path / "fake", "[None for _ in iter(int, 1)]")
    folder = str(tmp_path / "cache")
    for made in (decompose(angle(), cache_dir=folder, cpu_seconds=2),
                 decomposition.ready_parts(angle(), cache_dir=folder)):
        assert len(made.parts) == 1
        assert [one.code for one in decomposition_issues(made)] == ["mesh-not-decomposed"]


def arrays(made):
    return [(part.vertices.tolist(), part.triangles.tolist()) for part in made.parts]


def test_a_worker_divides_one_mesh_after_the_other_and_none_depends_on_those_before(tmp_path):
    wide = MeshData(angle().vertices * (1.0, 1.0, 2.0), angle().triangles)
    with decomposition.MeshDecomposer(cache_dir=str(tmp_path / "one")) as divider:
        for mesh in (wide, angle()):
            last = divider.decompose(mesh)
    alone = decompose(angle(), cache_dir=str(tmp_path / "other"))
    assert len(last.parts) > 1 and arrays(last) == arrays(alone)


def test_a_mesh_that_ends_a_worker_leaves_the_next_one_as_it_would_be_alone(tmp_path, monkeypatch):
    """The fake V-HACD writes two tetrahedra, and crashes for the first mesh."""
    marks = str(tmp_path / "marks")
    with_vhacd(monkeypatch, tmp_path / "fake",
               f"open({marks!r}, 'a').write('.'); os.path.getsize({marks!r}) < 2 and os.abort(); "
               "open(a[1], 'w').write(''.join(f'o {n}\\nv {n} 0 0\\nv {n} 1 0\\nv {n} 0 1\\n"
               "v {n + 1} 0 0\\n' for n in range(2)))")
    with decomposition.MeshDecomposer(cache_dir=str(tmp_path / "cache")) as divider:
        first, second = divider.decompose(angle()), divider.decompose(angle())
    assert [one.code for one in decomposition_issues(first)] == ["mesh-not-decomposed"]
    assert len(second.parts) == 2 and decomposition_issues(second) == []


def test_a_thin_plate_gets_no_finer_voxels_than_a_block(tmp_path, monkeypatch):
    """V-HACD lays 64 voxels along the shortest edge of its vertices' bounding box."""
    seen = str(tmp_path / "seen.obj")
    with_vhacd(monkeypatch, tmp_path / "fake",
               f"import shutil; shutil.copy(a[0], {seen!r}); os.abort()")
    plate = MeshData(angle().vertices * (1.0, 1.0, 0.01), angle().triangles)
    decompose(plate, cache_dir=str(tmp_path / "cache"))
    lines = Path(seen).read_text().splitlines()
    points = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    used = {int(n) for line in lines if line.startswith("f ") for n in line.split()[1:]}
    assert len(points) == 14 and used == set(range(1, 13))
    assert np.ptp(points[:12], axis=0) == pytest.approx([2 / 3, 1.0, 0.01 / 3], abs=1e-6)
    assert np.ptp(points, axis=0) == pytest.approx([2 / 3, 1.0, 0.5], abs=1e-6)


def test_a_mesh_of_one_part_becomes_its_hull_and_not_that_of_its_voxels(tmp_path, monkeypatch):
    with_vhacd(monkeypatch, tmp_path / "fake",
               "open(a[1], 'w').write('o a\\nv 0 0 0\\nv 0.1 0 0\\nv 0 0.1 0\\nv 0 0 0.1\\n')")
    parts, codes, _ = divided(angle(), tmp_path / "cache")
    assert len(parts) == 1 and volume(parts) == pytest.approx(5.0) and codes == []


def test_several_meshes_are_divided_two_at_a_time_with_a_word_for_each(tmp_path, monkeypatch):
    marks = tmp_path / "marks"
    marks.mkdir()
    # Each ends when another one has begun and a progress message has come: one at a time they
    # would never end.
    with_vhacd(monkeypatch, tmp_path / "fake",
               f"open(os.path.join({str(marks)!r}, str(os.getpid())), 'w').close(); "
               f"[time.sleep(0.01) for _ in iter(lambda: len(os.listdir({str(marks)!r})) > 2, 1)];"
               " os.abort()")
    monkeypatch.setattr(batch, "PROGRESS_EVERY_S", 0.2)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    second = MeshData(angle().vertices * 2.0, angle().triangles)
    told = []

    def hear(words):
        told.append(words)
        if "0 of 2 meshes divided after" in words:
            (marks / "progress").touch()

    meshes = [("a::l", angle()), ("b::l", mesh_of(box())), ("c::l", second), ("d::l", angle())]
    made = batch.decompose_all(meshes, hear, cache_dir=str(tmp_path / "cache"))
    assert [volume(one.parts) for one in made] == pytest.approx([5.0, 1.0, 40.0, 5.0])
    assert "2 meshes are divided" in told[0] and str(tmp_path / "cache") in told[0]
    assert any(words.startswith("dividing mesh 1 of 2 (a::l), 20 triangles") for words in told)
    assert any("0 of 2 meshes divided after" in words and "at work: mesh 1 of 2" in words
               for words in told)
    assert "ready after" in told[-1]


def test_the_parts_are_the_same_whether_they_were_known_before_or_not(filled, tmp_path):
    folder, cold = filled
    again, _, _ = divided(angle(), tmp_path / "b")
    warm, _, _ = divided(angle(), folder)
    for other in (again, warm):
        assert [part.vertices.tolist() for part in other] == [p.vertices.tolist() for p in cold]


def test_a_child_that_cannot_be_started_leaves_the_mesh_as_it_is(tmp_path, monkeypatch):
    for program in ("/bin/false", "/nowhere/python"):
        monkeypatch.setattr(sys, "executable", program)
        mesh = angle()
        parts, codes, _ = divided(mesh, tmp_path)
        assert parts == [mesh] and codes == ["mesh-not-decomposed"]


def test_flat_is_what_has_next_to_no_thickness():
    assert is_flat(np.array([(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 1, 0)], float))
    assert not is_flat(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0.01)], float))


def test_thickening_leaves_what_is_thick_enough():
    made = thicken_points(box((2.0, 1.0, 0.001)).vertices, 0.1)
    assert np.ptp(made.vertices, axis=0) == pytest.approx([2.0, 1.0, 0.1])


def test_points_are_drawn_in_to_a_hull_and_those_inside_stay():
    points = np.array([(0.2, 0.1, 0.0), (0.6, 0.0, 0.0), (0.9, 0.9, -0.8)])
    moved = moved_onto_hull(points, hull_of(box().vertices))
    assert moved == pytest.approx(np.array([(0.2, 0.1, 0.0), (0.5, 0.0, 0.0), (0.5, 0.5, -0.5)]))


def test_faces_of_a_hull_look_outward_and_it_knows_its_volume():
    points = np.random.default_rng(1).normal(size=(200, 3))
    hull = full_hull(np.concatenate([points, points]))
    solid = trimesh.Trimesh(hull.vertices, hull.faces, process=False)
    assert solid.is_watertight and solid.volume == pytest.approx(hull.volume)
    assert solid.volume == pytest.approx(trimesh.convex.convex_hull(points).volume)


def test_parts_are_stretched_to_the_reach_of_the_mesh_but_not_over_what_is_missing():
    reach = np.array([(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)])
    parts = [np.array([(0.01, 0.0, 0.0), (0.5, 1.0, 0.5)]),
             np.array([(0.5, 0.0, 0.4), (0.99, 1.0, 0.6)])]
    one, other = stretch_parts(parts, reach)
    assert one[0] == pytest.approx([0.0, 0.0, 0.0]) and other[1] == pytest.approx([1.0, 1.0, 0.6])
    assert one[1] == pytest.approx([0.5, 1.0, 0.5])


def test_a_hull_of_points_next_to_flat_is_made_all_the_same():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 1e-17)])
    assert full_hull(points).volume < 1e-6


def test_a_thin_wall_is_stretched_by_as_much_as_a_voxel():
    reach = np.array([(0.0, 0.0, 0.0), (1.0, 1.0, 0.02)])
    (part,) = stretch_parts([np.array([(0.0, 0.0, 0.005), (1.0, 1.0, 0.01)])], reach)
    assert part[:, 2] == pytest.approx([0.0, 0.02])
