"""Files behind a visual that are missing or damaged: told with file and line, without decoding."""
import json
import os
import struct

import pytest
from reading import URDF_INERTIAL, codes, model_of, robot_of, sdf

from my_simulations.appearance.materials import Materials
from my_simulations.appearance.textures import TextureFiles
from my_simulations.cli.check_model_command import check
from my_simulations.description.shapes import Mesh
from my_simulations.errors import InputError, Severity
from my_simulations.formats.mesh import loading, named_files
from my_simulations.formats.reading import read_file, read_world_text
from my_simulations.resources.package_files import own_directory
from my_simulations.resources.resolver import Resolver

CARTON = os.path.join(own_directory(), "Media", "models", "my_object.dae")
IMAGE = "my_object/carton.png"
OBJ = "mtllib thing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\n"
MTL = "# made by hand\nnewmtl skin\nKd 1 1 1\nmap_Kd -s 2 2 1 -blendu on wood.png\n"
POINTER = ("version https://git-lfs.github.com/spec/v1\n"
           "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 9\n")
SCRIPT = """material Thing/Wood
{
  technique
  {
    pass
    {
      texture_unit
      {
        texture wood.png
      }
    }
  }
}
"""


@pytest.fixture
def carton(tmp_path):
    """The tutorial's mesh without its folder of textures."""
    with open(CARTON, encoding="utf-8") as stream:
        text = stream.read()
    path = tmp_path / "carton.dae"
    path.write_text(text, encoding="utf-8")
    return path


def shown(path, more=""):
    """Issues of an SDF model that shows a mesh file."""
    _, issues = model_of(f'<link name="l"><visual name="v"><geometry><mesh><uri>{path}</uri></mesh>'
                         f"</geometry>{more}</visual></link>", resolver=Resolver())
    return issues


def robot_text(path):
    return (f'<robot name="r"><link name="l">{URDF_INERTIAL}<visual><geometry><mesh filename="'
            f'file://{path}"/></geometry></visual></link></robot>')


def only(issues, code):
    """The one issue, which must be a warning."""
    assert codes(issues) == [code], issues
    assert issues[0].severity is Severity.WARNING
    return issues[0]


def scripted(folder, name="Thing/Wood", uris=("scripts", "textures")):
    inside = "".join(f"<uri>{folder / uri}</uri>" for uri in uris)
    return model_of(f'<link name="l"><visual name="v"><geometry><box><size>1 1 1</size></box>'
                    f"</geometry><material>\n<script>{inside}<name>{name}</name></script>"
                    "</material></visual></link>", resolver=Resolver())[1]


@pytest.fixture
def materials(tmp_path):
    """A folder `materials` as in a model, with its texture."""
    for name in ("scripts", "textures"):
        (tmp_path / name).mkdir()
    (tmp_path / "scripts" / "thing.material").write_text(SCRIPT)
    (tmp_path / "textures" / "wood.png").write_bytes(b"png")
    return tmp_path


def test_an_image_of_a_collada_file_that_does_not_exist_is_told_with_its_line(carton):
    issue = only(shown(carton), "image-not-found")
    lines = carton.read_text(encoding="utf-8").splitlines()
    assert issue.file == str(carton)
    assert IMAGE in lines[issue.line - 1] and repr(IMAGE) in issue.message
    assert issue.hint == f"copy its folder 'my_object' to {carton.parent}"


def test_a_urdf_visual_is_told_in_the_same_way(carton):
    _, issues = robot_of(f'<link name="l">{URDF_INERTIAL}<visual><geometry><mesh filename="file://'
                         f'{carton}"/></geometry></visual></link>')
    assert only(issues, "image-not-found").file == str(carton)


def test_a_world_tells_each_file_once(carton):
    visual = f'<geometry><mesh><uri>{carton}</uri></mesh></geometry></visual>'
    models = "".join(
        f'<model name="{name}"><static>1</static><link name="l"><visual name="v">{visual}</link>'
        "</model>" for name in "ab")
    loaded = read_world_text(sdf(f'<world name="w">{models}</world>'), Resolver())
    only(loaded.issues, "image-not-found")


