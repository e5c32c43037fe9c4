"""Mesh files as exporters write them: entries without shape, and data that libraries ignore."""
import json
import os
import re
import struct
import subprocess
import sys

import numpy as np
import pytest
from reading import VALID

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Mesh, mesh_key
from my_simulations.errors import InputError
from my_simulations.formats.mesh import loading, part
from my_simulations.formats.mesh.loading import collision_meshes, load_mesh
from my_simulations.formats.mesh.part import MeshPart

CORNERS = [(0.0, 0.0, 0.0), (0.0254, 0.0, 0.0), (0.0, 0.0508, 0.0)]
DECLARATION = '<?xml version="1.0" encoding="utf-8"?>\n'
VERTEX = '<input semantic="VERTEX" source="#v" offset="0"/>'


def collada(*changes):
    """The text of a file with one triangle in inches, changed."""
    with open(os.path.join(VALID, "inch_y_up.dae")) as stream:
        text = stream.read()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


def written(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return Mesh(name, str(path))


def fault_of(mesh):
    with pytest.raises(InputError) as caught:
        load_mesh(mesh)
    return caught.value.first


def corners_of(data):
    return [tuple(round(x, 6) for x in row) for row in data.vertices[data.triangles[0]].tolist()]


NOT_SHAPE = {
    "an image that is not there":
        ("<library_geometries>", '<library_images><image id="i"><init_from>gone.png</init_from>'
         "</image></library_images><library_geometries>"),
    "an effect without a profile":
        ("<library_geometries>", '<library_effects><effect id="e"/></library_effects>'
         '<library_materials><material id="m"><instance_effect url="#e"/></material>'
         "</library_materials><library_geometries>"),
    "a material that is not there":
        ('url="#tri-geometry"/>', 'url="#tri-geometry"><bind_material><technique_common>'
         '<instance_material symbol="s" target="#gone"/></technique_common></bind_material>'
         "</instance_geometry>"),
    "a camera and a light that are not there":
        ('<node id="n">', '<node id="n"><instance_camera url="#c"/><instance_light url="#l"/>'),
    "a node of another file and one that is not there":
        ('<node id="n">', '<node id="n"><instance_node url="other.dae#n"/>'
         '<instance_node url="#gone"/><instance_geometry url="#gone"/>'),
    "a geometry without triangles":
        ('<node id="n">', '<node id="n"><instance_geometry url="#spline"/>'),
    "a transform that is not placed": ('<node id="n">', '<node id="n"><lookat>1 2</lookat>'),
    "lines": ("<triangles", f"<lines count=\"1\">{VERTEX}<p>0 1</p></lines><triangles"),
    "normals that are not there":
        ('offset="0"/><p>0 1 2', 'offset="0"/><input semantic="NORMAL" source="#gone" offset="1"/>'
         "<p>0 9 1 9 2 9"),
    "texture coordinates without numbers":
        ('offset="0"/><p>0 1 2', 'offset="0"/><input semantic="TEXCOORD" source="#uv" offset="2"/>'
         "<p>0 0 9 1 0 9 2 0 9"),
    "comments and instructions": ('<node id="n">', '<node id="n"><!-- a --><?b c?>'),
    "numbers of four": ('count="9">0 0 0  1 0 0  0 2 0', 'count="12">0 0 0 7 1 0 0 7 0 2 0 7'),
    "no namespace": (' xmlns="http://www.collada.org/2005/11/COLLADASchema"', ""),
    "a newer namespace": ("2005/11", "2008/03"),
    "a scene that is not there": ('visual_scene url="#s"', 'visual_scene url="#gone"'),
    "no extent of the vertices": ('offset="0"', ""),
    "an instance of a node without a target, where none may be":
        ("<library_visual_scenes>", "<library_visual_scenes><instance_node/>"),
    "an instance of a node that is not there, where none may be":
        ("<library_visual_scenes>", '<library_visual_scenes><instance_node url="#gone"/>'),
    "a node outside of libraries": (
        '<node id="n">', '<node id="n"><instance_node url="#odd"/>'),
    "two nodes of one name, one of them where none may be": (
        '<node id="n">', '<node id="other"><instance_node url="#odd"/></node><node id="n">'),
    "a polygon with a hole and no outline": (
        "<triangles", f"<polygons>{VERTEX}<ph><h>0 1 2</h></ph></polygons><triangles"),
}


@pytest.mark.parametrize("what", sorted(NOT_SHAPE))
def test_what_is_not_shape_does_not_keep_a_collada_file_from_being_read(tmp_path, what):
    changes = [NOT_SHAPE[what]]
    if what == "numbers of four":
        changes.append(('stride="3"', 'stride="4"'))
    if what == "a node outside of libraries":
        changes.append(("</COLLADA>", '<node id="odd"><odd/></node></COLLADA>'))
    if what == "two nodes of one name, one of them where none may be":
        changes.append(("<library_visual_scenes>", '<library_nodes><node id="odd">'
                        '<instance_geometry url="#gone"><node id="odd"/></instance_geometry></node>'
                        "</library_nodes><library_visual_scenes>"))
    data = load_mesh(written(tmp_path, "a.dae", collada(*changes)))
    assert data.triangles.shape == (1, 3)
    assert corners_of(data) == CORNERS


BROKEN = {
    "a letter among the positions": ("1 0 0  0 2 0", "1 0 O  0 2 0"),
    "a letter among the indices": ("<p>0 1 2", "<p>0 1 2 x"),
    "a negative index": ("<p>0 1 2", "<p>0 1 -1"),
    "two indices": ("<p>0 1 2", "<p>0 1"),
    "two numbers too few": ("1 0 0  0 2 0", "1 0 0  0"),
    "no positions": ('source="#p"', 'source="#q"'),
    "a transform with a letter": ('<node id="n">', '<node id="n"><translate>1 2 z</translate>'),
    "a transform that is too short": ('<node id="n">', '<node id="n"><rotate>1 2 3</rotate>'),
    "counts that do not fit":
        ("<triangles", f"<polylist>{VERTEX}<vcount>3 4</vcount><p>0 1 2</p></polylist><triangles"),
    "a unit that is a word": ('meter="0.0254"', 'meter="inch"'),
}


@pytest.mark.parametrize("what", sorted(BROKEN))
def test_numbers_of_collada_that_do_not_fit_are_refused(tmp_path, what):
    issue = fault_of(written(tmp_path, "a.dae", collada(BROKEN[what])))
    assert issue.code == "mesh-unreadable" and issue.file.endswith("a.dae")


LINES = {
    "a letter among the positions": 6, "a letter among the indices": 9, "two indices": 9,
    "a transform with a letter": 12, "a unit that is a word": 3,
}


@pytest.mark.parametrize("what", sorted(LINES))
def test_the_line_of_a_fault_in_collada_is_told(tmp_path, what):
    assert fault_of(written(tmp_path, "a.dae", collada(BROKEN[what]))).line == LINES[what]


def test_a_number_that_is_none_is_told_with_its_line_and_counts_only_in_positions(tmp_path):
    issue = fault_of(written(tmp_path, "a.dae", collada(("1 0 0  0 2 0", "1 0 nan  0 2 0"))))
    assert (issue.code, issue.line) == ("mesh-not-finite", 6)
    normals = '<source id="n0"><float_array id="n1" count="3">nan nan nan</float_array></source>'
    data = load_mesh(written(tmp_path, "b.dae", collada(("<vertices", normals + "<vertices"))))
    assert corners_of(data) == CORNERS


def test_a_mirrored_node_stays_outside_out(tmp_path):
    mesh = written(tmp_path, "a.dae", collada(
        ('<node id="n">', '<node id="n"><scale>-1 1 1</scale>')))
    assert corners_of(load_mesh(mesh)) == [CORNERS[2], (-0.0254, 0.0, 0.0), CORNERS[0]]


def test_a_node_deep_in_the_scene_may_be_used_again(tmp_path):
    mesh = written(tmp_path, "a.dae", collada(
        ('<node id="n">', '<node id="top"><instance_node url="#n"/><node id="n">'),
        ("</node></visual", "</node></node></visual")))
    assert len(load_mesh(mesh).triangles) == 2


@pytest.mark.parametrize("depth", [300, 20000])
def test_nodes_nested_too_deep_are_refused(tmp_path, depth):
    text = collada(('<node id="n">', "<node>" * depth), ("</node>", "</node>" * depth))
    assert fault_of(written(tmp_path, "a.dae", text)).code == "mesh-unreadable"


def test_nodes_that_double_at_each_level_are_refused(tmp_path):
    nodes = "".join(f'<node id="n{n}"><instance_node url="#n{n + 1}"/>'
                    f'<instance_node url="#n{n + 1}"/></node>' for n in range(40))
    text = collada(("<library_visual", f'<library_nodes>{nodes}<node id="n40"/></library_nodes>'
                    "<library_visual"),
                   ('<node id="n">', '<node id="n"><instance_node url="#n0"/>'))
    issue = fault_of(written(tmp_path, "a.dae", text))
    assert issue.code == "mesh-unreadable" and "form a cycle" in issue.message


def ascii_stl(head="solid", vertex="vertex 1 0 0", end="endsolid"):
    return (f"{head}\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  {vertex}\n"
            f"  VERTEX 0 2 0\n endloop\nendfacet\n{end}\n")


@pytest.mark.parametrize("text", [
    ascii_stl(), ascii_stl(head="solid a vertex of 7 8 9"), ascii_stl(end=""),
    ascii_stl(head="SOLID x"), ascii_stl().replace("\n", "\r\n"), ascii_stl().replace("\n", "\r"),
    ascii_stl(vertex="vertex 1e0 -0 +.0")])
def test_ascii_stl_is_read_as_exporters_write_it(tmp_path, text):
    data = load_mesh(written(tmp_path, "a.stl", text))
    assert corners_of(data) == [(0, 0, 0), (1, 0, 0), (0, 2, 0)]


def test_a_wrong_corner_of_ascii_stl_is_told_with_its_line(tmp_path):
    for vertex in ("vertex 1 0", "vertex 1 0 x"):
        issue = fault_of(written(tmp_path, "a.stl", ascii_stl(vertex=vertex)))
        assert (issue.code, issue.line) == ("mesh-unreadable", 5)


def test_bytes_after_the_last_triangle_of_binary_stl_are_passed_over(tmp_path):
    one = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0)
    content = b" " * 80 + struct.pack("<I", 1) + one + b"made by hand"
    assert len(load_mesh(written(tmp_path, "a.stl", content)).triangles) == 1


