"""Mesh files that declare or make much more than they contain are refused by their first bytes."""
from __future__ import annotations

import struct
import tracemalloc

import numpy as np
import pytest

from my_simulations.description.shapes import Mesh
from my_simulations.errors import InputError
from my_simulations.formats.mesh import collada, loading
from my_simulations.formats.mesh.declared_size import LARGEST, check_declared_size
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.formats.mesh.obj import read_obj
from my_simulations.formats.mesh.part import MOST_TRIANGLES, MeshError
from my_simulations.formats.mesh.plain_text import numbered_lines
from my_simulations.formats.mesh.stl import read_stl

PLY = (b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\n"
       b"property float y\nproperty float z\nelement face %d\n"
       b"property list uchar int vertex_indices\nend_header\n")


def glb(text):
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 20 + len(text))
            + struct.pack("<I4s", len(text), b"JSON") + text)


HEADERS = {
    "declared.stl": (bytes(80) + struct.pack("<I", MOST_TRIANGLES + 1),
                     84 + 50 * (MOST_TRIANGLES + 1), "declares 10000001 triangles"),
    "short.stl": (bytes(80) + struct.pack("<I", 1000), 100 << 20, None),
    "large.obj": (b"v 0 0 0\n", LARGEST + (1 << 20), "has 601 MB; 600 MB are possible"),
    "vertices.ply": (PLY % (400_000_000, 1), 1 << 20, "400000000 elements 'vertex'"),
    "faces.ply": (PLY % (3, MOST_TRIANGLES + 1), 1 << 20, "10000001 elements 'face'"),
    "short.ply": (PLY % (5_000_000, 1), 1 << 20, "more than the file has bytes"),
    "long.glb": (struct.pack("<4sII", b"glTF", 2, 20) + struct.pack("<I4s", 1 << 30, b"JSON"),
                 1 << 20, "document of 1073741824 bytes"),
    "count.glb": (glb(b'{"accessors":[{"count":2000000000,"componentType":5126,"type":"VEC3"}]}'),
                  200, "more than 10000000 triangles"),
}


@pytest.mark.parametrize("name", [name for name in HEADERS if HEADERS[name][2]])
def test_a_file_is_refused_by_its_size_or_header_before_its_content_is_read(name, tmp_path,
                                                                           monkeypatch):
    def read(*_args, **_more):
        raise AssertionError("the content was read")

    monkeypatch.setattr(loading, "_parts", read)
    monkeypatch.setattr(loading, "read_elsewhere", read)
    head, size, message = HEADERS[name]
    path = tmp_path / name
    with open(path, "wb") as stream:
        stream.write(head)
        stream.truncate(size)
    with pytest.raises(InputError, match=message) as refused:
        load_mesh(Mesh(name, str(path)))
    assert refused.value.first.code == "mesh-unreadable"
    assert refused.value.first.file == str(path)


def test_a_binary_file_that_is_longer_than_its_triangles_is_read(tmp_path):
    check_declared_size(str(tmp_path / "none.obj"), 10)
    head, size, _ = HEADERS["short.stl"]
    path = tmp_path / "short.stl"
    with open(path, "wb") as stream:
        stream.write(head)
        stream.truncate(size)
    check_declared_size(str(path), size)


def test_a_face_with_more_corners_than_vertices_is_refused_with_its_line():
    few = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    for corners in (100, 1_000_000):
        with pytest.raises(MeshError, match="more corners than the 3 vertices") as refused:
            read_obj(few + b"f" + b" 1" * corners + b"\n")
        assert refused.value.line == 4
    assert len(read_obj(few + b"f 1 2 3 1 # " + b"x" * 10_000)[0].triangles) == 2


def test_a_large_face_takes_little_more_memory_than_its_triangles():
    count = 100_000
    data = b"v 0 0 0\n" * count + b"f" + b" 1" * count + b"\n"
    tracemalloc.start()
    try:
        (part,) = read_obj(data)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(part.triangles) == count - 2
    assert peak < 50 << 20  # 35 MB: vertices and triangles have 5 MB


def test_lines_that_go_on_in_others_keep_their_numbers():
    data = b"v 0 0 0\\\n\\\n\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\nf 1 2 9\n"
    with pytest.raises(MeshError, match="there is no vertex 9") as refused:
        read_obj(data)
    assert refused.value.line == 8


def test_empty_lines_are_counted_and_left_out():
    assert list(numbered_lines("a\n\n\nb\n")) == [(1, "a"), (4, "b")]
    assert list(numbered_lines("a\\\n\nb", continued=True)) == [(1, "a "), (3, "b")]


def test_parts_of_obj_come_in_the_order_of_their_first_faces():
    parts = read_obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng b\nf 1 2 3\ng a\nf 1 3 2\ng b\nf 2 3 1\n")
    assert [part.names for part in parts] == [("b",), ("a",)]
    assert parts[0].triangles.tolist() == [[0, 1, 2], [1, 2, 0]]


def test_corners_of_stl_at_one_place_are_one_vertex_in_order_of_their_numbers():
    corners = [[(1, 0, 0), (0, -0.0, 0), (0, 1, 0)], [(0, 1, 0), (0, 0, 0), (0, 0, 2)]]
    data = bytes(80) + struct.pack("<I", 2) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *[n for corner in triangle for n in corner], 0)
        for triangle in corners)
    (part,) = read_stl(data)
    assert part.vertices.tolist() == [[0, 0, 0], [0, 0, 2], [0, 1, 0], [1, 0, 0]]
    assert part.triangles.tolist() == [[3, 0, 2], [2, 0, 1]]
    assert part.vertices.dtype == np.float64


def nodes(count):
    return (b"<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
            b"<library_visual_scenes><visual_scene id='s'>" + b"<node id='a'/>" * count
            + b"</visual_scene></library_visual_scenes></COLLADA>")


def test_collada_of_many_empty_nodes_is_read_elsewhere_and_beyond_a_limit_not_at_all(tmp_path,
                                                                                    monkeypatch):
    monkeypatch.setattr(loading, "_parts", lambda path: pytest.fail("read in this process"))
    path = tmp_path / "nodes.dae"
    path.write_bytes(nodes(30_000))
    with pytest.raises(InputError, match="has no faces"):
        load_mesh(Mesh("nodes.dae", str(path)))
    monkeypatch.setattr(collada, "_parse_leniently",
                        lambda text: pytest.fail("read before it is refused"))
    path.write_bytes(nodes(150_000))
    with pytest.raises(InputError, match="more than 100000 nodes"):
        load_mesh(Mesh("nodes.dae", str(path)))
    with pytest.raises(MeshError, match="more than 100000 nodes"):
        collada.read_collada(nodes(60_000).replace(
            b"<node id='a'/>", b"<node><instance_geometry url='#a'/></node>"))


@pytest.mark.parametrize("scale, center", [(1.0, False), (1.0, True), (1e300, True)])
def test_coordinates_beyond_what_physics_can_use_are_refused(tmp_path, scale, center):
    far = "1e308" if scale == 1.0 else "1"
    path = tmp_path / "far.obj"
    path.write_text(f"o a\nv -{far} 0 0\nv {far} 0 0\nv 0 {far} 0\nv 0 0 {far}\n"
                    "f 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n")
    with pytest.raises(InputError, match="vertices beyond 1e.09 m") as refused:
        load_mesh(Mesh("far.obj", str(path), scale=(scale,) * 3, submesh="a", center=center))
    assert refused.value.first.code == "mesh-not-finite"
