"""Meshes with their own colours and pictures, as cameras draw them."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from walking_figures import rod

from my_simulations.description.shapes import Mesh, Visual
from my_simulations.errors import InputError
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.formats.mesh.painted import painted_parts
from my_simulations.sensing.surfaces import pieces_of

REPOSITORY = Path(__file__).resolve().parents[3]
MODELS = REPOSITORY / "Media" / "models"


def mesh(path: Path, **options: object) -> Mesh:
    return Mesh(path.name, str(path), **options)


def test_a_picture_of_a_collada_file_is_found_beside_it():
    (part,) = painted_parts(mesh(MODELS / "my_object.dae"))
    assert Path(part.paint.picture).name == "carton.png" and Path(part.paint.picture).is_file()
    assert np.ptp(part.uv, axis=0).min() > 0.1


def test_a_collada_colour_is_its_diffuse():
    (part,) = painted_parts(mesh(MODELS / "lab_table.dae"))
    assert part.paint.color == pytest.approx((0.72, 0.6, 0.42, 1.0), abs=0.01)
    assert part.paint.picture is None


BESIDE = {
    "extra": ("</instance_geometry>",
              "</instance_geometry><extra><technique profile='X'/></extra>"),
    "a camera": ("<visual_scene id='s'>", "<visual_scene id='s'><node id='eye'>"
                                          "<instance_camera url='#c'/></node>"),
    "a light": ("<visual_scene id='s'>", "<visual_scene id='s'><node id='lamp'>"
                                         "<instance_light url='#l'/></node>"),
    "a name with an angle bracket": ("<visual_scene id='s'>",
                                     "<visual_scene id='s' name=\"<STL_BINARY>\">"),
    "normals that are not there": ("offset='0'/><p>0 1 3", "offset='0'/><input semantic='NORMAL' "
                                   "source='#gone' offset='0'/><p>0 1 3"),
    "lines": ("<triangles ", "<lines count='1' material='p'><input semantic='VERTEX' source='#v' "
                             "offset='0'/><p>0 1</p></lines><triangles "),
}
LIBRARIES = ("<library_cameras><camera id='c'><optics><technique_common><perspective>"
             "<xfov>40</xfov><znear>1</znear><zfar>9</zfar></perspective></technique_common></optics></camera>"
             "</library_cameras><library_lights><light id='l'><technique_common><point><color>1 1 1"
             "</color></point></technique_common></light></library_lights>")


@pytest.mark.parametrize("what", BESIDE)
def test_what_stands_beside_a_mesh_costs_no_colour(tmp_path, what):
    colored = rod().replace("<emission><color>1 0 0 1</color></emission><diffuse><color>0 0 0 1",
                            "<diffuse><color>0 0.5 0 1").replace('"', "'")
    start = colored.index("<instance_controller")
    colored = (colored[:start] + "<instance_geometry url='#g'><bind_material><technique_common>"
               "<instance_material symbol='paint' target='#m'/></technique_common></bind_material>"
               "</instance_geometry></node></visual_scene></library_visual_scenes>" + LIBRARIES
               + "<scene><instance_visual_scene url='#s'/></scene></COLLADA>")
    wrong, right = BESIDE[what]
    assert wrong in colored
    (tmp_path / "mesh.dae").write_text(colored.replace(wrong, right))
    (part,) = painted_parts(mesh(tmp_path / "mesh.dae"))
    assert part.paint.color == (0.0, 0.5, 0.0, 1.0) and len(part.triangles) == 36


def test_a_skin_that_stands_still_has_its_colours(tmp_path):
    (tmp_path / "skin.dae").write_text(rod("0.2 0.4 0.6"))
    (part,) = painted_parts(mesh(tmp_path / "skin.dae"))
    assert part.paint.emission == (0.2, 0.4, 0.6, 1.0)
    assert np.ptp(part.vertices, axis=0) == pytest.approx((0.4, 0.2, 2.0))


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, 1.0, -0.5)])
def test_the_triangles_are_those_that_collide_and_face_the_same_way(scale):
    path = mesh(MODELS / "my_object.dae", scale=scale)
    (part,), plain = painted_parts(path), load_mesh(path)

    def corners(vertices, triangles):
        return np.sort(np.round(vertices[triangles], 9).reshape(len(triangles), -1), axis=0)

    assert corners(part.vertices, part.triangles) == pytest.approx(
        corners(plain.vertices, plain.triangles), abs=1e-6)
    at = part.vertices[part.triangles]
    facing = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    assert (np.einsum("ij,ij->i", facing, part.normals[part.triangles].mean(axis=1)) > 0).all()


def test_negative_indices_of_obj_draw_the_triangles_that_collide(tmp_path):
    (tmp_path / "two.mtl").write_text("newmtl red\nKd 1 0 0\n")
    corners = "v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nvt 0 0\nvt {0} 1\nvt 0 1\nvn 0 0 1\n"
    (tmp_path / "two.obj").write_text("mtllib two.mtl\nusemtl red\n" + "".join(
        f"o part{x}\n{corners.format(x, x + 1)}f -3/-3/-1 -2/-2/-1 -1/-1/-1\n" for x in (0, 10)))
    parts, plain = painted_parts(mesh(tmp_path / "two.obj")), load_mesh(mesh(tmp_path / "two.obj"))
    drawn = np.concatenate([part.vertices[part.triangles] for part in parts])
    assert sorted(drawn.tolist()) == sorted(plain.vertices[plain.triangles].tolist())
    assert {part.paint.color for part in parts} == {(1.0, 0.0, 0.0, 1.0)}
    assert max(part.uv[:, 0].max() for part in parts) == 10.0


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_an_obj_file_has_its_colours_whatever_ends_its_lines(tmp_path, end):
    (tmp_path / "one.mtl").write_text("newmtl red\nKd 1 0 0\n")
    (tmp_path / "one.obj").write_bytes(end.join([
        "mtllib one.mtl", "usemtl red", "v 0 0 0", "v 1 0 0", "v 0 1 0", "v 1 1 0",
        "f 1 2 3", "f 2\\", "4 3", ""]).encode())
    (part,) = painted_parts(mesh(tmp_path / "one.obj"))
    assert part.paint.color == (1.0, 0.0, 0.0, 1.0) and len(part.triangles) == 2


def test_an_stl_file_has_no_colour_and_flat_faces():
    (part,) = painted_parts(mesh(REPOSITORY / "test" / "data" / "valid" / "cube.stl"))
    assert part.paint.color is None and len(part.vertices) == 24


def test_a_file_that_does_not_load_is_refused_as_ever():
    with pytest.raises(InputError):
        painted_parts(Mesh("none.dae", "/nowhere/none.dae"))


def test_a_flattened_node_of_a_glb_keeps_its_colour_and_normals(tmp_path):
    box = trimesh.creation.box()
    red = trimesh.visual.material.PBRMaterial(baseColorFactor=[1.0, 0.0, 0.0, 1.0])
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=red)
    scene = trimesh.Scene()
    scene.add_geometry(box, transform=np.diag([1.0, 1.0, 0.0, 1.0]))
    assert box.vertex_normals is not None  # the file gets those that were asked for
    scene.export(tmp_path / "flat.glb", include_normals=True)
    (part,) = painted_parts(mesh(tmp_path / "flat.glb"))
    assert part.paint.color[:3] == pytest.approx((1.0, 0.0, 0.0))
    assert np.abs(part.normals[:, :2]).max() == pytest.approx(0.0, abs=1e-9)


def surface_of_file(path, transparency=0.0):
    (piece,) = pieces_of(Visual("v", mesh(path), transparency=transparency), None)
    return piece.surface


def glb(folder, picture=None, **told):
    """A square with a material of glTF."""
    square = trimesh.Trimesh([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]],
                             [[0, 1, 2], [0, 2, 3]], process=False)
    square.visual = trimesh.visual.TextureVisuals(
        [[0, 0], [1, 0], [1, 1], [0, 1]],
        trimesh.visual.material.PBRMaterial(baseColorTexture=picture, **told))
    square.export(folder / "mesh.glb")
    return folder / "mesh.glb"


def test_a_gltf_factor_is_linear_and_its_alpha_counts_where_it_blends(tmp_path):
    told = {"baseColorFactor": [0.2, 0.2, 0.2, 0.4], "emissiveFactor": [0.0, 1.0, 0.0]}
    clear = surface_of_file(glb(tmp_path, alphaMode="BLEND", **told), transparency=0.5)
    assert clear.diffuse[:3] == pytest.approx([0.4845] * 3, abs=0.002)   # sRGB of 0.2
    assert clear.emissive[:3] == pytest.approx((0.0, 1.0, 0.0))
    assert clear.opacity == pytest.approx(0.2)
    assert surface_of_file(glb(tmp_path, **told)).opacity == 1.0


@pytest.mark.parametrize(("mode", "blended", "cut"), [
    ("BLEND", True, 0.004), ("MASK", False, 0.7), ("OPAQUE", False, 0.0)])
def test_a_gltf_picture_s_alpha_counts_as_the_file_says(tmp_path, mode, blended, cut):
    surface = surface_of_file(glb(
        tmp_path, Image.new("RGBA", (4, 4), (200, 0, 0, 90)), alphaMode=mode, alphaCutoff=0.7,
        baseColorFactor=[0.0, 1.0, 0.0, 1.0]))
    assert surface.picture is not None
    assert surface.diffuse[:3] == pytest.approx((0.0, 1.0, 0.0))
    assert (surface.blended, surface.alpha_test) == (blended, cut)


@pytest.mark.parametrize(("line", "opacity"), [
    ("d 0.3", 0.3), ("Tr 0.6", 0.4), ("d 0.3\nTr 0.7", 0.3), ("d -halo 0.3", 0.3), ("d 1", 1.0),
    ("d 0", 1.0), ("Tr 1", 1.0), ("d some", 1.0)])
def test_an_obj_material_is_as_clear_as_its_file_says(tmp_path, line, opacity):
    (tmp_path / "one.mtl").write_text(f"newmtl glass\nKd 0.2 0.4 0.6\n{line}\n")
    (tmp_path / "one.obj").write_text(
        "mtllib one.mtl\nusemtl glass\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert surface_of_file(tmp_path / "one.obj").opacity == pytest.approx(opacity)


CLEAR = "<transparent{0}><color>{1}</color></transparent>"
CLEAR_FOR = CLEAR + "<transparency><float>{2}</float></transparency>"


@pytest.mark.parametrize(("effect", "opacity"), [
    (CLEAR_FOR.format(' opaque="A_ONE"', "1 1 1 0.5", 0.6), 0.3),
    (CLEAR_FOR.format(' opaque="A_ZERO"', "1 1 1 0.5", 0.6), 0.7),
    (CLEAR_FOR.format(' opaque="RGB_ONE"', "0.5 0.5 0.5 1", 0.6), 0.3),
    (CLEAR_FOR.format(' opaque="RGB_ZERO"', "0.5 0.5 0.5 1", 0.6), 0.7),
    (CLEAR.format(' opaque="A_ONE"', "1 1 1 0.5"), 0.5),
    (CLEAR_FOR.format("", "1 1 1 1", 0.4), 1.0),
    ("<transparency><float>0.4</float></transparency>", 1.0),
    (CLEAR_FOR.format(' opaque="A_ONE"', "1 1 1 1", 0.0), 1.0),
    (CLEAR_FOR.format(' opaque="RGB_ZERO"', "1 1 1 1", 1.0), 1.0),
])
def test_a_collada_effect_is_as_clear_as_its_opaque_mode_says(tmp_path, effect, opacity):
    (tmp_path / "glass.dae").write_text(rod().replace("</lambert>", f"{effect}</lambert>"))
    assert surface_of_file(tmp_path / "glass.dae").opacity == pytest.approx(opacity, abs=1e-5)


def shown(part):
    """Place and colour, 0 to 255, of each corner, with the picture's pixels blended evenly."""
    pixels = np.asarray(part.paint.picture, dtype=float)[::-1]
    height, width, _ = pixels.shape
    found = {}
    for place, (u, v) in zip(part.vertices, part.uv):
        x, y = u * width - 0.5, v * height - 0.5
        left, low = min(int(x), width - 2), min(int(y), height - 2)
        right, high = x - left, y - low
        found.setdefault(tuple(place), []).append(
            (1 - high) * ((1 - right) * pixels[low, left] + right * pixels[low, left + 1])
            + high * ((1 - right) * pixels[low + 1, left] + right * pixels[low + 1, left + 1]))
    return found


