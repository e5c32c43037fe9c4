"""Grading of programs: what a program does changes its own mark only."""
from __future__ import annotations

import ast
import contextlib
import csv
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from box_program import box_program
from replay_content import replay_content
from waiting import wait_for

from my_simulations.grading import box, cell
from my_simulations.grading.box_support import isolation_fault
from my_simulations.grading.grader import reserve_slots
from my_simulations.grading.program import submission_account

REPOSITORY = Path(__file__).resolve().parents[2]
GRADE = [sys.executable, str(REPOSITORY / "scripts" / "grade")]
SECONDS = 900.0

BOX = REPOSITORY / "examples" / "friction_study_box.sdf"
MODELS = f"models:\n  box: {{file: {BOX}, pose: [0, 0, 0.1]}}\nservices: all\n"
DRIVE = f"""lab: drive
submission: {{run: go.py}}
world: worlds/empty.world
{MODELS}checks:
  - {{points: 4, name: goal, require: "hypot(pose.box.x - 1, pose.box.y) < 0.05", within: 2,
     partial: final(pose.box.x)}}
  - {{points: 2, name: talks, topic: /chat, type: std_msgs/String, rate: 20, within: 2}}
  - {{points: 1, name: type, topic: /chat, type: std_msgs/Int32, within: 2}}
  - {{points: 1, name: answers, service: /go, type: std_srvs/Empty, within: 2}}
  - {{points: 1, name: missing, service: /missing, type: std_srvs/Empty, within: 2}}
"""
SERVICE = 'rospy.Service("/go", Empty, lambda _: EmptyResponse())'
GO, HALF = (box_program(f"min({goal}, state.pose.position.x + 0.05)", SERVICE)
            for goal in (1.0, 0.5))
ROBOT = f"""submission: {{run: go.py}}
world: worlds/empty.world
models: {{robo: {{file: {REPOSITORY / "urdf" / "robo.urdf"}}}}}
checks:
  - {{points: 2, name: moves, require: pose.robo.x > 0.2, within: 2}}
  - {{points: 1, name: odometry, topic: /odom, type: nav_msgs/Odometry, rate: 10, within: 2}}
  - {{points: 1, name: twice, topic: /odom, rate: 80, within: 2}}
  - {{points: 1, name: falls, require: pose.robo.z > 1, within: 2}}
  - {{points: 1000, name: way, require: pose.robo.x > 5, within: 2, partial: final(pose.robo.x)}}
"""
DRIVER = """import rospy
from geometry_msgs.msg import Twist

rospy.init_node("driver")
command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
rate = rospy.Rate(10)
twist = Twist()
twist.linear.x = 0.3
while not rospy.is_shutdown():
    command.publish(twist)
    rate.sleep()
"""
FEEDBACK = """import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

rospy.init_node("feedback")
command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
def follow(odometry):
    twist = Twist()
    twist.linear.x = 0.5 - 0.5 * odometry.pose.pose.position.x
    twist.angular.z = 0.2
    command.publish(twist)
rospy.Subscriber("/odom", Odometry, follow)
rospy.spin()
"""
QUICK = f"""submission: {{run: go.py}}
world: worlds/empty.world
{MODELS}checks:
  - {{points: 4, name: moved, require: pose.box.x > 0.1, within: 0.3}}
  - {{points: 2, name: talks, topic: /chat, rate: 20, within: 0.3}}
"""
RECORD = f"""{MODELS}record: [/chat, /numbers.data, /odd, /never]
checks:
  - {{points: 1, name: talks, topic: /numbers, type: std_msgs/Float64, within: 2}}
"""
TALK = """import rospy
from std_msgs.msg import Float64, String

rospy.init_node("talk")
chat = rospy.Publisher("/chat", String, queue_size=10)
numbers = rospy.Publisher("/numbers", Float64, queue_size=10)
rate = rospy.Rate(20)
while not rospy.is_shutdown():
    chat.publish("here")
    numbers.publish(rospy.get_time())
    rate.sleep()
"""
LIMITS = ("limits: {processor_seconds: 20, memory_mb: 1000, processes: 100, file_mb: 50}\n")
LAUNCH = """lab: launch
checks:
  - {points: 2, name: launch, launch: my_world.launch, args: "gui:=false", nodes: /gazebo,
     seconds: 1}
  - {points: 4, name: test, rostest: lab.test}
"""
TEST = """<launch>
  <arg name="submission"/>
  <param name="folder" value="$(arg submission)"/>
  <test test-name="there" pkg="rostest" type="paramtest" time-limit="60">
    <param name="param_name_target" value="/folder"/><param name="test_duration" value="0.5"/>
  </test>
  <test test-name="missing" pkg="rostest" type="paramtest" time-limit="60">
    <param name="param_name_target" value="/nothing"/><param name="test_duration" value="0.5"/>
  </test>
</launch>
"""


