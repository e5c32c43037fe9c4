from __future__ import annotations

import argparse
import io
import os

import pytest

from my_simulations.cli import move_object, spawn_object
from my_simulations.cli.loaded_list import storable_entries
from my_simulations.cli.object_client import full_name, split_command_line
from my_simulations.cli.progress import Progress, bar
from my_simulations.cli.remove_object import chosen_models
from my_simulations.errors import InputError
from my_simulations.objects.motion_path import Circle, Polygon
from my_simulations.objects.object_documents import Documents, locate, run_xacro
from my_simulations.objects.object_list import parse_objects, world_name
from my_simulations.objects.yaml_source import Source

SOURCE = Source("/objects")


def entry(model="somewhere/ball.urdf"):
    return {"model": model, "position": [0, 0, 0], "orientation": [0, 0, 0]}


def placed(model):
    return parse_objects({"thing": entry(model)}, SOURCE).objects["thing"]


class Terminal(io.StringIO):
    def isatty(self):
        return True


def shown(total, err):
    out = io.StringIO()
    progress = Progress(total, out, err)
    for n in range(total):
        progress.start(f"object_{n}")
        if n == 3:
            progress.failed("object_3 went wrong")
        else:
            progress.done(f"object_{n} done")
    progress.end("the end")
    return out.getvalue(), err.getvalue()


def test_a_bar_shows_on_a_terminal_when_there_is_much_to_do():
    out, err = shown(20, Terminal())
    assert "10/20 object_10" in err
    assert "object_3 went wrong" in err
    assert out == "the end\n"


@pytest.mark.parametrize("total,err", [(20, io.StringIO()), (5, Terminal())])
def test_plain_lines_show_elsewhere_and_for_a_few(total, err):
    out, errors = shown(total, err)
    assert out.splitlines() == [f"object_{n} done" for n in range(total) if n != 3]
    assert errors == "object_3 went wrong\n"


@pytest.mark.parametrize("columns", [1, 20, 80, 300])
@pytest.mark.parametrize("done", [0, 7, 40])
def test_a_bar_fits_its_terminal_and_is_full_at_the_end(columns, done):
    line = bar(done, 40, "a_rather_long_name_of_an_object", columns)
    assert len(line) < max(2, columns)
    if columns >= 80:
        assert ("." not in line.split("]")[0]) == (done == 40)


def test_ros_words_are_kept_apart_from_names():
    words, remappings = split_command_line(["tool", "MY_OBJECT", "__name:=x", "_p:=1", "all"])
    assert (words, remappings) == (["MY_OBJECT", "all"], ["__name:=x", "_p:=1"])


@pytest.mark.parametrize("name,remappings,full", [
    ("gazebo", [], "/gazebo"), ("gazebo", ["__ns:=/robots/"], "/robots/gazebo"),
    ("gazebo", ["__name:=spawner"], "/gazebo"), ("/there/", ["__ns:=a"], "/there")])
def test_the_simulators_name_is_taken_in_the_tools_namespace(name, remappings, full, monkeypatch):
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)
    assert full_name(name, remappings) == full


def test_models_of_the_world_are_removed_also_when_no_list_has_them():
    listing = parse_objects({"ball": entry(), "shelf": entry()}, SOURCE)
    world = ["ground_plane", "stranger", "ball"]
    assert chosen_models(["stranger", "ball", "ball"], world, listing, {}) == (
        ["stranger", "ball"], [])


def test_all_removes_what_is_there_of_the_list_and_nothing_else():
    listing = parse_objects({"ball": entry(), "shelf": entry()}, SOURCE)
    assert chosen_models(["all"], ["ground_plane", "ball"], listing, {}) == (["ball"], [])


def test_a_faulty_entry_does_not_keep_its_model_in_the_world():
    listing = parse_objects({"ball": {}}, SOURCE)
    assert chosen_models(["all"], ["ball"], listing, {}) == (["ball"], [])


def test_a_group_removes_its_members_in_either_order_of_their_names():
    child = {"shelf": {**entry(), "children": {"tin": entry()}}}
    listing = parse_objects(child, SOURCE)
    groups = {"tins": ["tin_shelf", "gone"]}
    assert chosen_models(["tins"], ["shelf_tin"], listing, groups) == (["shelf_tin"], [])