CORNERS = {(0.0, 0.0, 0.0): (255, 0, 0), (1.0, 0.0, 0.0): (0, 255, 0), (0.0, 1.0, 0.0): (0, 0, 255),
           (1.0, 1.0, 0.0): (9, 9, 9)}
FACES = [[0, 1, 2], [1, 3, 2]]


@pytest.mark.parametrize("kind", ["ply", "obj"])
def test_colours_of_vertices_are_drawn(tmp_path, kind):
    square = trimesh.Trimesh([*CORNERS], FACES, vertex_colors=[*CORNERS.values()], process=False)
    square.export(tmp_path / f"square.{kind}")
    (part,) = painted_parts(mesh(tmp_path / f"square.{kind}"))
    assert part.paint.color == (1.0, 1.0, 1.0, 1.0)
    for place, colors in shown(part).items():
        for color in colors:
            assert color == pytest.approx(CORNERS[place], abs=1.0)


def test_colours_of_vertices_of_gltf_are_linear_and_times_its_material(tmp_path):
    square = trimesh.load(glb(tmp_path, baseColorFactor=[1.0, 0.0, 0.0, 1.0]), force="mesh")
    square.visual.vertex_attributes["color"] = np.full((4, 4), [51, 51, 51, 255], dtype=np.uint8)
    square.export(tmp_path / "mesh.glb")
    (part,) = painted_parts(mesh(tmp_path / "mesh.glb"))
    assert part.paint.color[:3] == pytest.approx((1.0, 0.0, 0.0))
    assert {round(value) for colors in shown(part).values() for value in np.ravel(colors)} == {124}


def test_triangles_of_one_colour_share_their_vertices(tmp_path):
    colors = np.array([[200, 0, 0, 255]] * 6 + [[0, 0, 200, 255]] * 6)
    trimesh.Trimesh(trimesh.creation.box().vertices, trimesh.creation.box().faces,
                    face_colors=colors, process=False).export(tmp_path / "box.ply")
    (part,) = painted_parts(mesh(tmp_path / "box.ply"))
    assert part.paint.picture.size == (4, 2) and len(part.vertices) < 36
    assert {tuple(np.rint(one)) for found in shown(part).values() for one in found} == {
        (200, 0, 0), (0, 0, 200)}