def grade(folder, text, programs, *words, name="go.py", status=0):
    """Grade programs by name; returns their rows and the folder of the students."""
    (folder / "lab.yaml").write_text(text)
    for student, program in programs.items():
        (folder / student).mkdir(exist_ok=True)
        (folder / student / name).write_text(program)
    done = subprocess.run([*GRADE, "lab.yaml", *programs, "--out", "marks", *words], cwd=folder,
                          text=True, timeout=SECONDS, capture_output=True)
    assert done.returncode == status, done.stderr
    with open(folder / "marks" / "marks.csv", newline="") as stream:
        rows = {row["student"]: row for row in csv.DictReader(stream)}
    return rows, folder / "marks" / "students"


def programs_below(pid):
    """The processes below one that run a submission."""
    found = []
    for below in box.descendants(pid):
        with contextlib.suppress(OSError):
            words = Path(f"/proc/{below}/cmdline").read_bytes().split(b"\0")
            found += [below] if words[1:2] and words[1].endswith(b"submission/go.py") else []
    return found


def points(row, *names):
    return [float(row[name]) for name in names]


@pytest.mark.parametrize("words", [(), ("--no-isolation",)], ids=["isolated", "ordinary"])
def test_a_program_is_marked_for_what_it_does_in_sim_time(tmp_path, words):
    rows, students = grade(tmp_path, DRIVE, {"good": GO, "half": HALF}, *words)
    names = ("goal", "talks", "type", "answers", "missing")
    assert points(rows["good"], *names) == [4, 2, 0, 1, 0], students
    assert points(rows["half"], *names) == [2, 2, 0, 1, 0]
    said = json.loads((students / "half" / "results.json").read_text())["tests"]
    assert "% of the points" in said[0]["output"] and "std_msgs/String" in said[2]["output"]
    assert said[4]["output"].startswith("no node offers the service /missing")
    assert 'id="data"' in (students / "good" / "replay.html").read_text(encoding="utf-8")


def test_a_robot_is_driven_by_its_topic_and_its_plugins_run_once(tmp_path):
    rows, _ = grade(tmp_path, ROBOT, {"driver": DRIVER, "other": DRIVER}, "--jobs", "2")
    assert points(rows["driver"], "moves", "odometry", "twice", "falls") == [2, 1, 0, 0]
    assert 150.0 < points(rows["driver"], "way")[0] < 700.0
    # Also the first command, which is published before a subscriber has connected, is lost in both.
    assert points(rows["other"], "way") == points(rows["driver"], "way")


def test_a_topic_that_nothing_reads_is_named_with_the_one_that_is_meant(tmp_path):
    rows, students = grade(tmp_path, ROBOT, {"lost": DRIVER.replace("/cmd_vel", "/robo/cmd_vel")})
    assert points(rows["lost"], "moves") == [0]
    assert json.loads((students / "lost" / "mark.json").read_text())["notes"] == [
        "the program publishes /robo/cmd_vel, which nothing subscribes to; did you mean /cmd_vel?"]


def test_programs_that_answer_messages_get_equal_marks_beside_busy_processes(tmp_path):
    names = ("one", "two", "three", "four")
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(4)]
    try:
        rows, _ = grade(tmp_path, ROBOT, {name: FEEDBACK for name in names}, "--jobs", "2")
    finally:
        for process in busy:
            process.kill()
            process.wait()
    for name in names:
        assert points(rows[name], "moves", "odometry") == [2, 1]
        assert points(rows[name], "way") == points(rows["one"], "way")