def test_a_name_that_is_not_in_the_world_is_an_error_with_the_closest():
    names, issues = chosen_models(["bal"], ["ball"], parse_objects({}, SOURCE), {})
    assert names == []
    assert issues[0].code == "unknown-object" and "ball" in issues[0].hint


@pytest.mark.parametrize("world,name", [
    ("", ""), ("test", "test"), ("/a/b/test.world", "test"), ("worlds/empty.world", "empty"),
    ("room.sdf", "room"), ("hall.v2", "hall.v2")])
def test_a_worlds_name_is_the_base_name_of_its_file(world, name):
    assert world_name(world) == name


@pytest.mark.parametrize("value", [{1: 2}, 2 ** 40, {"a": [None]}])
def test_an_entry_that_no_parameter_can_hold_is_an_error_and_the_rest_is_kept(value):
    kept, issues = storable_entries({"bad": value, "good": entry()}, SOURCE.where)
    assert kept == {"good": entry()}
    assert [(i.code, i.xpath) for i in issues] == [("not-a-parameter", "/objects/bad")]


def test_an_entry_without_a_value_is_left_to_the_reader_of_the_list():
    assert storable_entries({"bad": None, "good": entry()}, SOURCE.where) == ({"good": entry()}, [])


def options(*words):
    return move_object.parser().parse_args(list(words))


def test_the_modes_of_move_object_read_their_options():
    pose = move_object.target_of(options("-m", "initialpose", "-n", "a", "-i", "[1,2,3,0,0,0]"))
    assert pose.position == (1.0, 2.0, 3.0)
    assert isinstance(move_object.target_of(
        options("-m", "polygon", "-n", "a", "-p", "[[0,0],[1,0]]")), Polygon)
    assert isinstance(move_object.target_of(
        options("-m", "circle", "-n", "a", "-c", "[0,0]", "-r", "2")), Circle)


@pytest.mark.parametrize("words", [
    ["-m", "initialpose"], ["-m", "polygon"], ["-m", "circle", "-c", "[0,0]"],
    ["-m", "circle", "-r", "1"], ["-m", "initialpose", "-i", "[1,2]"],
    ["-m", "polygon", "-p", "[[0,0],[1,0]]", "-v", "0"],
    ["-m", "polygon", "-p", "[[0,0],[1,0]]", "-v", "nan"],
    ["-m", "polygon", "-p", "[[0,0],[1,0]]", "--laps", "-1"]])
def test_move_object_refuses_what_its_mode_cannot_use(words):
    with pytest.raises(InputError):
        move_object.target_of(options("-n", "a", *words))
    with pytest.raises(SystemExit) as ended:
        move_object.main(["move_object.py", "-n", "a", *words])
    assert ended.value.code == 2


@pytest.mark.parametrize("words,code", [([], 2), (["--nothing"], 2), (["--help"], 0),
                                        (["--timeout", "nan", "a"], 2)])
def test_usage_ends_with_its_exit_code(words, code, capsys):
    with pytest.raises(SystemExit) as ended:
        spawn_object.main(["spawn_object.py", *words])
    assert ended.value.code == code


def test_without_a_master_the_tool_fails_and_names_it(monkeypatch, capsys):
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    assert spawn_object.main(["spawn_object.py", "MY_OBJECT"]) == 1
    assert "no ROS master at http://127.0.0.1:1" in capsys.readouterr().err


def test_an_objects_document_comes_from_its_package(tmp_path):
    (tmp_path / "ball.urdf").write_text("<robot name='b'/>")
    (tmp_path / "box.sdf").write_text("<sdf/>")
    (tmp_path / "odd.sdf").write_text("<!-- URDF in an .sdf --><robot/>")

    def find(name):
        return str(tmp_path) if name == "somewhere" else None

    objects = [placed(f"somewhere/{file}") for file in ("ball.urdf", "box.sdf", "odd.sdf")]
    with Documents(objects, find, 5.0) as documents:
        ball, box, odd = (documents.of(one) for one in objects)
    assert (ball.xml, ball.sdf, ball.path) == ("<robot name='b'/>", False,
                                               str(tmp_path / "ball.urdf"))
    assert (box.xml, box.sdf, odd.sdf) == ("<sdf/>", True, False)
    with pytest.raises(InputError) as caught:
        locate(placed("somewhere/none.urdf"), find)
    assert caught.value.issues[0].code == "object-file-missing"
    with pytest.raises(InputError) as caught:
        locate(placed("nowhere/ball.urdf"), find)
    assert caught.value.issues[0].code == "unknown-package"


