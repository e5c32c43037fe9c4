"""`check_model`, and the advice it gives."""
from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from reading import INVALID, VALID, sdf

from my_simulations.cli.check_model_command import check, main
from my_simulations.errors import Severity
from my_simulations.plugins.registry import BUILT_IN, PROVIDED
from my_simulations.resources.resolver import Resolver

ROOT = Path(__file__).resolve().parents[3]
SHIPPED = [*sorted(ROOT.glob("world/**/*.world")), *sorted((ROOT / "models").iterdir()),
           *sorted(p for p in (ROOT / "objects").iterdir() if p.suffix != ".xacro"),
           ROOT / "urdf" / "robo.urdf"]
GROUND = ('<model name="ground"><static>1</static><link name="l"><collision name="c"><geometry>'
          "<plane/></geometry></collision></link></model>")


def solid(name, pose, shape="<box><size>1 1 1</size></box>", moment=0.166667, static=0, mass=1):
    tensor = "".join(f"<{i}>{moment}</{i}>" for i in ("ixx", "iyy", "izz"))
    return (f'<model name="{name}"><pose>{pose}</pose><static>{static}</static><link name="l">'
            f"<inertial><mass>{mass}</mass><inertia>{tensor}</inertia></inertial>"
            f'<collision name="c"><geometry>{shape}</geometry></collision></link></model>')


@pytest.fixture
def found(tmp_path):
    def run(*models):
        path = tmp_path / "w.world"
        path.write_text(sdf('<world name="w">\n' + "\n".join(models) + "</world>", "1.7"))
        return check(str(path), Resolver())[1]

    return run


@pytest.mark.parametrize("path", SHIPPED, ids=[path.name for path in SHIPPED])
def test_what_the_package_ships_is_clean(path):
    loaded, issues = check(str(path), Resolver.from_environment())
    assert loaded is not None
    assert [str(issue) for issue in issues if issue.severity is not Severity.NOTE] == []


def test_a_file_with_nothing_but_an_actor_is_clean(tmp_path):
    path = tmp_path / "walker.sdf"
    path.write_text(sdf('<actor name="a"><skin><filename>walk.dae</filename></skin></actor>'))
    loaded, issues = check(str(path), Resolver())
    assert loaded.skin == "walk.dae"
    assert [(issue.code, issue.severity) for issue in issues] == [
        ("not-simulated", Severity.NOTE)]


@pytest.mark.parametrize("pose", ["0 0 0.5 0 0 0", "0 0 0.496 0 0 0.7", "0 0 2 1 1 1"])
def test_a_box_that_touches_the_ground_or_floats_is_fine(found, pose):
    assert found(GROUND, solid("b", pose)) == []


def test_a_box_in_the_ground_that_is_held_to_the_world_is_fine(found):
    held = solid("b", "0 0 0 0 0 0").replace("</model>", (
        '<joint name="j" type="{}"><parent>world</parent><child>l</child><axis><limit>'
        "<lower>0</lower><upper>{}</upper></limit></axis></joint></model>"))
    for kind, upper in (("fixed", 1), ("revolute", 0)):
        assert found(GROUND, held.format(kind, upper)) == []
    assert [one.code for one in found(GROUND, held.format("prismatic", 1))] == ["starts-inside"]


def test_odd_inertia_is_told_once_for_a_model(found):
    one = solid("b", "0 0 5 0 0 0", moment=50)
    link = one[one.index("<link"):one.index("</model>")]
    two = one.replace("</model>", link.replace('"l"', '"k"') + "</model>")
    (issue,) = found(two)
    assert issue.code == "inertia-odd" and "1 more" in issue.message


def test_unlike_friction_of_one_link_is_told_with_the_one_that_holds(found):
    def collision(name: str, height: float, mu: str) -> str:
        return (f'<collision name="{name}"><pose>0 0 {height} 0 0 0</pose><geometry><sphere>'
                f"<radius>0.1</radius></sphere></geometry><surface><friction><ode><mu>{mu}</mu></ode>"
                "</friction></surface></collision>")
    one = solid("b", "0 0 5 0 0 0")
    unlike = one.replace("</link>", collision("caster", -0.6, "0") + "</link>")
    many = "".join(f'<link name="l{n}"><pose>{n} 0 0 0 0 0</pose></link>' for n in range(125))
    fitting = unlike.replace("</model>", many + "</model>")
    assert found(unlike) == found(fitting) == []
    crowded = fitting.replace("</model>", '<link name="last"/></model>')
    (issue,) = found(crowded)
    assert issue.code == "friction-shared" and issue.severity is Severity.WARNING
    assert "mu 0, 1" in issue.message and "mu 0 of 'caster'" in issue.message
    assert found(crowded.replace("<static>0", "<static>1")) == []