def test_the_replay_contains_topics_of_the_assignment(tmp_path):
    world = "submission: {run: go.py}\nworld: worlds/empty.world\n"
    rows, students = grade(tmp_path, world + RECORD, {"talk": TALK})
    assert points(rows["talk"], "talks") == [1]
    head, messages = replay_content(students / "talk" / "replay.html", tmp_path / "state.log")
    assert head["curves"] == ["/numbers.data"]
    assert set(messages) == {"/chat", "/numbers"}
    times = [float(view["text"].partition(": ")[2]) for view in messages["/numbers"]]
    assert len(times) > 8 and times == sorted(times) and times[-1] > 1.5


def test_each_lost_point_has_the_line_of_the_fault_of_the_program(tmp_path):
    limits = "limits: {processor_seconds: 8}\n"
    rows, students = grade(tmp_path, limits + QUICK, {"loop": "x = 1\nwhile True:\n    x += 1\n",
                                                      "typo": "def f(:\n", "idle": "pass\n"})
    pages = {name: (students / name / "index.html").read_text() for name in rows}
    assert all(points(row, "moved", "talks") == [0, 0] for row in rows.values())
    assert (pages["loop"].count("<code>go.py:2</code>")
            + pages["loop"].count("<code>go.py:3</code>")) == 2, pages["loop"]
    assert pages["loop"].count("the program computes without a pause") == 1
    assert pages["typo"].count("<code>go.py:1</code>") == 2, pages["typo"]
    assert pages["typo"].count("go.py:1: SyntaxError") == 1
    assert "&gt; 0.1; pose.box.x is " in pages["idle"]


def test_a_program_that_ends_is_mentioned_only_if_points_are_lost(tmp_path):
    text = f"""submission: {{run: go.py}}
world: worlds/empty.world
{MODELS}checks:
  - {{points: 1, name: talks, topic: /chat, type: std_msgs/String, within: 1.5}}
"""
    talk = TALK.replace("while not rospy.is_shutdown():", "for _ in range(20):")
    silent = talk.replace("chat.", "None and ")
    _, students = grade(tmp_path, text, {"good": talk, "silent": silent})
    notes = {name: json.loads((students / name / "mark.json").read_text())["notes"]
             for name in ("good", "silent")}
    assert notes == {"good": [], "silent": ["the program ended during the run, without an error"]}


def test_a_script_that_an_archive_has_changed_runs(tmp_path):
    line = "rosparam set /gazebo/changed 1; rostopic pub -r 30 /chat std_msgs/String here\n"
    rows, students = grade(tmp_path, QUICK.replace("go.py", "go.sh"), {
        "bare": line, "windows": "#!/bin/sh\r\n" + line}, name="go.sh")
    bare, windows = ((students / name / "index.html").read_text() for name in rows)
    assert "go.sh is not executable and was run nevertheless: use chmod +x go.sh" in bare
    assert points(rows["bare"], "talks") == [2], bare
    assert "go.sh has line ends of Windows" in windows


def test_a_program_that_cannot_be_read_is_named(tmp_path):
    (tmp_path / "anna").mkdir()
    (tmp_path / "anna" / "helper.py").touch(0)
    (tmp_path / "ben").mkdir()
    (tmp_path / "ben" / "go.py").touch(0)
    (tmp_path / "ben" / "read me.txt").touch()
    (tmp_path / "lab.yaml").write_text(QUICK)
    (tmp_path / "anna" / "go.py").write_text("import helper\n")
    done = subprocess.run([*GRADE, "lab.yaml", "anna", "ben", "--out", "marks"], cwd=tmp_path,
                          text=True, timeout=SECONDS, capture_output=True)
    assert done.returncode == 0, done.stderr
    anna, ben = ((tmp_path / "marks" / "students" / name / "index.html").read_text()
                 for name in ("anna", "ben"))
    assert "their permissions forbid reading: helper.py" in anna
    assert "go.py:1: ModuleNotFoundError" in anna
    assert ben.count("the world does not run: go.py cannot be read: its permissions forbid it") == 1


def test_a_program_that_exceeds_its_processor_time_is_told_so(tmp_path):
    limits = "limits: {processor_seconds: 1}\n"
    rows, students = grade(tmp_path, limits + QUICK.replace("within: 0.3", "within: 3"),
                           {"anna": "while True: pass\n"})
    assert points(rows["anna"], "moved", "talks") == [0, 0]
    page = (students / "anna" / "index.html").read_text()
    assert "the program used more processor time than 1 s" in page


