"""Typical typos, and what the messages about them suggest."""
from __future__ import annotations

import os

import pytest
from reading import sdf

from my_simulations.cli import check_model_command, spawn_model
from my_simulations.errors import InputError, group_repeated
from my_simulations.formats.reading import read_entity
from my_simulations.resources.resolver import Resolver
from my_simulations.resources.suggestions import suggestion
from my_simulations.ros.lifecycle.server_options import parse


def nothing():
    return []


@pytest.mark.parametrize("uri, meant", [
    ("model:/sun", "model://sun"), ("Model://sun", "model://sun"), ("model:sun", "model://sun"),
    ("PACKAGE://a/b.dae", "package://a/b.dae"), ("http://a/b", ""), ("model://sun", "")])
def test_a_misspelt_scheme_is_put_right(uri, meant):
    assert suggestion(uri, [], nothing) == meant


def test_the_first_part_of_a_path_that_does_not_exist_is_compared_with_what_does(tmp_path):
    folder = tmp_path / "house" / "meshes"
    folder.mkdir(parents=True)
    (folder / "roof.dae").write_text("")
    for uri, tried, meant in (
            ("model://hous/meshes/roof.dae", "hous/meshes/roof.dae",
             "model://house/meshes/roof.dae"),
            ("model://house/mehses/roof.dae", "house/mehses/roof.dae",
             "model://house/meshes/roof.dae"),
            ("model://house/meshes/rof.dae", "house/meshes/rof.dae",
             "model://house/meshes/roof.dae"),
            ("model://house/meshes/zzz.dae", "house/meshes/zzz.dae", "")):
        assert suggestion(uri, [str(tmp_path / tried)], nothing) == meant


