"""A class on this machine: worlds of students side by side, and what a student cannot reach."""
from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from free_ports import free_ports
from waiting import wait_for

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.class_marks import mark_shown
from my_simulations.classroom.class_plan import FIRST_USER
from my_simulations.classroom.class_state import ClassState
from my_simulations.classroom.local_world import LocalWorld, log_file, make_home
from my_simulations.classroom.world_states import ENDED
from my_simulations.errors import CommandError
from my_simulations.grading.box import descendants
from my_simulations.grading.box_support import isolation_fault

REPOSITORY = Path(__file__).resolve().parents[2]
CLASS = [sys.executable, str(REPOSITORY / "scripts" / "class")]
SECONDS = 600.0


def written(folder, more=""):
    folder.mkdir(exist_ok=True)
    folder.chmod(0o755)
    file = folder / "class.yaml"
    file.write_text(f"class: lab\nstudents: [anna, ben]\nport: {free_ports(3)}\n"
                    f"launch: my_simulations world.launch\n{more}")
    return file


def call(*words):
    done = subprocess.run([*CLASS, *map(str, words)], capture_output=True, text=True,
                          timeout=SECONDS)
    return done.returncode, done.stdout, done.stderr


@contextlib.contextmanager
def running(file):
    """The class, and the addresses that it prints."""
    process = subprocess.Popen([*CLASS, "start", str(file)], stdout=subprocess.PIPE, text=True)
    try:
        lines = [process.stdout.readline().strip() for _ in range(3)]
        yield process, dict(line.split(": ", 1) for line in lines)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        process.wait(SECONDS)
        process.stdout.close()


def tiles(file):
    status, said, _ = call("status", file, "--json")
    return {one["name"]: one for one in json.loads(said)["students"]} if status == 0 else {}


def shown(file):
    """The same as `tiles` without a process: tests that wait ask often."""
    try:
        address = urlsplit(ClassState(read_class(str(file))[0]).manager()["address"])
        with urlopen(f"{address.scheme}://{address.netloc}/status.json?{address.query}",
                     timeout=SECONDS) as answer:
            return {one["name"]: one for one in json.load(answer)["students"]}
    except (CommandError, OSError):
        return {}


def code_of(url):
    try:
        with urlopen(url, timeout=SECONDS) as answer:
            return answer.status
    except HTTPError as refusal:
        refusal.close()
        return refusal.code
    except (URLError, OSError):
        return 0


def test_each_student_has_a_world_and_an_editor_of_its_own(tmp_path):
    assert isolation_fault() == ""
    world = REPOSITORY / "world" / "exercises.world"
    file = written(tmp_path / "course", f"args: {{world: '{world}'}}\n")
    with running(file) as (process, links):
        found = wait_for(lambda: (lambda now: now if now and all(
            one["state"] == "running" for one in now.values()) else None)(shown(file)),
            "two running worlds", SECONDS)
        assert {one["world"] for one in found.values()} == {"default"}
        assert all(one["memory_mb"] > 10.0 for one in found.values())
        page, _, tutor = links["tutor"].partition("?")
        with urlopen(f"{page}students/anna/picture.svg?{tutor}", timeout=SECONDS) as answer:
            assert b"<polygon" in answer.read()
        base, _, token = links["anna"].partition("?")
        assert [code_of(links["anna"]), code_of(links["ben"])] == [200, 200]
        other = links["ben"].partition("?")[2]
        assert [code_of(base), code_of(f"{base}?{other}"),
                code_of(f"{page}?{token}")] == [403, 403, 403]
        assert call("start", file)[0] == 1   # it runs already
        pids = descendants(process.pid)
        assert call("stop", file, "ben")[0] == 0
        now = tiles(file)
        assert (now["ben"]["state"], now["anna"]["state"]) == ("stopped", "running")
        assert call("stop", file)[0] == 0
        assert process.wait(SECONDS) == 0
    assert not [pid for pid in pids if os.path.exists(f"/proc/{pid}")]
    assert call("status", file)[0] == 1