def test_negative_indices_of_obj_count_from_the_last_vertex_so_far(tmp_path):
    mesh = written(tmp_path, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf -3 -2 -1\nv 9 9 9\n")
    assert corners_of(load_mesh(mesh)) == [(0, 0, 0), (1, 0, 0), (0, 2, 0)]


def test_polygons_texture_indices_and_long_lines_of_obj_are_read(tmp_path):
    mesh = written(tmp_path, "a.obj", "mtllib gone.mtl\n  v 0 0 0 1 0 0\nv\t1 0 0\nv 2 1 0 # c\n"
                   "v 1 2 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2//1 3/1 \\\n 4 5/9/9\n")
    data = load_mesh(mesh)
    assert data.triangles.shape == (3, 3)
    normals = np.cross(*(data.vertices[data.triangles[:, k]] - data.vertices[data.triangles[:, 0]]
                         for k in (1, 2)))
    assert (normals[:, 2] > 0).all() and normals[:, 2].sum() / 2 == pytest.approx(2.5)


@pytest.mark.parametrize("row", ["f 0 1 2", "f 1 2 9", "f -9 1 2", "f 1 2 x", "v 1 2", "v 1 2 z"])
def test_a_wrong_row_of_obj_is_told_with_its_line(tmp_path, row):
    mesh = written(tmp_path, "a.obj", f"v 0 0 0\nv 1 0 0\nv 0 2 0\n{row}\nf 1 2 3\n")
    assert (fault_of(mesh).code, fault_of(mesh).line) == ("mesh-unreadable", 4)


def test_a_wrong_row_of_obj_after_one_that_goes_on_is_told_with_its_line(tmp_path):
    mesh = written(tmp_path, "a.obj", "v 0 0 0\nv 1 \\\n0 \\\n0\nv 0 2 0\nf 1 2 9\n")
    assert fault_of(mesh).line == 6


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_a_part_of_obj_is_found_by_its_name_in_either_encoding(tmp_path, encoding):
    text = "o größe\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"
    (tmp_path / "a.obj").write_bytes(text.encode(encoding))
    mesh = Mesh("a.obj", str(tmp_path / "a.obj"), submesh="größe")
    assert len(load_mesh(mesh).triangles) == 1


def test_groups_of_obj_are_parts_also_where_they_are_taken_up_again(tmp_path):
    mesh = written(tmp_path, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\no shape\ng left\nf 1 2 3\n"
                   "g right\nf 3 2 1\ng left\nf 2 3 1\n")
    counts = {part: len(load_mesh(Mesh("a", mesh.path, submesh=part)).triangles)
              for part in ("left", "right", "shape")}
    assert counts == {"left": 2, "right": 1, "shape": 3}


@pytest.mark.parametrize("kind", ["ply", "off", "glb"])
def test_other_formats_are_read_through_the_same_door(tmp_path, kind):
    import trimesh

    made = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]], process=False)
    content = made.export(file_type=kind)
    data = load_mesh(written(tmp_path, "a." + kind, content))
    assert corners_of(data) == [(0, 0, 0), (1, 0, 0), (0, 2, 0)]
    assert data.vertices.dtype == np.float64 and data.triangles.dtype == np.int32