def test_a_program_reaches_what_it_needs_below_a_closed_folder_and_nothing_else(tmp_path):
    closed = tmp_path / "closed"
    (closed / "ws" / "src").mkdir(parents=True)
    (closed / "ws" / "src" / "package.py").write_text("there")
    (closed / "one.txt").write_text("one")
    (closed / "secret.txt").write_text("secret")
    closed.chmod(0o700)
    (tmp_path / "judge").mkdir()
    tmp_path.chmod(0o755)
    wanted = [str(closed / name) for name in ("ws/src/package.py", "one.txt")]
    code = "import os\nprint([open(name).read() for name in {!r}], os.listdir({!r}))"
    spec = {"parent": os.getpid(), "command": ["/usr/bin/python3", "-c", code.format(
                wanted, str(closed))],   # that of the workspace may be below a closed folder
            "environment": dict(os.environ), "cwd": "/", "user": 0,
            "private": [str(tmp_path / "judge")], "needed": [str(closed / "ws"), wanted[1]],
            "bytes": 1 << 20, "memory_bytes": 1 << 30, "processor_seconds": 20, "processes": 50}
    with reserve_slots(1) as slots:
        spec["user"] = submission_account(str(tmp_path), slots[0]).user
        done = subprocess.run([sys.executable, "-I", cell.__file__, json.dumps(spec)],
                              capture_output=True, text=True, timeout=SECONDS)
    assert done.stdout.startswith("['there', 'one']"), done.stderr
    if os.getuid() == 0:
        assert sorted(ast.literal_eval(done.stdout.partition("] ")[2])) == ["one.txt", "ws"]


def test_an_interrupt_ends_all_programs(tmp_path):
    (tmp_path / "lab.yaml").write_text(LIMITS + QUICK)
    (tmp_path / "loop").mkdir()
    program = tmp_path / "loop" / "go.py"
    program.write_text("while True: pass\n")
    process = subprocess.Popen([*GRADE, "lab.yaml", "loop"], cwd=tmp_path,
                               stderr=subprocess.PIPE, text=True)
    pids = wait_for(lambda: programs_below(process.pid), "the program", SECONDS)
    process.send_signal(signal.SIGINT)
    assert process.wait(SECONDS) == 130, process.stderr.read()
    process.stderr.close()
    wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in pids), "its end", SECONDS)


def test_a_submission_that_takes_too_long_has_the_output_and_the_replay_until_then(tmp_path):
    text = QUICK.replace("name: talks", "name: long").replace("rate: 20, within: 0.3",
                                                              "within: 1000")
    program = TALK.replace("rate = rospy", 'print("started", flush=True)\nrate = rospy')
    rows, students = grade(tmp_path, "limits: {seconds: 8}\n" + text, {"late": program}, status=1)
    mark = json.loads((students / "late" / "mark.json").read_text())
    assert mark["status"] == "timed out" and points(rows["late"], "moved", "long") == [0, 0]
    assert mark["results"][1]["reason"] == "not finished within 8 s of wall time"
    assert (students / "late" / "output.txt").read_text().splitlines() == ["started"]
    assert {"replay.html", "picture.png"} <= set(mark["files"])


def test_launch_files_and_rostests_are_run(tmp_path):
    (tmp_path / "lab.test").write_text(TEST)
    launch = (REPOSITORY / "launch" / "my_world.launch").read_text()
    (tmp_path / "good" / "old").mkdir(parents=True)
    (tmp_path / "good" / "old" / "my_world.launch").write_text("<launch/>")
    rows, students = grade(tmp_path, LAUNCH, {
        "good": launch, "broken": launch.replace("empty_world.launch", "nothing.launch"),
        "self": "<launch><include file='$(dirname)/my_world.launch'/></launch>"},
        name="my_world.launch")
    assert points(rows["good"], "launch", "test") == [2, 2]
    assert points(rows["broken"], "launch", "test") == [0, 2]
    found = json.loads((students / "broken" / "results.json").read_text())["tests"]
    assert "nothing.launch" in found[0]["output"]
    assert found[1]["output"].startswith("1 of 2 tests passed")
    own = json.loads((students / "self" / "mark.json").read_text())["results"][0]
    assert own["reason"] == "my_world.launch includes itself, directly or by another file"
    assert ("my_world.launch was graded, which has the fewest folders and then the first name;"
            " the submission contains more files that fit my_world.launch: old/my_world.launch"
            ) in (students / "good" / "index.html").read_text()
    assert sorted(os.listdir(tmp_path / "good")) == ["my_world.launch", "old"]