def test_a_running_class_receives_files_and_its_tutor_sees_the_error_of_each_student(tmp_path):
    assert isolation_fault() == ""
    world = REPOSITORY / "test" / "data" / "invalid" / "include_unknown.world"
    file = written(tmp_path / "course", f"args: {{world: '{world}'}}\n")
    plan = read_class(str(file))[0]
    anna, ben = (Path(make_home(plan, student)) for student in plan.students)
    model = ben / ".gazebo" / "models" / "no_such_model"
    model.mkdir(parents=True)
    (model / "model.config").write_text(
        '<model><name>no_such_model</name><sdf version="1.6">model.sdf</sdf></model>')
    (model / "model.sdf").write_text(
        '<sdf version="1.6"><model name="no_such_model"><link name="link"/></model></sdf>')
    sheet = tmp_path / "sheet.txt"
    sheet.write_text("task 1")
    with running(file):
        found = wait_for(lambda: (lambda now: now if now and all(
            one["state"] == "running" and one["world"] for one in now.values())
            and now["anna"]["error"] else None)(shown(file)),
            "two running worlds and the error of one", SECONDS)
        assert "no_such_model" in found["anna"]["error"] and found["ben"]["error"] == ""
        assert call("broadcast", file, sheet)[:2] == (
            0, "anna: received/sheet.txt\nben: received/sheet.txt\n")
        for student, home in zip(plan.students, (anna, ben)):
            received = home / "received" / "sheet.txt"
            assert received.read_text() == "task 1"
            owner = student.user if os.getuid() == 0 else os.getuid()
            assert received.stat().st_uid == received.parent.stat().st_uid == owner
        assert {one["state"] for one in tiles(file).values()} == {"running"}


def test_a_world_without_browsers_sleeps_and_a_browser_wakes_it(tmp_path):
    file = written(tmp_path / "course", "idle_minutes: 0.1\n")
    with running(file) as (_, links):
        wait_for(lambda: shown(file).get("anna", {}).get("reason") == "no browser was connected",
                 "the end of an unused world", SECONDS)
        wait_for(lambda: code_of(links["anna"]) == 200, "the world that a browser woke", SECONDS)


ATTEMPTS = """
import json, os, signal, socket, sys
given = json.loads(sys.argv[1])
reached = []

def attempt(name, work):
    try:
        if work():
            reached.append(name)
    except OSError:
        pass

def read(path):
    with open(path, 'rb') as stream:
        return stream.read() is not None

def connect(port):
    with socket.create_connection(('127.0.0.1', port), 2.0):
        return True

def local(name):
    with socket.socket(socket.AF_UNIX) as one:
        one.connect(name)
        return True

for path in given['files']:
    attempt('read ' + path, lambda: read(path))
    attempt('write ' + path, lambda: open(path, 'ab').close() or True)
    home = os.path.expanduser('~')
    link = os.path.join(home, 'link%d' % len(os.listdir(home)))
    os.symlink(path, link)
    attempt('link ' + path, lambda: read(link))
for folder in given['folders']:
    attempt('list ' + folder, lambda: set(os.listdir(folder)) - set(given['own']))
for port in given['ports']:
    attempt('connect %d' % port, lambda: connect(port))
attempt('local socket', lambda: local(given['local']))
own = os.getuid()
for pid in filter(str.isdigit, os.listdir('/proc')):
    for part in ('environ', 'cmdline', 'mem', 'root/etc/passwd'):
        def look(pid=pid, part=part):
            with open('/proc/%s/%s' % (pid, part), 'rb') as stream:
                said = stream.read(100000)
                return any(one[::-1].encode() in said for one in given['reversed'])
        attempt('process %s %s' % (pid, part), look)
for pid in given['processes']:
    attempt('kill %d' % pid, lambda: os.kill(pid, 0) or True)
attempt('become root', lambda: os.setuid(0) or True)
attempt('become ben', lambda: os.setuid(given['user']) or True)
print('REACHED', json.dumps(reached), flush=True)
"""


@pytest.fixture
def class_of_two(tmp_path):
    """A class whose second student has a secret; with a local file and ports of this machine."""
    plan = read_class(str(written(tmp_path / "course")))[0]
    tokens = ClassState(plan).tokens(plan)
    anna, ben = plan.students
    make_home(plan, anna)
    secret = Path(make_home(plan, ben)) / "secret.txt"
    secret.write_text("of ben")
    outside = tmp_path / "course" / "solution.txt"
    outside.write_text("of the tutor")
    outside.chmod(0o600)
    return plan, tokens, secret, outside


