"""Assignment files: their values, and faults that are named with their lines."""
from __future__ import annotations

import pytest

from my_simulations.description.model import Model, PluginSpec
from my_simulations.errors import InputError
from my_simulations.grading.assignment import (
    EntityCount,
    Launch,
    NoContact,
    Place,
    Requirement,
    Rostest,
    ServiceAnswer,
    TopicRate,
    ValidFile,
)
from my_simulations.grading.assignment_file import read_assignment
from my_simulations.grading.shipped import shipped_assignment, shipped_assignments
from my_simulations.grading.world_run import world_choice_of

WHOLE = """lab: lab1
submission: {world: test.world, run: go.py}
limits: {seconds: 100, processes: 20}
checks:
  - {points: 2, name: valid file, check_model: strict}
  - points: 2
    count: static
    not: [ground_plane]
    at_least: 1
  - {points: 4, place: box, at: [1, 2], within: 3, tolerance: 0.2, partial: 1}
  - {points: 4, require: "hypot(pose.robo.x-2, pose.robo.y) < 0.3", within: 20,
     partial: "1 - final(pose.robo.x) / 2"}
  - {points: 1, no_contact: [robo, wall], within: 20}
  - {points: 1, topic: cmd_vel, type: geometry_msgs/Twist, rate: 10, within: 20}
  - {points: 1, service: /go, type: std_srvs/Empty, within: 20}
  - {points: 1, launch: my_world.launch, args: "x:=1", nodes: /gazebo}
  - {points: 3, rostest: lab.test}
"""


def read(folder, text):
    (folder / "lab.test").write_text("<launch/>")
    (folder / "lab.yaml").write_text(text)
    return read_assignment(str(folder / "lab.yaml"))[0]


def faults(folder, text):
    with pytest.raises(InputError) as caught:
        read(folder, text)
    return [(issue.line, issue.code, issue.message) for issue in caught.value.issues]


def test_a_model_gets_the_namespace_of_its_entry(tmp_path):
    (tmp_path / "robot.urdf").write_text("<robot/>")
    found = read(tmp_path, """submission: {run: go.py}
world: worlds/empty.world
models:
  one: {file: robot.urdf, namespace: /}
  two: {file: robot.urdf}
checks:
  - {points: 1, place: one, at: [0, 0], within: 1}
""")
    assert [model.namespace for model in found.models] == ["/", ""]
    add_namespace = world_choice_of(found, found.world).alter_model
    given = [add_namespace(Model(name, plugins=[PluginSpec("drive", "libx.so", "<plugin/>")]))
             for name in ("one", "two", "table")]
    assert [model.plugins[0].xml for model in given] == [
        "<plugin><robotNamespace>/</robotNamespace></plugin>", "<plugin/>", "<plugin/>"]


def test_models_that_the_world_of_the_assignment_lacks_are_warned_of(tmp_path):
    (tmp_path / "robot.urdf").write_text("<robot/>")
    (tmp_path / "lab.yaml").write_text("""submission: {run: go.py}
world: worlds/empty.world
models: {one: {file: robot.urdf}}
checks:
  - {points: 1, name: right, require: "final(pose.'one::base'.x) > 0", within: 1}
  - {points: 1, name: typo, require: final(pose.won.x) > 1, partial: final(speed.one), within: 1}
  - {points: 1, name: apart, no_contact: [one, ground_plain], within: 1}
""")
    _, issues = read_assignment(str(tmp_path / "lab.yaml"))
    assert [(issue.line, issue.code) for issue in issues] == [
        (6, "grade-model-unknown"), (7, "grade-model-unknown")]
    assert issues[0].message == ("'typo' names won, which the world does not have; its models are"
                                 " ground_plane, one")
    assert "ground_plain," in issues[1].message
    spawning = (tmp_path / "lab.yaml").read_text() + "services: all\n"
    (tmp_path / "lab.yaml").write_text(spawning)
    assert read_assignment(str(tmp_path / "lab.yaml"))[1] == []


def test_a_world_of_the_assignment_that_cannot_be_read_is_a_fault(tmp_path):
    (tmp_path / "bad.world").write_text("<sdf version='1.6'><model name='m'/></sdf>")
    found = faults(tmp_path, """submission: {run: go.py}
world: bad.world
services: read
checks: [{points: 1, place: one, at: [0, 0], within: 1}]
""")
    assert [(line, code) for line, code, _ in found] == [(2, "grade-world")]
    assert "no <world>" in found[0][2]