@pytest.mark.parametrize("pose, depth", [("0 0 0.4 0 0 0", "100 mm"),
                                         ("0 0 0.5 0.785398 0 0", "207 mm"),
                                         ("0 0 -3 0 0 0", "3.5 m")])
def test_a_box_in_the_ground_is_reported(found, pose, depth):
    (issue,) = found(GROUND, solid("b", pose))
    assert issue.code == "starts-inside" and f" {depth} or more" in issue.message
    assert issue.severity is Severity.WARNING and issue.line == 3
    assert issue.xpath == "/sdf/world/model[2]/link/collision"


@pytest.mark.parametrize("pose, inside", [
    ("1 0 0.5 0 0 0", False), ("0.996 0 0.5 0 0 0", False), ("0.9 0 0.5 0 0 0", True),
    ("1.1 0 0.5 0 0 0.785398", False), ("0.4 0 0.5 0 0 0.3", True), ("0 0 1.5 0 0 0", False),
])
def test_boxes_in_each_other_are_reported_and_neighbours_are_not(found, pose, inside):
    issues = found(solid("a", "0 0 0.5 0 0 0"), solid("b", pose))
    assert [issue.code for issue in issues] == ["starts-inside"] * inside


def test_a_link_with_two_shapes_in_the_ground_is_reported_once_with_the_deeper(found):
    shape = "<geometry><box><size>1 1 1</size></box></geometry></collision>"
    link = solid("b", "0 0 0.4 0 0 0").replace(
        "</link>", f'<collision name="low"><pose>0 0 -0.1 0 0 0</pose>{shape}</link>')
    (issue,) = found(GROUND, link)
    assert issue.code == "starts-inside" and "200 mm" in issue.message
    assert issue.xpath == "/sdf/world/model[2]/link/collision[2]"


def test_spheres_whose_boxes_overlap_may_still_be_apart(found):
    ball = "<sphere><radius>0.5</radius></sphere>"
    assert found(solid("a", "0 0 0.5 0 0 0", ball), solid("b", "0.8 0.8 0.5 0 0 0", ball)) == []


def test_what_stands_still_may_overlap(found):
    assert found(solid("a", "0 0 0 0 0 0", static=1), solid("b", "0.1 0 0 0 0 0", static=1)) == []


@pytest.mark.parametrize("moment, odd", [
    (0.166667, False), (0.5, False), (0.02, False), (60, True), (0.0001, True),
])
def test_inertia_far_from_what_the_shapes_could_have_is_reported(found, moment, odd):
    issues = found(solid("a", "0 0 5 0 0 0", moment=moment))
    assert [issue.code for issue in issues] == ["inertia-odd"] * odd


def test_inertia_that_no_body_has_is_reported(tmp_path):
    path = tmp_path / "m.sdf"
    path.write_text(sdf('<model name="m"><link name="l"><inertial><inertia><ixx>1</ixx><iyy>1</iyy>'
                        "<izz>3</izz></inertia></inertial></link></model>", "1.7"))
    assert [i.code for i in check(str(path), Resolver())[1]] == ["inertia-impossible"]


@pytest.mark.parametrize("shape", ["<box><size>1 1 0.00001</size></box>",
                                   "<cylinder><radius>1</radius><length>1e-5</length></cylinder>"])
def test_a_shape_without_thickness_is_reported(found, shape):
    assert "shape-thin" in [i.code for i in found(solid("a", "0 0 5 0 0 0", shape, static=1))]


def test_thin_shapes_of_a_model_are_one_warning(found, tmp_path):
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")

    def three(name, shape):
        collision = (f'<collision name="{{}}"><geometry>{shape}</geometry></collision>')
        return (f'<model name="{name}"><static>1</static><link name="l">'
                f'{"".join(map(collision.format, "abc"))}</link></model>')

    issues = found(three("boxes", "<box><size>1 1 0.00001</size></box>"),
                   three("meshes", "<mesh><uri>flat.obj</uri></mesh>"))
    assert [issue.code for issue in issues] == ["shape-thin"] * 2
    assert all("collision 'a'" in issue.message and "2 more" in issue.message for issue in issues)


def test_a_flat_mesh_is_reported(found, tmp_path):
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")
    issues = found(solid("a", "0 0 5 0 0 0", "<mesh><uri>flat.obj</uri></mesh>", static=1))
    assert [issue.code for issue in issues] == ["shape-thin"]