def test_a_student_reaches_no_files_processes_and_tokens_of_others(class_of_two):
    assert isolation_fault() == "", "attempts need isolation"
    plan, tokens, secret, outside = class_of_two
    anna, ben = plan.students
    other = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"],
                             env={"TOKEN": tokens["ben"], "PATH": os.environ["PATH"]})
    state = Path(plan.state)
    local = f"\0my_simulations_test_{os.getpid()}"
    with contextlib.ExitStack() as held:
        held.callback(other.wait)
        held.callback(other.kill)
        ports = [held.enter_context(socket.create_server(("127.0.0.1", port))).getsockname()[1]
                 for port in (ben.port, plan.port, 0)]
        listening = held.enter_context(socket.create_server(("127.0.0.1", anna.port)))
        abstract = held.enter_context(socket.socket(socket.AF_UNIX))
        abstract.bind(local)
        abstract.listen()
        world = Attacker(plan, anna, tokens["anna"], listening)
        world.given = {
            "files": [str(secret), str(state / "tokens.json"), str(outside)],
            "folders": [plan.folder, str(secret.parent.parent), str(secret.parent), str(state)],
            "own": ["students", "anna"], "ports": ports, "local": local,
            "reversed": [tokens["ben"][::-1], tokens[""][::-1]],
            "processes": [os.getpid(), other.pid], "user": ben.user}
        world.start()
        held.callback(world.stop, "the test ended")
        wait_for(lambda: world.poll() or world.state == ENDED, "the end of the attempts", SECONDS)
    said = Path(log_file(plan, anna)).read_text()
    reached = json.loads(said.partition("REACHED ")[2].splitlines()[0])
    assert reached == [], said
    assert secret.read_text() == "of ben"


EXCESSES = {
    "memory": ("kept = []\nwhile True: kept.append(bytearray(1000000)); time.sleep(0.002)\n",
               "more memory than 200 MB", ""),
    "processes": ("""
count = 0
try:
    while count < 1000:
        if os.fork() == 0: time.sleep(1000)
        count += 1
except OSError as fault: print('forks', count < 40, fault, flush=True)
os.killpg(0, 9)
""", "the processes ended with status", "forks True"),
    "file": ("""
sizes = []
for folder in ('/tmp', os.path.expanduser('~')):
    try:
        with open(folder + '/big', 'wb') as big:
            while True: big.write(bytes(1000000))
    except OSError: sizes.append(os.path.getsize(folder + '/big'))
print('full', len(sizes), max(sizes) <= 5000000)
""", "the processes ended with status 0", "full 2 True"),
    "home": ("""
for number in range(1000):
    with open(os.path.expanduser(f'~/{number}'), 'wb') as one: one.write(bytes(100000))
print('written', flush=True)
time.sleep(1000)
""", "MB, more than 90 MB: delete some", "written"),
    "empty files": ("""
os.mkdir(os.path.expanduser('~/many'))
for number in range(22000): open(os.path.expanduser(f'~/many/{number}'), 'wb').close()
print('made', flush=True)
time.sleep(1000)
""", "MB, more than 90 MB: delete some", "made"),
    "priority": ("""
print('score', open('/proc/self/oom_score_adj').read().strip())
try: os.nice(-1)
except OSError as fault: print('nice', fault)
print('processors', len(os.sched_getaffinity(0)))
""", "the processes ended with status 0", "score 500"),
}
"""Programs of students, the reason on the tutor's page, and what is in the log."""


@pytest.mark.parametrize("name", list(EXCESSES))
def test_a_student_who_exceeds_a_limit_ends_alone(tmp_path, name):
    assert isolation_fault() == "", "excesses need isolation"
    program, reason, logged = EXCESSES[name]
    plan = read_class(str(written(tmp_path / "course", "limits: {memory_mb: 200, processes: 40,"
                                                       " file_mb: 5, home_mb: 90}\n")))[0]
    tokens = ClassState(plan).tokens(plan)
    with contextlib.ExitStack() as held:
        worlds = []
        for student, text in zip(plan.students, (program, "time.sleep(1000)\n")):
            listening = held.enter_context(socket.create_server(("127.0.0.1", student.port)))
            world = Attacker(plan, student, tokens[student.name], listening)
            world.code = "import os, time\n" + text
            world.start()
            held.callback(lambda world=world: world.stop("the test ended"))
            worlds.append(world)
        anna, ben = worlds
        wait_for(lambda: anna.poll() or not anna.is_alive and anna.reason, "the end", SECONDS)
        ben.poll()
        assert ben.is_alive and ben.reason == ""
    said = Path(log_file(plan, plan.students[0])).read_text()
    assert reason in anna.reason and logged in said, (anna.reason, said)