def test_nodes_of_gltf_are_placed_and_its_buffers_found_beside_it(tmp_path):
    import trimesh

    scene = trimesh.Scene()
    made = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]], process=False)
    scene.add_geometry(made, node_name="far", geom_name="tri",
                       transform=trimesh.transformations.translation_matrix([0, 0, 5]))
    for name, content in scene.export(file_type="gltf").items():
        (tmp_path / name).write_bytes(content)
    mesh = Mesh("a", str(tmp_path / "model.gltf"), submesh="tri")
    assert corners_of(load_mesh(mesh)) == [(0, 0, 5), (1, 0, 5), (0, 2, 5)]


@pytest.mark.parametrize("kind", ["ply", "off", "glb", "gltf"])
def test_a_damaged_file_of_another_format_is_refused(tmp_path, kind):
    issue = fault_of(written(tmp_path, "a." + kind, b"\x00 nothing of the kind"))
    assert issue.code in ("mesh-unreadable", "mesh-empty")


def gltf(**changes):
    """A file of one triangle, whose corners are zeros that need no data; `changes` of the tree."""
    tree = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}]}
    return json.dumps({**tree, **changes})


def bomb_of_nodes(depth):
    return [{"children": [n + 1, n + 1]} for n in range(depth)] + [{"mesh": 0}]