def test_all_kinds_of_checks_are_read(tmp_path):
    found = read(tmp_path, WHOLE)
    assert (found.lab, found.points, found.limits.seconds, found.limits.processes) == (
        "lab1", 19.0, 100.0, 20)
    assert [type(check) for check in found.checks] == [
        ValidFile, EntityCount, Place, Requirement, NoContact, TopicRate, ServiceAnswer, Launch,
        Rostest]
    valid, count, place, require, apart, topic, service, launch, rostest = found.checks
    assert (valid.name, valid.strict, valid.line) == ("valid file", True, 5)
    assert (count.name, count.least, count.excluded, count.line) == (
        "count static", 1, ("ground_plane",), 6)
    assert (place.at, place.within) == ((1.0, 2.0, None), 3.0)
    assert require.require.condition and not require.partial.condition
    assert (apart.first, apart.second) == ("robo", "wall")
    assert (topic.topic, topic.rate, service.service) == ("/cmd_vel", 10.0, "/go")
    assert (launch.file, launch.nodes) == (("my_world.launch",), ("/gazebo",))
    assert rostest.file == str(tmp_path / "lab.test")


@pytest.mark.parametrize("check, message", [
    ("{points: 1, count: cats, at_least: 1}", "'count' must be one of static"),
    ("{points: 1, count: static}", "needs at_least"),
    ("{count: static, at_least: 1}", "'points' is missing"),
    ("{points: -1, count: static, at_least: 1}", "must be at least 0"),
    ("{points: 1}", "exactly one of the keys"),
    ("{points: 1, check_model: strict, count: static, at_least: 1}", "exactly one of the keys"),
    ("{points: 1, check_model: strict, witin: 3}", "unknown key 'witin'"),
    ("{points: 1, require: pose.a.x < 1}", "'within' is missing"),
    ("{points: 1, require: pose.a.x < 1, within: 1, message: [a]}",
     "'checks.1.message' must be text"),
    ("{points: 1, require: pose.a.x < 1, within: 1, message: 'at {pose.a.x}'}",
     "has a value for each sample"),
    ("{points: 1, require: pose.a.x <, within: 1}", "expected a"),
    ("{points: 1, require: final(pose.a.x), within: 1}", "takes a condition"),
    ("{points: 1, require: vary.x < 1, within: 1}", "there is no 'vary'"),
    ("{points: 1, place: a, at: [1], within: 1}", "list of 2 or 3 numbers"),
    ("{points: 1, no_contact: [a], within: 1}", "must name two models"),
    ("{points: 1, service: /go, within: 1}", "'checks.1.type' must be text"),
    ("{points: 1, rostest: none.test}", "there is no file"),
    ("{points: 1, topic: /a, type: String, within: 1}", "'String' is not a message type"),
    ("{points: 1, topic: '/a b', within: 1}", "'/a b' is not a name of ROS"),
    ("{points: 1, launch: a.launch, world: b.world}", "'world' of this check must be true"),
])
def test_faults_of_checks_have_their_lines(tmp_path, check, message):
    found = faults(tmp_path, "submission: {world: a.world}\nchecks:\n"
                             "  - {points: 1, check_model: strict}\n  - " + check + "\n")
    assert [line for line, _, text in found if message in text] == [4], found
    assert all(code.startswith("grade-") or code == "file-not-found" for _, code, _ in found)


TYPE = "submission: {{world: a.world}}\nchecks:\n  - {{points: 1, {}, within: 1}}\n"


@pytest.mark.parametrize("check, message", [
    ("topic: /a, type: std_msgs/Strnig", "the package std_msgs has no message type"),
    ("topic: /a, type: std_srvs/Empty", "the package std_srvs has no message type"),
    ("topic: /a, type: nothing_msgs/String", "the message type nothing_msgs/String cannot be"),
    ("service: /a, type: std_msgs/String", "the package std_msgs has no service type"),
    ("service: /a, type: std_srvs/Emtpy", "the package std_srvs has no service type"),
])
def test_types_that_ros_does_not_know_are_errors(tmp_path, check, message):
    pytest.importorskip("genpy")
    (line, code, text), = faults(tmp_path, TYPE.format(check))
    assert (line, code) == (3, "grade-type") and text.startswith(message)


@pytest.mark.parametrize("check, known", [
    ("topic: /a, type: std_msgs/String", True),
    ("topic: /a, type: ackermann_msgs/AckermannDrive", True),
    ("service: /a, type: std_srvs/Empty", True), ("service: /a, type: std_srvs/Emtpy", False),
    ("topic: /a, type: own_msgs/Thing", False)])
