"""Studies of scenarios: reading, cases, results of tests."""
from __future__ import annotations

import pytest

from my_simulations.errors import InputError
from my_simulations.studies.junit import results_below
from my_simulations.studies.plan import CasePlan
from my_simulations.studies.scenario_slot import launch_words
from my_simulations.studies.slot import CaseRefusedError
from my_simulations.studies.study_file import read_study
from my_simulations.studies.table import columns_of


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "test" / "deep").mkdir(parents=True)
    for name in ("b.test", "a.test", "deep/c.test"):
        (tmp_path / "test" / name).write_text(
            '<launch><arg name="speed" default="1"/><arg name="fixed" value="2"/></launch>')
    return tmp_path


def study_of(folder, text):
    (folder / "s.yaml").write_text(text)
    return read_study(str(folder / "s.yaml"))[0]


def faults_of(folder, text):
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    return [str(issue) for issue in caught.value.issues]


def test_patterns_name_scenarios_in_order_and_once(folder):
    study = study_of(folder, "scenarios: [test/a.test, 'test/*.test', 'test/**/c.test']\n")
    assert study.scenarios == ("test/a.test", "test/b.test", "test/deep/c.test")
    assert study.count == 3
    assert columns_of(study)[3:6] == ["scenario", "tests", "failures"]