@pytest.mark.parametrize("changes, words", [
    ({"accessors": [{"componentType": 5126, "count": 2_000_000_000, "type": "VEC3"}]}, "triangles"),
    ({"accessors": [{"componentType": 5126, "count": "3", "type": "VEC3"}]}, "count"),
    ({"nodes": bomb_of_nodes(40)}, "two parents"), ({"nodes": 5}, "nodes are no list"),
    ({"buffers": [{"uri": "/dev/zero", "byteLength": 9}]}, "no plain file"),
    ({"buffers": [{"uri": "pipe", "byteLength": 9}]}, "no plain file"),
    ({"images": [{"uri": "../%2e/pipe"}]}, ""),
], ids=lambda value: str(value)[:30])
def test_a_gltf_file_that_asks_for_too_much_is_refused_before_it_is_read(tmp_path, changes, words):
    os.mkfifo(tmp_path / "pipe")
    issue = fault_of(written(tmp_path, "a.gltf", gltf(**changes)))
    assert issue.code in ("mesh-unreadable", "mesh-empty") and words in issue.message


def test_what_uses_one_piece_many_times_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(part, "MOST_TRIANGLES", 3)
    with open(os.path.join(VALID, "inch_y_up.dae")) as stream:
        node = re.search(r"<instance_geometry[^>]*/>", stream.read()).group(0)
    assert len(load_mesh(written(tmp_path, "a.dae", collada((node, node * 3)))).triangles) == 3
    issue = fault_of(written(tmp_path, "b.dae", collada((node, node * 4))))
    assert issue.code == "mesh-unreadable" and "more than 3 triangles" in issue.message


def test_archives_are_no_meshes(tmp_path):
    assert fault_of(written(tmp_path, "a.zip", b"PK")).code == "mesh-unreadable"


def test_readers_are_imported_with_the_first_mesh_only():
    code = ("import sys, my_simulations.formats.mesh.loading\n"
            "print(*sorted({'numpy', 'lxml', 'trimesh', 'scipy'} & set(sys.modules)))")
    done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert done.stdout.strip() == b""