def test_a_correction_that_exists_comes_before_one_of_a_part(tmp_path):
    for path in ("tables/meshes/top.dae", "table/mesh/top.dae", "tablet/skin.png"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("")
    for uri, meant in (("model://tabel/mseh/top.dae", "model://table/mesh/top.dae"),
                       ("model://tablets/skn.png", "model://tablet/skin.png"),
                       ("model://tablets/zzz.png", "model://tablet/zzz.png")):
        assert suggestion(uri, [str(tmp_path / uri[8:])], nothing) == meant
    places = [str(tmp_path / "none" / "tablets"), str(tmp_path / "tablet" / "skn.png")]
    assert suggestion("model://tablet/skn.png", places, nothing) == "model://tablet/skin.png"


def test_a_name_that_differs_in_case_only_comes_before_others(tmp_path):
    for path in ("house/lamp/aws_Lamp_01.dae", "shop/spot/aws_spotlight_01_visual.dae",
                 "shop/spot/aws_Spotlight_02_visual.dae"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("")
    (tmp_path / "house" / "spots").mkdir()
    (tmp_path / "house" / "spots" / "aws_Spotlight_01.dae").write_text("")
    wrong = "spot/aws_Spotlight_01_visual.dae"
    places = [str(tmp_path / folder / wrong) for folder in ("house", "shop")]
    assert suggestion(f"file://{wrong}", places, nothing) == (
        "file://spot/aws_spotlight_01_visual.dae")


def test_scripts_and_textures_are_compared_with_those_beside_them(tmp_path):
    for folder, name in (("scripts", "room.material"), ("textures", "wood_floor.png")):
        (tmp_path / "materials" / folder).mkdir(parents=True)
        (tmp_path / "materials" / folder / name).write_text(
            "material Wood\n{ technique { pass { texture_unit { texture wood_flor.png } } } }")

    def hints(name):
        text = sdf('<model name="m"><link name="l"><visual name="v"><geometry><sphere><radius>1'
                   "</radius></sphere></geometry><material><script>"
                   f"<uri>materials/scripts/{name}</uri><name>Wood</name></script></material>"
                   "</visual></link></model>")
        (tmp_path / "m.sdf").write_text(text)
        _, issues = read_entity(text, Resolver(), str(tmp_path / "m.sdf"))
        return [issue.hint for issue in issues]

    (hint,) = hints("rom.material")
    assert hint.startswith("did you mean materials/scripts/room.material? Otherwise")
    assert hints("room.material") == ["did you mean wood_floor.png?"]


def test_an_unknown_package_is_compared_with_those_that_have_the_file(tmp_path):
    folders = [str(tmp_path / name) for name in ("other", "my_simulations", "my_simulation")]
    for folder in folders:
        os.mkdir(folder)
    (tmp_path / "my_simulations" / "a.dae").write_text("")
    for name, found in (("a.dae", "package://my_simulations/a.dae"), ("b.dae", "")):
        assert suggestion(f"package://my_simulatons/{name}", ["ROS package my_simulatons"],
                          lambda: folders) == found


def test_the_log_has_one_line_for_all_visuals_of_an_unknown_package():
    links = "".join(f'<link name="{name}"><visual><geometry><mesh filename="package://gone/{name}'
                    '.stl"/></geometry></visual></link>\n' for name in "abc")
    _, issues = read_entity(f'<robot name="r">{links}</robot>', Resolver())
    (issue,) = group_repeated(one for one in issues if one.code == "mesh-not-found")
    assert issue.message == ("the mesh of this visual is in the ROS package 'gone', which was not"
                             " found; also in lines 2, 3")


def test_the_log_has_one_line_for_all_visuals_of_an_unknown_model():
    visuals = "".join(f'<visual name="{name}"><geometry><mesh><uri>model://gone/{name}.dae</uri>'
                      "</mesh></geometry></visual>\n" for name in "abc")
    _, issues = read_entity(sdf(f'<model name="m"><link name="l">{visuals}</link></model>'),
                            Resolver())
    (issue,) = group_repeated(one for one in issues if one.code == "mesh-not-found")
    assert issue.message == ("the mesh of this visual is in the model 'gone', which was not found;"
                             " also in lines 2, 3")


@pytest.mark.parametrize("name, meant", [("iyx", "ixy"), ("izx", "ixz"), ("izy", "iyz")])
def test_the_other_half_of_an_inertia_tensor_is_compared_with_the_first(name, meant):
    _, issues = read_entity('<robot name="r"><link name="l"><inertial><mass value="1"/><inertia'
                            f' ixx="1" iyy="1" izz="1" {name}="0"/></inertial></link></robot>',
                            Resolver())
    assert [issue.hint for issue in issues] == [f"did you mean {meant}?"]


def test_an_unknown_part_of_a_robot_is_told_how_macros_are_called():
    _, issues = read_entity('<robot name="r"><link name="l"/><table_leg x="1"/><jont/></robot>',
                            Resolver())
    assert [i.hint for i in issues if i.code == "unknown-element"] == [
        "call a macro of xacro with the prefix: <xacro:table_leg>", "did you mean joint?"]


def test_a_mesh_that_is_not_there_is_answered_with_one_that_is(tmp_path):
    (tmp_path / "part.stl").write_text("")
    text = sdf('<model name="m"><link name="l"><visual name="v"><geometry><mesh><uri>'
               f"{tmp_path}/prat.stl</uri></mesh></geometry></visual></link></model>")
    _, issues = read_entity(text, Resolver())
    assert issues[0].hint.startswith(f"did you mean {tmp_path}/part.stl? Otherwise check the path")


def test_a_joint_at_a_misspelt_link_is_answered_with_the_link():
    text = sdf('<model name="m"><link name="base"/><link name="tip"/><joint name="j" type="fixed">'
               "<parent>bsae</parent><child>tip</child></joint></model>")
    _, issues = read_entity(text, Resolver())
    assert issues[0].hint == "did you mean base?"


def test_numbers_that_are_parted_by_commas_are_told_how_to_be():
    text = ('<robot name="r"><link name="l"><collision><geometry><box size="1,1,1"/></geometry>'
            "</collision></link></robot>")
    try:
        _, issues = read_entity(text, Resolver())
    except InputError as refused:
        issues = refused.issues
    assert any("separated by spaces, not by commas" in issue.message for issue in issues)


@pytest.mark.parametrize("run, meant", [
    (lambda: parse(["--puase"]), "did you mean --pause?"),
    (lambda: parse(["--seed", "x"]), "'x' is not a number"),
    (lambda: parse(["--iters", "many"]), "'many' is not a number of steps"),
    (lambda: parse(["--record_period", "1,5"]), "use a decimal point"),
    (lambda: check_model_command.main(["check_model", "--jsn", "a"]), "did you mean --json?"),
    (lambda: spawn_model.main(["spawn_model", "-urdf", "-param", "p", "-model", "m", "-x", "1,5"]),
     "'1,5' is not a number; use a decimal point"),
    (lambda: spawn_model.main(["spawn_model", "-urdf", "-param", "p", "-model", "m", "-timeut",
                               "5"]), "did you mean -timeout?")])
def test_a_wrong_word_of_a_command_line_is_answered_with_the_right_one(run, meant, capsys):
    with pytest.raises(SystemExit) as ended:
        run()
    assert ended.value.code == 2
    assert meant in capsys.readouterr().err