WORLD = """<sdf version="1.6"><world name="default"><model name="ground_plane"><static>1</static>
<link name="l"><collision name="c"><geometry><plane/></geometry></collision></link></model>
</world></sdf>"""
STARTED = """<launch>
  <include file="$(find my_simulations)/launch/world.launch">
    <arg name="world" value="$(dirname)/{}.world"/><arg name="gui" value="false"/>
  </include>
</launch>
"""
FAKE = """<launch>
  <node name="gazebo" pkg="fake" type="gzserver" args="$(dirname)/test.world"/>
</launch>
"""
PRELOADED = STARTED.format("test").replace("<launch>", """<launch>
  <env name="PYTHONPATH" value="$(dirname):$(env PYTHONPATH)"/>""")


def test_the_simulator_has_loaded_the_world_of_the_submission(tmp_path):
    programs = {"good": STARTED.format("test"), "other": STARTED.format("second"), "fake": FAKE,
                "preloaded": PRELOADED}
    for student in programs:
        (tmp_path / student).mkdir()
        for name in ("test", "second"):
            (tmp_path / student / f"{name}.world").write_text(WORLD)
    package = tmp_path / "fake" / "fake"
    package.mkdir()
    (package / "package.xml").write_text(PACKAGE.format("fake"))
    (package / "gzserver").write_text("#!/usr/bin/env python3\nimport rospy\n"
                                      "rospy.init_node('gazebo')\nrospy.spin()\n")
    (package / "gzserver").chmod(0o755)
    rows, students = grade(tmp_path, """submission: {world: test.world}
checks: [{points: 2, name: launch, launch: go.launch, world: true, seconds: 1}]
""", programs, name="go.launch")
    said = {student: json.loads((students / student / "results.json").read_text())["tests"][0].get(
        "output", "") for student in programs}
    assert {student: points(row, "launch") for student, row in rows.items()} == {
        "good": [2], "other": [0], "fake": [0], "preloaded": [0]}, said
    assert "runs the world second.world, not test.world of the submission" in said["other"]
    for student in ("fake", "preloaded"):
        assert "the node /gazebo is not the simulator" in said[student]


FORGED = """<launch>
  <arg name="submission"/>
  <include file="$(arg submission)/go.launch"/>
  <test test-name="missing" pkg="rostest" type="paramtest" time-limit="60">
    <param name="param_name_target" value="/nothing"/><param name="test_duration" value="6"/>
  </test>
</launch>
"""
FORGER = """#!/usr/bin/env python3
import pathlib, time
good = '<testsuite tests="1" failures="0" errors="0"><testcase name="t" classname="c"/></testsuite>'
scratch = pathlib.Path(__file__).resolve().parents[2]
until = time.monotonic() + 5.0
while time.monotonic() < until:
    for folder in ["home/results", "home/results/grade", "tests/results/grade", "tests/test"]:
        for name in ("rosunit-missing.xml", "rostest-lab.xml", "lab.test", "results.json"):
            try:
                (scratch / folder).mkdir(parents=True, exist_ok=True)
                (scratch / folder / name).write_text(good)
            except OSError:
                pass
    time.sleep(0.2)
"""
PACKAGE = """<package><name>{}</name><version>1.0.0</version><description>d</description>
<maintainer email="a@b.example">m</maintainer><license>MIT</license></package>"""