def test_an_entry_without_a_package_is_of_its_lists_and_another_file_of_the_name_is_named(tmp_path):
    files = {}
    for package in ("theirs", "my_simulations"):
        for name in (["A", "B"] if package == "my_simulations" else ["A"]):
            files[package, name] = tmp_path / package / "objects" / f"{name}.urdf"
            files[package, name].parent.mkdir(parents=True, exist_ok=True)
            files[package, name].write_text("<robot/>")
    tree = {name: {"model": name, "model_type": "urdf", "position": [0, 0, 0],
                   "orientation": [0, 0, 0]} for name in ("A", "B", "C")}
    listing = parse_objects(tree, Source("/objects"), "theirs")

    def find(name):
        return str(tmp_path / name)

    assert locate(listing.objects["A"], find) == (
        str(files["theirs", "A"]), str(files["my_simulations", "A"]))
    assert locate(listing.objects["B"], find) == (str(files["my_simulations", "B"]), "")
    with pytest.raises(InputError) as caught:
        locate(listing.objects["C"], find)
    assert "theirs/objects/C.urdf, " in caught.value.issues[0].message
    assert "--package" in caught.value.issues[0].hint
    os.unlink(files["my_simulations", "A"])
    os.symlink(files["theirs", "A"], files["my_simulations", "A"])
    assert locate(listing.objects["A"], find) == (str(files["theirs", "A"]), "")


def test_xacro_runs_and_its_faults_are_input_errors(tmp_path):
    ns = "xmlns:xacro='http://www.ros.org/wiki/xacro'"
    good = tmp_path / "good.urdf.xacro"
    good.write_text(f"<robot name='a' {ns}><link name='${{1 + 1}}'/></robot>")
    assert 'name="2"' in run_xacro(str(good), 20.0)
    bad = tmp_path / "bad.urdf.xacro"
    bad.write_text(f"<robot name='a' {ns}><link name='${{missing}}'/></robot>")
    with pytest.raises(InputError) as caught:
        run_xacro(str(bad), 20.0)
    issue = caught.value.issues[0]
    assert (issue.code, issue.file) == ("xacro-failed", str(bad))
    assert "missing" in issue.message


def test_the_file_of_many_objects_goes_through_xacro_once_and_its_fault_meets_each(tmp_path):
    ns = "xmlns:xacro='http://www.ros.org/wiki/xacro'"
    good, bad = tmp_path / "good.xacro", tmp_path / "bad.xacro"
    good.write_text(f"<robot name='a' {ns}/>")
    bad.write_text(f"<robot name='${{missing}}' {ns}/>")
    objects = [placed(f"somewhere/{file.name}") for file in (good, bad, good, bad)]
    with Documents(objects, lambda name: str(tmp_path), 20.0) as documents:
        first = documents.of(objects[0])
        good.write_text("")
        assert documents.of(objects[2]) == first
        for wrong in (objects[1], objects[3]):
            with pytest.raises(InputError):
                documents.of(wrong)


def test_a_module_named_xacro_in_the_current_folder_is_not_run(tmp_path, monkeypatch):
    (tmp_path / "xacro.py").write_text("raise SystemExit('not this one')\n")
    (tmp_path / "a.xacro").write_text("<robot name='a'/>")
    monkeypatch.chdir(tmp_path)
    assert "<robot" in run_xacro(str(tmp_path / "a.xacro"), 20.0)


def test_a_number_of_seconds_is_positive_and_finite():
    from my_simulations.cli.object_client import parse_seconds

    assert parse_seconds("2.5") == 2.5
    for text in ("0", "-1", "inf", "nan"):
        with pytest.raises(argparse.ArgumentTypeError):
            parse_seconds(text)