@pytest.mark.parametrize("index", ["2147483648", "4294967296", "99999999999999999999"])
def test_an_index_beyond_all_vertices_is_a_fault_with_its_line(tmp_path, index):
    text = collada(("<p>0 1 2</p>", f"<p>0 1 {index}</p>"))
    fault = fault_of(written(tmp_path, "huge.dae", text))
    assert fault.code == "mesh-unreadable" and fault.line == 9
    assert f"there is no vertex {index}" in fault.message


def test_a_part_that_names_no_vertex_of_its_own_is_a_fault_of_the_file(tmp_path, monkeypatch):
    triangles = np.array([[0, 1, -2147483648]])
    monkeypatch.setattr(loading, "_parts", lambda path: [
        MeshPart(("p",), np.zeros((3, 3)), triangles)])
    fault = fault_of(written(tmp_path, "negative.dae", "<COLLADA/>"))
    assert "a vertex that does not exist" in fault.message


def test_whatever_a_reader_raises_is_a_fault_of_that_file_and_the_others_are_read(
        tmp_path, monkeypatch):
    def read(path):
        raise IndexError(path) if "bad" in path else MemoryError

    good = Mesh("inch_y_up.dae", os.path.join(VALID, "inch_y_up.dae"))
    kept = loading._parts
    monkeypatch.setattr(loading, "_parts", lambda path: kept(path) if path == good.path
                        else read(path))
    faulty = [written(tmp_path, name, "<COLLADA/>") for name in ("bad.dae", "large.dae")]
    model = Model("m", links=[Link("l", collisions=[
        Collision(str(n), mesh) for n, mesh in enumerate([faulty[0], good, faulty[1]])])])
    table, issues = loading.collision_meshes(model)
    assert list(table) == [mesh_key(good)]
    assert [(one.code, os.path.basename(one.file)) for one in issues] == [
        ("mesh-unreadable", "bad.dae"), ("mesh-unreadable", "large.dae")]


@pytest.mark.parametrize("declared", ["<?xml version='1.0' encoding='utf-8'?>\n", ""])
def test_bytes_of_collada_that_are_not_utf_8_are_left_out_with_a_warning(tmp_path, declared):
    """TinyXML passes over such bytes, for instance those of a comment in Latin-1."""
    text = declared + collada((DECLARATION, ""), ("<asset>", "<!-- f\u00fcr\n --><asset>"))
    (tmp_path / "a.dae").write_bytes(text.encode("latin-1"))
    mesh = Mesh("a.dae", str(tmp_path / "a.dae"))
    assert corners_of(load_mesh(mesh)) == CORNERS
    (warned,) = warnings_of(mesh)
    assert (warned.code, warned.file) == ("xml-encoding", mesh.path)
    assert warned.line == text[:text.index("\u00fc")].count("\n") + 1


def test_names_in_collada_may_contain_angle_brackets(tmp_path):
    """Assimp wrote such names; TinyXML accepts them."""
    text = collada(("<asset>", '<asset a="<STL_BINARY>" b="a < b">'))
    assert "<STL_BINARY>" in text
    mesh = written(tmp_path, "a.dae", text.encode())
    assert corners_of(load_mesh(mesh)) == CORNERS


def test_the_first_mistake_of_collada_is_reported_if_escaping_names_does_not_help(tmp_path):
    with pytest.raises(InputError, match="Unescaped"):
        load_mesh(written(tmp_path, "a.dae", b'<COLLADA a="<b>"><asset>'))


@pytest.mark.parametrize("encoding", ["utf-8", "iso-8859-1", "utf-16"])
def test_collada_is_read_in_the_encoding_that_it_names(tmp_path, encoding):
    text = collada((DECLARATION, f"<?xml version='1.0' encoding='{encoding}'?>\n"),
                   ("<asset>", "<!-- f\u00fcr --><asset>"))
    mesh = written(tmp_path, "a.dae", text.encode(encoding))
    assert corners_of(load_mesh(mesh)) == CORNERS
    assert warnings_of(mesh) == []


def warnings_of(mesh):
    return collision_meshes(Model("m", links=[Link("l", collisions=[Collision("c", mesh)])]))[1]