def test_a_submission_cannot_forge_the_results_of_a_rostest(tmp_path):
    assert isolation_fault() == "", "forged results need isolation"
    (tmp_path / "lab.test").write_text(FORGED)
    cheat, fake = tmp_path / "forger" / "cheat", tmp_path / "forger" / "rostest"
    for folder, name, text in ((cheat, "forge.py", FORGER),
                               (fake, "paramtest", "#!/bin/sh\ntouch passed\n")):
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text(PACKAGE.format(folder.name))
        (folder / name).write_text(text)
        (folder / name).chmod(0o755)
    rows, students = grade(tmp_path, "checks: [{points: 4, name: test, rostest: lab.test}]\n", {
        "forger": "<launch><node name='forge' pkg='cheat' type='forge.py'/>"
                  "<test test-name='easy' pkg='rostest' type='paramtest'/></launch>"},
        name="go.launch")
    said = json.loads((students / "forger" / "results.json").read_text())["tests"][0]["output"]
    assert points(rows["forger"], "test") == [0], said
    assert said.startswith("0 of 1 tests passed"), said


def graded(folder, assignment, *words):
    """Grade the submissions in a folder by a shipped assignment; returns rows by student."""
    done = subprocess.run([*GRADE, assignment, *sorted(str(path) for path in folder.iterdir()),
                           "--out", str(folder.parent / "marks"), *words], text=True,
                          timeout=SECONDS, capture_output=True)
    assert done.returncode == 0, done.stderr
    with open(folder.parent / "marks" / "marks.csv", newline="") as stream:
        return {row["student"]: row for row in csv.DictReader(stream)}


TELEPORT = """import rospy
from gazebo_msgs.msg import LinkState, ModelState
from gazebo_msgs.srv import DeleteModel, GetModelState, SetModelState, SpawnModel
from geometry_msgs.msg import Twist
from my_simulations_msgs.srv import StepWorld
from std_srvs.srv import Empty

rospy.init_node("teleport")
command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
models = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=1)
links = rospy.Publisher("/gazebo/set_link_state", LinkState, queue_size=1)
state = ModelState(model_name="robo")
state.pose.position.x, state.pose.orientation.w = 2.0, 1.0
link = LinkState(link_name="robo::base_link", pose=state.pose)

def ask(name, kind, *values):
    rospy.wait_for_service("/gazebo/" + name)
    try:
        said = rospy.ServiceProxy("/gazebo/" + name, kind)(*values)
        print(name, getattr(said, "success", True), flush=True)
    except rospy.ServiceException as fault:
        print(name, "failed", fault, flush=True)

ask("get_model_state", GetModelState, "robo", "")
ask("set_model_state", SetModelState, state)
ask("delete_model", DeleteModel, "robo")
ask("spawn_sdf_model", SpawnModel, "robo", "<sdf/>", "", state.pose, "")
ask("reset_world", Empty)
ask("step_world", StepWorld, 100)
while not rospy.is_shutdown():
    command.publish(Twist())
    models.publish(state)
    links.publish(link)
    rospy.sleep(0.1)
"""


def test_a_moved_robot_earns_no_points_for_driving(tmp_path):
    (tmp_path / "submissions" / "cheat").mkdir(parents=True)
    (tmp_path / "submissions" / "cheat" / "go.py").write_text(TELEPORT)
    row = graded(tmp_path / "submissions", "drive_to_goal")["cheat"]
    # It commands the robot, which stays on its wheels.
    assert points(row, "the program commands the robot", "the robot comes to the goal",
                  "the robot stops at the goal") == [2, 0, 0], row
    folder = tmp_path / "marks" / "students" / "cheat"
    said = (folder / "output.txt").read_text()
    assert "get_model_state True" in said and "delete_model False" in said, said
    assert "reset_world failed" in said and "is not permitted" in said, said
    page = (folder / "index.html").read_text()
    for name in ("set_model_state", "set_link_state", "delete_model", "spawn_sdf_model",
                 "reset_world", "step_world"):
        assert f"/gazebo/{name}" in page, name


STOP = f"""submission: {{run: go.py}}
world: {REPOSITORY / "world" / "exercises.world"}
models: {{robo: {{file: {REPOSITORY / "urdf" / "robo.urdf"}}}}}
checks:
  - {{points: 1, name: stops, within: 15,
     require: "abs(2.5 - 0.1 - final(pose.robo.x) - 0.6) < 0.03"}}
  - {{points: 1, name: rests, within: 15, require: final(speed.robo) < 0.01}}
"""
WALL = ("the program commands the robot", "the robot comes near the wall",
        "the robot touches no wall", "the robot stops before the wall")