def test_a_mesh_in_inches_is_reported(found, tmp_path):
    shutil.copy(Path(VALID) / "cube.stl", tmp_path / "cube.stl")
    shape = "<mesh><uri>cube.stl</uri><scale>40 40 40</scale></mesh>"
    assert "mesh-size-odd" in [i.code for i in found(solid("a", "0 0 99 0 0 0", shape))]


def test_errors_give_1_and_warnings_0(tmp_path, capsys):
    warned = tmp_path / "w.sdf"
    warned.write_text(sdf('<model name="m"><static>1</static><oops/></model>', "1.7"))
    assert main(["check_model", str(warned)]) == 0
    assert f"{warned}:1: warning: element <oops>" in capsys.readouterr().out
    assert main(["check_model", str(Path(INVALID) / "mass_zero.sdf"), str(warned)]) == 1
    out = capsys.readouterr().out
    assert "mass_zero.sdf:" in out and "error:" in out and "[/sdf/model/" in out


@pytest.mark.parametrize("argv", [[], ["--what", "x.sdf"]])
def test_a_wrong_command_line_gives_2(argv, capsys):
    with pytest.raises(SystemExit) as end:
        main(["check_model", *argv])
    assert end.value.code == 2
    assert "usage: check_model" in capsys.readouterr().err


def test_a_file_that_is_not_there_and_a_folder_without_model_are_errors(tmp_path, capsys):
    assert main(["check_model", str(tmp_path / "none.sdf"), str(tmp_path)]) == 1
    out = capsys.readouterr().out
    assert "none.sdf: error: cannot be read" in out and "contains neither a model.config" in out


def test_json_counts_what_a_file_holds(capsys):
    assert main(["check_model", "--json", str(ROOT / "world" / "lab_course.world"),
                 str(ROOT / "models" / "sun"), str(Path(INVALID) / "not_xml.sdf")]) == 1
    world, sun, broken = (json.loads(line) for line in capsys.readouterr().out.splitlines())
    assert world["models"] == world["links"] == 6 and world["lights"] == 1
    assert world["collisions"]["plane"] == 1 and world["collisions"]["sphere"] == 1
    assert sum(world["collisions"].values()) == world["visuals"] == 15
    assert world["joints"] == world["plugins"] == 0 and world["issues"] == []
    assert (sun["models"], sun["lights"]) == (0, 1)
    assert broken["issues"][0]["severity"] == "error" and broken["models"] == 0


def test_a_room_can_be_furnished():
    there = {path.name for path in (ROOT / "models").iterdir()}
    assert there >= {"sun", "ground_plane", "unit_box", "unit_sphere", "unit_cylinder", "table",
                     "chair", "shelf", "cabinet", "door", "wall", "bin", "cone", "crate", "ramp",
                     "stairs"}


def test_the_strict_count_what_is_tolerated_as_an_error(capsys):
    path = str(Path(INVALID) / "pose_of_five_numbers.sdf")
    assert main(["check_model", path]) == 0
    out = capsys.readouterr().out
    assert f"{path}:5: warning: <pose>: expected 6 numbers, found '0 0 1 0 0'; read as" in out
    assert main(["check_model", "--strict", path]) == 1
    assert f"{path}:5: error: <pose>" in capsys.readouterr().out
    assert main(["check_model", "--json", path]) == 0
    (issue,) = json.loads(capsys.readouterr().out)["issues"]
    assert issue["tolerated"] and issue["severity"] == "warning"