def test_an_image_in_another_folder_below_is_suggested(carton):
    (carton.parent / "textures2").mkdir()
    (carton.parent / "textures2" / "carton.png").write_bytes(b"png")
    assert only(shown(carton), "image-not-found").hint == "did you mean textures2/carton.png?"


@pytest.mark.parametrize("place", [IMAGE, "my_object/CARTON.PNG", "textures/carton.png",
                                   "materials/textures/carton.png"])
def test_an_image_where_renderers_find_it_is_no_fault(carton, place):
    path = carton.parent / place
    path.parent.mkdir(parents=True)
    path.write_bytes(b"png")
    assert shown(carton) == []


def test_an_image_is_found_by_its_uri(carton):
    carton.write_text(carton.read_text(encoding="utf-8").replace(IMAGE, "model://thing/a%20b.png"),
                      encoding="utf-8")
    assert codes(shown(carton)) == ["image-not-found"]
    (carton.parent / "thing").mkdir()
    (carton.parent / "thing" / "a b.png").write_bytes(b"png")
    model, issues = model_of(
        f'<link name="l"><visual name="v"><geometry><mesh><uri>{carton}</uri></mesh></geometry>'
        "</visual></link>", resolver=Resolver([str(carton.parent)]))
    assert issues == []


@pytest.mark.parametrize("changes", [
    [('target="#my_object-material"', 'target="#another"')],
    [("<diffuse><texture", "<bump><texture"), ("</diffuse>", "</bump>")],
], ids=["of an unused material", "for bumps"])
def test_an_image_that_is_not_drawn_need_not_exist(carton, changes):
    text = carton.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    carton.write_text(text, encoding="utf-8")
    assert shown(carton) == []


def test_the_text_of_a_changed_file_is_read_again(carton):
    assert codes(shown(carton)) == ["image-not-found"]
    carton.write_text(carton.read_text(encoding="utf-8").replace(IMAGE, ""), encoding="utf-8")
    assert shown(carton) == []


def test_an_unchanged_file_is_read_once(carton, monkeypatch):
    shown(carton)
    monkeypatch.setattr(named_files, "at_most", None)
    assert codes(shown(carton)) == ["image-not-found"]


def test_a_visual_mesh_is_not_decoded_when_a_model_is_read(carton, monkeypatch):
    monkeypatch.setattr(loading, "load_solid", None)
    monkeypatch.setattr(loading, "_parts", None)
    assert codes(shown(carton)) == ["image-not-found"]


def test_a_material_library_that_does_not_exist_is_told_with_its_line(tmp_path):
    path = tmp_path / "thing.obj"
    path.write_text("# by hand\n" + OBJ)
    issue = only(shown(path), "material-library-not-found")
    assert (issue.file, issue.line) == (str(path), 2)
    assert "'thing.mtl'" in issue.message


def test_an_image_of_a_material_library_is_told_with_its_line(tmp_path):
    path = tmp_path / "thing.obj"
    path.write_text(OBJ)
    (tmp_path / "thing.mtl").write_text(MTL)
    issue = only(shown(path), "image-not-found")
    assert (issue.file, issue.line) == (str(tmp_path / "thing.mtl"), 4)
    assert "'wood.png'" in issue.message
    (tmp_path / "wood.png").write_bytes(b"png")
    assert shown(path) == []


def gltf(**more):
    return json.dumps({"asset": {"version": "2.0"}, **more}, indent=1)


def test_an_image_of_a_gltf_file_is_told_with_its_line(tmp_path):
    path = tmp_path / "thing.gltf"
    path.write_text(gltf(images=[{"uri": "data:image/png;base64,AA=="}, {"uri": "wo%20od.png"}]))
    issue = only(shown(path), "image-not-found")
    assert "wo%20od.png" in path.read_text().splitlines()[issue.line - 1]
    assert "'wo od.png'" in issue.message
    (tmp_path / "wo od.png").write_bytes(b"png")
    assert shown(path) == []