def test_an_instructor_grades_five_submissions_by_a_shipped_assignment(tmp_path):
    submissions = tmp_path / "submissions"
    right = (REPOSITORY / "scripts" / "stop_before_wall.py").read_text()
    for name, program in (("right", right), ("typo", right.replace("while", "whil")),
                          ("loop", "import time\nwhile True: time.sleep(0.1)\n"),
                          ("idle", "print('nothing')\n"), ("crash", DRIVER)):
        (submissions / name).mkdir(parents=True)
        (submissions / name / "go.py").write_text(program)
    rows = graded(submissions, "stop_before_wall", "--jobs", "2")
    assert points(rows["right"], *WALL) == [2, 4, 2, 2]
    for name in ("typo", "loop", "idle"):
        commanded, near, apart, stopped = points(rows[name], *WALL)
        assert commanded == 0 and near < 0.5 and apart == 0 and stopped == 0, name
    assert points(rows["crash"], *WALL)[::2] == [2, 0]
    pages = {name: (tmp_path / "marks" / "students" / name / "index.html").read_text()
             for name in rows}
    assert "SyntaxError" in (tmp_path / "marks" / "students" / "typo" / "output.txt").read_text()
    assert all("replay.html" in page for page in pages.values())
    assert "the robot touches a wall, or drives only to x = " in pages["crash"]


def test_the_program_of_the_course_stops_at_the_distance_that_it_was_given(tmp_path):
    # In lockstep: in real time, a busy machine lets the robot roll on.
    program = (REPOSITORY / "scripts" / "stop_before_wall.py").read_text()
    rows, students = grade(tmp_path, STOP, {
        name: f"import sys\nsys.argv += ['_distance:={distance}', '_speed:=0.5']\n{program}"
        for name, distance in (("right", 0.6), ("early", 0.7))}, "--jobs", "2")
    assert [points(rows[name], "stops", "rests") for name in ("right", "early")] == [
        [1, 1], [0, 1]], (students / "right" / "output.txt").read_text()


def test_the_program_of_the_course_drives_the_square_of_the_assignment(tmp_path):
    (tmp_path / "submissions" / "right").mkdir(parents=True)
    (tmp_path / "submissions" / "right" / "go.py").write_text(
        (REPOSITORY / "scripts" / "drive_square.py").read_text())
    row = graded(tmp_path / "submissions", "drive_square")["right"]
    assert float(row["points"]) == 10.0, row


OBJECT = """<robot name="my_object"><link name="base"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
<visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link></robot>"""
SPAWN = """#!/bin/sh
roslaunch my_simulations upload_param.launch package:=my_package world_name:=empty_world
rosrun my_simulations spawn_object.py --package my_package my_object
"""


def test_a_package_with_an_object_fulfils_the_assignment_of_objects(tmp_path):
    wrong = OBJECT.replace("</visual>", "\n</visul>")
    for name, place, object_ in (("right", "[1.0, 0.0, 0.1]", OBJECT),
                                 ("beside", "[1.5, 0.0, 0.1]", OBJECT),
                                 ("wrong", "[1.0, 0.0, 0.1]", wrong)):
        package = tmp_path / "submissions" / name
        for inside, text in (
                ("package.xml", PACKAGE.format("my_package")), ("spawn.sh", SPAWN),
                ("objects/my_object.urdf", object_), ("config/empty_world/object_locations.yaml",
                 f"my_object: {{model: my_object, model_type: urdf, position: {place},"
                 " orientation: [0, 0, 0]}\n")):
            (package / inside).parent.mkdir(parents=True, exist_ok=True)
            (package / inside).write_text(text)
        (package / "spawn.sh").chmod(0o755)
    rows = graded(tmp_path / "submissions", "object_tutorial", "--jobs", "2")
    assert float(rows["right"]["points"]) == 10.0, rows
    place = float(rows["beside"]["the object is at its place"])
    assert 1.0 < place < 2.0
    assert float(rows["beside"]["points"]) == pytest.approx(7.0 + place, abs=0.02)
    assert float(rows["wrong"]["points"]) == 0.0
    page = (tmp_path / "marks" / "students" / "wrong" / "index.html").read_text()
    assert "&lt;/visul&gt; closes nothing" in page and "objects/my_object.urdf:5" in page