class Attacker(LocalWorld):
    """The processes of a student who attempts to reach what belongs to others."""

    given = {}
    code = ATTEMPTS

    def _specification(self, home, passed):
        found = super()._specification(home, passed)
        if os.getuid() != 0:     # numbers of other users have no meaning in this namespace
            self.given["user"] = FIRST_USER
        return {**found, "command": ["/usr/bin/python3", "-c", self.code, json.dumps(self.given)]}


def written_assignment(folder):
    file = folder / "lab.yaml"
    file.write_text("submission: {world: a.world}\nchecks:\n"
                    "  - {points: 2, name: valid, check_model: strict}\n")
    return file


def test_files_are_sent_and_collected_without_following_links(class_of_two, tmp_path):
    plan, _, secret, outside = class_of_two
    home = Path(plan.home(plan.students[0]))
    handed_in = home / "submission" / "pkg"
    worlds = home / "my_simulations" / "worlds"    # the default folder for saved worlds
    assert worlds.resolve() == handed_in.parent and handed_in.parent.is_dir()
    handed_in.mkdir(parents=True)
    (handed_in / "go.py").write_text("pass")
    (handed_in / "go.py").chmod(0o755)
    (handed_in / "stolen.txt").symlink_to(outside)
    (home / "submission" / "ben").symlink_to(secret.parent)
    os.mkfifo(home / "submission" / "pipe")
    if os.getuid() == 0:
        subprocess.run(["chown", "-R", str(plan.students[0].user), str(home)], check=True)
    assert call("collect", plan.file, "--out", tmp_path / "out")[:2] == (
        0, "anna: 1 files\nben: 0 files: nothing is in ~/submission\n")
    found = [path for path in (tmp_path / "out").rglob("*") if not path.is_dir()]
    assert found == [tmp_path / "out" / "anna" / "pkg" / "go.py"] and os.access(found[0], os.X_OK)
    hostile = home / "submission" / os.fsdecode(b"\xff\n,<b>" + 100 * b"\xfe")
    hostile.write_text("pass")
    (home / "submission" / "pkg" / "go.py").rename(home / "submission" / "go.py")
    status, said, _ = call("collect", plan.file, "--out", tmp_path / "out", "--grade",
                           written_assignment(tmp_path))
    assert status == 0 and said.startswith("anna: 2 files\n")
    found = {path.name for path in (tmp_path / "out" / "anna").rglob("*") if path.is_file()}
    assert found == {"go.py", hostile.name}
    assert mark_shown(plan, "anna") == {"points": 0.0, "most": 2.0, "status": "graded"}
    assert mark_shown(plan, "ben") == {"points": 0.0, "most": 2.0, "status": "graded"}
    sheet = tmp_path / "sheet.txt"
    sheet.write_text("task 1")
    target = tmp_path / "target"
    target.mkdir(mode=0o777)
    (home / "received").symlink_to(target)
    status, said, fault = call("broadcast", plan.file, sheet)
    assert (status, said) == (1, "ben: received/sheet.txt\n") and "anna" in fault
    assert list(target.iterdir()) == []
    received = secret.parent / "received" / "sheet.txt"
    assert received.read_text() == "task 1"
    assert os.getuid() != 0 or received.stat().st_uid == plan.students[1].user
    (home / "received").unlink()
    assert call("broadcast", plan.file, sheet, "--to", "anna")[0] == 0
    assert call("broadcast", plan.file, sheet, "--to", "carl")[0] == 1
    status, said, fault = call("broadcast", plan.file, tmp_path / "missing.txt")
    assert (status, said, fault.count("missing.txt")) == (1, "", 1)    # it is read once