def test_an_image_of_a_binary_gltf_file_is_told(tmp_path):
    text = gltf(images=[{"uri": "wood.png"}]).encode()
    path = tmp_path / "thing.glb"
    path.write_bytes(b"glTF" + struct.pack("<III4s", 2, 20 + len(text), len(text), b"JSON") + text)
    assert only(shown(path), "image-not-found").line == 0


def test_a_buffer_of_a_gltf_file_that_does_not_exist_is_told(tmp_path):
    path = tmp_path / "thing.gltf"
    path.write_text(gltf(buffers=[{"uri": "thing.bin", "byteLength": 4}]))
    assert "'thing.bin'" in only(shown(path), "mesh-unreadable").message


DAMAGED = {
    "cut off.dae": ("<COLLADA><asset>", "not well formed"),
    "page.dae": ("<html></html>", "expected <COLLADA>"),
    "cut off.stl": (b"\0" * 80 + struct.pack("<I", 9) + b"\0" * 50, "neither a binary STL"),
    "page.gltf": ("<html></html>", "not glTF"),
    "pointer.dae": (POINTER, "Git LFS pointer"),
    "pointer.stl": (POINTER, "Git LFS pointer"),
    "pointer.ply": (POINTER, "Git LFS pointer"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_mesh_of_a_visual_is_told(tmp_path, name):
    content, reason = DAMAGED[name]
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    issue = only(shown(path), "mesh-unreadable")
    assert issue.file == str(path) and reason in issue.message
    assert issue.message.endswith("it is not shown")


@pytest.mark.parametrize(("name", "content"), [("empty.dae", ""), ("points.obj", "v 0 0 0\n")])
def test_a_mesh_without_content_is_told(tmp_path, name, content):
    (tmp_path / name).write_text(content)
    only(shown(tmp_path / name), "mesh-empty")


def test_an_image_that_is_a_git_lfs_pointer_is_told(carton):
    (carton.parent / "my_object").mkdir()
    (carton.parent / IMAGE).write_text(POINTER)
    issue = only(shown(carton), "image-unreadable")
    assert "Git LFS pointer" in issue.message and "git lfs pull" in issue.hint


def test_a_document_or_collision_mesh_that_is_a_git_lfs_pointer_is_told(tmp_path):
    path = tmp_path / "thing.sdf"
    path.write_text(POINTER)
    with pytest.raises(InputError) as refused:
        read_file(str(path), Resolver())
    assert codes(refused.value.issues) == ["git-lfs-pointer"]
    (tmp_path / "thing.stl").write_text(POINTER)
    with pytest.raises(InputError) as refused:
        loading.load_mesh(Mesh("thing.stl", str(tmp_path / "thing.stl")))
    assert "git lfs pull" in refused.value.issues[0].hint


def test_a_script_that_does_not_exist_is_told_with_its_line(materials):
    issue = only(scripted(materials, uris=("scripts", "skripts")), "material-script-not-found")
    assert "skripts" in issue.message and issue.line == 2 and issue.xpath.endswith("uri[2]")


def test_a_material_that_no_script_defines_is_told(materials):
    issue = only(scripted(materials, name="Thing/Wod"), "material-unknown")
    assert issue.line and "Thing/Wood" in issue.hint


@pytest.mark.parametrize("media", ["", "media"])
def test_a_material_of_a_resource_folder_needs_only_its_name(tmp_path, media):
    """As for `GAZEBO_RESOURCE_PATH`, or an exported `gazebo_media_path`."""
    folder = tmp_path / media / "materials"
    (folder / "scripts").mkdir(parents=True)
    (folder / "textures").mkdir()
    (folder / "scripts" / "a.material").write_text("material Thing/Other\n{\n}\n")
    (folder / "scripts" / "thing.material").write_text(SCRIPT)
    image = folder / "textures" / "wood.png"
    image.write_bytes(b"png")
    (folder / "scripts" / "gone.material").symlink_to(tmp_path / "nothing")
    resolver = Resolver(resource_paths=[str(tmp_path)])
    robot, issues = robot_of(f'<link name="l">{URDF_INERTIAL}<visual><geometry><box size="1 1 1"/>'
                             '</geometry></visual></link>\n<gazebo reference="l">\n'
                             "<material>Thing/Wood</material></gazebo>", resolver=resolver)
    assert issues == []
    look = Materials(resolver, TextureFiles(resolver)).resolve(robot.links[0].visuals[0].material)
    assert look is not None and look.texture == str(image)
    image.unlink()
    _, issues = robot_of(f'<link name="l">{URDF_INERTIAL}<visual><geometry><box size="1 1 1"/>'
                         '</geometry></visual></link>\n<gazebo reference="l">\n'
                         "<material>Thing/Wood</material></gazebo>", resolver=resolver)
    assert only(issues, "image-not-found").file == str(folder / "scripts" / "thing.material")


def test_a_misspelt_material_of_gazebo_is_told():
    _, issues = robot_of(f'<link name="l">{URDF_INERTIAL}<visual><geometry><box size="1 1 1"/>'
                         '</geometry></visual></link>\n<gazebo reference="l">\n'
                         "<material>Gazebo/Bleu</material></gazebo>")
    issue = only(issues, "material-unknown")
    assert issue.line == 3 and "Gazebo/Blue" in issue.hint


def test_a_texture_of_a_script_is_told_with_its_line(materials):
    assert scripted(materials) == []
    (materials / "textures" / "wood.png").unlink()
    issue = only(scripted(materials), "image-not-found")
    assert issue.file == str(materials / "scripts" / "thing.material")
    assert issue.line == 9 and issue.hint == f"copy it to {materials / 'textures'}"


def test_the_line_of_a_texture_is_found_in_a_script_of_few_lines(materials):
    script = materials / "scripts" / "thing.material"
    script.write_text("material Thing/Wood\n{ technique { pass { texture_unit {"
                      ' texture "wood.png" } } } }\n')
    (materials / "textures" / "wood.png").unlink()
    assert only(scripted(materials), "image-not-found").line == 2


def test_a_texture_of_a_urdf_material_is_told():
    _, issues = robot_of(f'<link name="l">{URDF_INERTIAL}<visual><geometry><box size="1 1 1"/>'
                         '</geometry><material name="wood">\n<texture filename="'
                         'package://no_such/wood.png"/></material></visual></link>')
    issue = only(issues, "image-not-found")
    assert "'no_such'" in issue.message and issue.xpath.endswith("material")


def test_check_model_decodes_what_is_only_shown(tmp_path):
    with open(os.path.join(os.path.dirname(__file__), "..", "..", "data", "invalid",
                           "mesh_with_nan.dae"), encoding="utf-8") as stream:
        (tmp_path / "nan.dae").write_text(stream.read(), encoding="utf-8")
    (tmp_path / "thing.urdf").write_text(robot_text(tmp_path / "nan.dae"))
    _, issues = check(str(tmp_path / "thing.urdf"), Resolver())
    issue = only(issues, "mesh-not-finite")
    assert issue.message.startswith("visual ") and issue.message.endswith("it is not shown")


def test_check_model_tells_a_missing_texture_once(carton):
    path = carton.parent / "thing.urdf"
    path.write_text(robot_text(carton))
    assert codes(check(str(path), Resolver())[1]) == ["image-not-found"]


def test_what_this_package_ships_lacks_nothing():
    resolver = Resolver.from_environment()
    folder = os.path.join(own_directory(), "models")
    for name in sorted(os.listdir(folder)):
        text = sdf(f'<world name="w"><include><uri>model://{name}</uri></include></world>')
        issues = read_world_text(text, resolver).issues
        assert [issue for issue in issues if "not-found" in issue.code
                or issue.code == "material-unknown"] == []