HOSTILE_XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="x" value="${[c for c in ().__class__.__base__.__subclasses__()]}"/></robot>"""


def test_xacro_outside_of_the_workspace_is_not_run_without_consent(tmp_path, monkeypatch, capsys):
    path = tmp_path / "downloads" / "r.xacro"
    path.parent.mkdir()
    path.write_text(HOSTILE_XACRO)
    inside = tmp_path / "ws" / "src" / "p"
    inside.mkdir(parents=True)
    (inside / "r.xacro").write_text(HOSTILE_XACRO)
    (inside / "link.xacro").symlink_to(path)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}/ws/src:/nowhere")
    run = []
    monkeypatch.setattr("my_simulations.cli.check_model_command.run_xacro",
                        lambda path, seconds: run.append(path) or "<robot name='r'/>")
    assert main(["check_model", str(path)]) == 1
    assert main(["check_model", str(inside / "link.xacro")]) == 1
    told = capsys.readouterr().out
    assert f"{path}: error: xacro was not run" in told and "--run-xacro" in told
    assert run == []
    main(["check_model", "--run-xacro", str(path)])
    main(["check_model", str(inside / "r.xacro")])
    assert run == [str(path), str(inside / "r.xacro")]


def test_plugins_that_nobody_brings_are_named_once(tmp_path):
    path = tmp_path / "robot.sdf"
    plugins = "".join(f'<plugin name="{name}" filename="{name}.so"/>\n' for name in (
        "libmystery", "libgazebo_ros_p3d", "libmystery"))
    camera = ('<sensor name="s" type="camera"><camera/>'
              '<plugin name="c" filename="libgazebo_ros_camera.so"/>'
              '<plugin name="u" filename="libunseen.so"/></sensor>')
    path.write_text(sdf('<model name="m"><static>1</static>\n'
                        f'<link name="l">{camera}</link>\n{plugins}</model>'))
    found = [(issue.severity, issue.line, issue.message.rpartition(" ")[2])
             for issue in check(str(path), Resolver())[1] if "plugin" in issue.message]
    assert sorted(found, key=lambda one: one[2]) == [
        (Severity.NOTE, 3, "libmystery.so"), (Severity.NOTE, 2, "libunseen.so")]


def test_a_plugin_without_effect_is_noted_with_the_reason(tmp_path):
    path = tmp_path / "robot.sdf"
    path.write_text(sdf("<model name='m'><static>1</static><link name='l'/>"
                        "<plugin name='p' filename='libLedPlugin.so'/></model>"))
    (issue,) = check(str(path), Resolver())[1]
    assert (issue.severity, issue.hint) == (Severity.NOTE, "")
    assert issue.message.endswith("has no effect: the lights stay as the file sets them")


def test_a_library_without_a_substitute_is_noted_with_the_reason_and_the_alternative(tmp_path):
    path = tmp_path / "robot.sdf"
    path.write_text(sdf("<model name='m'><static>1</static><link name='l'/>"
                        "<plugin name='p' filename='libgazebo_ros_projector.so'/></model>"))
    (issue,) = check(str(path), Resolver())[1]
    assert issue.message.endswith("libgazebo_ros_projector.so: patterns are not projected")
    assert "libgazebo_ros_openni_kinect.so" in issue.hint


PLACES = ("<model name='m'><link name='l'/>{}</model>",
          "<model name='m'><model name='n'><link name='l'/>{}</model></model>",
          "<model name='m'><link name='l'><sensor name='s' type='ray'><ray/>{}</sensor></link>"
          "</model>",
          "<model name='m'><link name='l'/><link name='o'/><joint name='j' type='fixed'>"
          "<parent>l</parent><child>o</child><sensor name='s' type='force_torque'>{}</sensor>"
          "</joint></model>",
          "<actor name='a'>{}</actor>",
          "{}")
"""Elements of a world in which plugins run."""


@pytest.mark.parametrize("place", PLACES)
def test_exactly_the_plugins_without_a_class_are_reported(tmp_path, place):
    unknown = ["libmystery.so", "libgazebo_ros_mystery.so"]
    libraries = [*BUILT_IN, *PROVIDED, *unknown]
    plugins = "".join(f"<plugin name='p' filename='{library}'/>" for library in libraries)
    path = tmp_path / "plugins.world"
    path.write_text(sdf(f"<world name='w'>{place.format(plugins)}</world>", "1.7"))
    issues = check(str(path), Resolver())[1]
    reported = [library for library in libraries
                if any(library in issue.message for issue in issues)]
    assert reported == unknown, [str(issue) for issue in issues]


def test_wind_is_not_reported_as_kept(tmp_path):
    path = tmp_path / "windy.world"
    path.write_text(sdf("<world name='w'><wind><linear_velocity>3 0 0</linear_velocity></wind>"
                        "<plugin name='p' filename='libWindPlugin.so'/></world>", "1.7"))
    assert check(str(path), Resolver())[1] == []


def test_a_world_is_found_by_its_name_and_a_similar_one_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["check_model", "lab_room.world"]) == 0
    assert "0 errors" in capsys.readouterr().out
    assert main(["check_model", "lab_rom.world"]) == 1
    out = capsys.readouterr().out
    assert "lab_rom.world: error: cannot be read" in out and "did you mean lab_room.world" in out


def test_the_summary_says_one_error_in_the_singular(capsys, tmp_path):
    path = tmp_path / "one.sdf"
    path.write_text(sdf("<model name='m'><link name='l'/><joint name='j' type='fixed'>"
                        "<parent>l</parent><child>lost</child></joint></model>", "1.7"))
    assert main(["check_model", "--strict", str(path)]) == 1
    summary = capsys.readouterr().out.splitlines()[-1]
    assert ": 1 error, 0 warnings; 1 model, 1 link, " in summary, summary