def test_types_that_cannot_be_looked_up_are_warnings(tmp_path, monkeypatch, check, known):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    (tmp_path / "lab.yaml").write_text(TYPE.format(check))
    _, issues = read_assignment(str(tmp_path / "lab.yaml"))
    assert [(issue.code, issue.line) for issue in issues] == (
        [] if known else [("grade-type-unknown", 3)])


def test_model_files_of_a_submission_are_named_by_patterns(tmp_path):
    found = read(tmp_path, "submission: {models: ['objects/*.urdf', b.sdf]}\nworld: "
                           "worlds/empty.world\nchecks:\n  - {points: 1, place: a, at: [1, 2]}\n")
    assert found.form.models == ("objects/*.urdf", "b.sdf")


RECORD = """submission: {{run: go.py}}
world: worlds/empty.world
record: {}
checks:
  - {{points: 1, place: a, at: [1, 2], within: 1}}
"""


def test_topics_and_numbers_of_them_are_recorded(tmp_path):
    names = "[/scan, cmd_vel.linear.x, /cmd_vel.angular.z, '/a.b[2].c']"
    found = read(tmp_path, RECORD.format(names))
    assert found.recorded_topics == ("/scan", "/cmd_vel", "/a")
    assert found.curves == ("/cmd_vel.linear.x", "/cmd_vel.angular.z", "/a.b[2].c")
    assert read(tmp_path, RECORD.format("/odom")).recorded_topics == ("/odom",)
    assert faults(tmp_path, RECORD.format("[/sc an]")) == [
        (3, "grade-value", "'/sc an' is neither a topic nor a number of its messages")]
    assert faults(tmp_path, RECORD.format("/scan").replace("{run: go.py}", "{}")) == [
        (3, "grade-key", "'record' needs a program: worlds alone have no topics")]


def test_faults_of_the_file_are_in_the_order_of_its_lines(tmp_path):
    checks = "  - {points: 1, check_model: strict, name: a}\n" * 2 + "  - {points: 1, count: cat}\n"
    text = "lab: a\nchecks:\n" + checks + "lab2: a\nrecord: [/a]\n"
    lines = [line for line, _, _ in faults(tmp_path, text)]
    assert len(set(lines)) > 3 and lines == sorted(lines)


def test_faults_of_the_file_are_named(tmp_path):
    assert "a mapping" in faults(tmp_path, "- 1\n")[0][2]
    assert "'checks' must be a list" in faults(tmp_path, "lab: a\n")[0][2]
    assert faults(tmp_path, "lab: a\nchecks:\n  - {points: 1, check_model: strict}\n") == [
        (3, "grade-key", "'check_model strict' needs a world")]
    assert faults(tmp_path, "checks:\n  - {points: 1, launch: a.launch, world: true}\n") == [
        (2, "grade-key", "'world' of 'launch a.launch' needs the world file of the submission")]
    twice = "  - {points: 1, check_model: strict, name: a}\n"
    assert "two checks have the name 'a'" in faults(
        tmp_path, "submission: {world: a.world}\nchecks:\n" + 2 * twice)[0][2]


def test_programs_change_a_world_with_models_of_the_assignment_only_if_it_says_so(tmp_path):
    (tmp_path / "box.sdf").write_text("<sdf version='1.6'/>")
    checks = "submission: {world: a.world}\nchecks: [{points: 1, check_model: strict}]\n"
    models = "models: {box: {file: box.sdf}}\n"
    assert read(tmp_path, checks).may_change_world
    assert not read(tmp_path, models + checks).may_change_world
    assert read(tmp_path, models + "services: all\n" + checks).may_change_world
    assert not read(tmp_path, "services: read\n" + checks).may_change_world
    assert "'services' must be read or all" in faults(tmp_path, "services: no\n" + checks)[0][2]


def test_a_folder_of_submissions_may_have_the_name_of_a_shipped_assignment(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab_sheet").mkdir()
    assert shipped_assignment("lab_sheet").endswith("assignments/lab_sheet.yaml")
    (tmp_path / "drive_square").write_text("lab: own\n")
    assert shipped_assignment("drive_square") == "drive_square"


@pytest.mark.parametrize("name", shipped_assignments())
def test_shipped_assignments_are_valid(name):
    found, issues = read_assignment(shipped_assignment(name))
    assert issues == [] and found.lab == name and found.points > 0