def test_scenarios_of_packages_are_found(folder, monkeypatch):
    (folder / "package.xml").write_text("<package><name>my_lab</name></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    study = study_of(folder, "scenarios: package://my_lab/test/*.test\n")
    assert study.scenarios == ("package://my_lab/test/a.test", "package://my_lab/test/b.test")
    words = launch_words(CasePlan(study), CasePlan(study).case(0))
    assert words == [str(folder / "test" / "a.test")]


def test_arguments_reach_roslaunch_as_text(folder):
    study = study_of(folder, "scenarios: test/a.test\nseeds: [7]\nvary:\n"
                             "  speed: {set: arg.speed, values: [1, 0.5, fast, true]}\n")
    plan = CasePlan(study)
    assert [launch_words(plan, case)[1:] for case in plan.cases()] == [
        ["speed:=1"], ["speed:=0.5"], ["speed:=fast"], ["speed:=true"]]
    (folder / "test" / "a.test").write_text(
        '<launch><arg name="speed"/><arg name="seed"/></launch>')
    assert launch_words(plan, plan.case(0))[1:] == ["speed:=1", "seed:=7"]


def test_what_a_scenario_does_not_declare_is_refused(folder):
    study = study_of(folder, "scenarios: test/a.test\nvary:\n"
                             "  x: {set: arg.fixed, values: [1]}\n")
    plan = CasePlan(study)
    with pytest.raises(CaseRefusedError, match='no <arg name="fixed"/>'):
        launch_words(plan, plan.case(0))
    (folder / "test" / "a.test").write_text("<robot/>")
    with pytest.raises(InputError, match="<robot>, not <launch>"):
        launch_words(plan, plan.case(0))
    (folder / "test" / "a.test").unlink()
    with pytest.raises(InputError, match="there is no file"):
        launch_words(plan, plan.case(0))


def test_ids_follow_the_content_of_the_scenario(folder):
    text = "scenarios: test/*.test\n"
    before = [case.id for case in CasePlan(study_of(folder, text)).cases()]
    (folder / "test" / "a.test").write_text("<launch/>")
    after = [case.id for case in CasePlan(study_of(folder, text)).cases()]
    assert before[0] != after[0] and before[1] == after[1]


LAUNCH = """<launch><arg name="world" default="room"/>
<include file="$(find my_lab)/launch/robot.launch"/>
<arg name="world_name" value="$(find my_lab)/worlds/$(arg world).world"/>
<test pkg="my_lab" type="check.py" test-name="check"/></launch>"""
NAMED = {
    "launch/robot.launch": '<launch><param name="r" command="xacro $(dirname)/../r.xacro"/>'
                           '<rosparam file="$(find my_lab)/config/gains.yaml"/></launch>',
    "r.xacro": '<robot><xacro:include filename="wheel.xacro"/></robot>',
    "wheel.xacro": '<link><mesh filename="package://my_lab/meshes/wheel.stl"/></link>',
    "meshes/wheel.stl": "solid", "config/gains.yaml": "p: 1",
    "worlds/room.world": "<sdf version='1.6'><world name='w'><include><uri>file://box.sdf</uri>"
                         "</include></world></sdf>",
    "worlds/box.sdf": "<sdf version='1.6'><model name='m'><link name='l'/></model></sdf>",
    "nodes/check.py": "import my_lab", "src/my_lab/__init__.py": "LIMIT = 1"}


@pytest.mark.parametrize("changed", [*NAMED, "README.md"])
def test_ids_follow_the_files_that_a_scenario_names(folder, monkeypatch, changed):
    (folder / "package.xml").write_text("<package><name>my_lab</name></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    for name, text in {**NAMED, "test/a.test": LAUNCH, "README.md": "a"}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    study = study_of(folder, "scenarios: test/*.test\n")
    before = [case.id for case in CasePlan(study).cases()]
    assert [case.id for case in CasePlan(study).cases()] == before
    (folder / changed).write_text((folder / changed).read_text() + "\n ")
    after = [case.id for case in CasePlan(study).cases()]
    assert (after[0] != before[0]) == (changed != "README.md")
    assert after[1] == before[1]


@pytest.mark.parametrize("text, told", [
    ("scenarios: nothing/*.test\n", "no file is named 'nothing/*.test'"),
    ("scenarios: []\n", "must name roslaunch files"),
    ("scenarios: test/a.test\nduration: 3\n", "'duration' is of studies of worlds"),
    ("scenarios: test/a.test\nlimits: {steps: 3}\n", "unknown key 'steps'"),
    ("scenarios: test/a.test\nvary:\n  m: {set: mass.box, values: [1]}\n",
     "'mass.box' cannot be varied in a scenario"),
    ("duration: 1\nvary:\n  m: {set: arg.x, values: [1]}\n", "'arg.x' cannot be varied"),
    ("duration: 1\nlimits: {seconds: 3}\n", "unknown key 'seconds'"),
    ("scenarios: test/a.test\nvary:\n  tests: {set: arg.speed, values: [1]}\n",
     "cannot be the name of a column")])
def test_faults_name_file_and_line(folder, text, told):
    (fault,) = faults_of(folder, text)
    assert told in fault and "s.yaml:" in fault


def test_results_of_all_tests_are_counted(tmp_path):
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "rosunit-a.xml").write_text(
        '<testsuite><testcase classname="C" name="one"/><testcase classname="C" name="two">'
        '<failure type="AssertionError">2 != 3 : the robot stands\n  File "x"\n</failure>'
        "</testcase></testsuite>")
    (tmp_path / "p" / "rostest-a.xml").write_text(
        '<testsuite><testcase classname="R" name="testa"/></testsuite>')
    found = results_below(str(tmp_path))
    assert (found.tests, found.failures) == (2, 1)
    assert found.first == "C.two: 2 != 3 : the robot stands"
    assert found.junit.count(b"<testcase") == 3


def test_a_test_without_results_and_a_file_cut_off_are_failures(tmp_path):
    (tmp_path / "rostest-a.xml").write_text(
        '<testsuite><testcase classname="R" name="testa"><failure>False is not true : test [a] did'
        " not generate test results\n</failure></testcase></testsuite>")
    found = results_below(str(tmp_path))
    assert (found.tests, found.failures, found.first) == (
        1, 1, "a: test [a] did not generate test results")
    (tmp_path / "rosunit-b.xml").write_text("<testsuite><testcase")
    assert results_below(str(tmp_path)).failures == 2
    assert "rosunit-b.xml is no whole XML document" in results_below(str(tmp_path)).first
    assert results_below(str(tmp_path / "nowhere")).tests == 0


