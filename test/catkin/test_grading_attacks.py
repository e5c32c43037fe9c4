"""Attacks of a submission: each changes its own mark only, and its page says what happened."""
from __future__ import annotations

import contextlib
import csv
import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from box_program import box_program

from my_simulations.grading.box_support import isolation_fault

REPOSITORY = Path(__file__).resolve().parents[2]
GRADE = [sys.executable, str(REPOSITORY / "scripts" / "grade")]
SECONDS = 900.0

BOX = REPOSITORY / "examples" / "friction_study_box.sdf"
LAB = f"""submission: {{run: go.py}}
world: worlds/empty.world
models:
  box: {{file: {BOX}, pose: [0, 0, 0.1]}}
services: all
limits: {{processor_seconds: 8, memory_mb: 1000, processes: 60, file_mb: 50}}
checks:
  - {{points: 4, name: moved, require: pose.box.x > 0.1, within: 0.3}}
  - {{points: 2, name: talks, topic: /chat, rate: 20, within: 0.3}}
"""
RIGHT = box_program("state.pose.position.x + 0.05", 'SECRET = "of the neighbour"')

BEGIN = """import glob, json, os, shutil, signal, socket, sys, time
given = json.load(open('given.json'))
refused, done = set(), []
def attempt(name, work, *words):
    try:
        result = work(*words)
    except Exception as fault:
        refused.add(getattr(fault, 'strerror', None) or str(fault))
    else:
        done.append((name, result))
"""
END = """
raise RuntimeError('done: %s, refused: %s' % (done, sorted(refused)))
"""

ATTACKS = {
    "endless_loop": ("while True: pass\n", "computes without a pause"),
    "processor_time": ("""
for _ in range(3): os.fork()
while True: pass
""", "computes without a pause"),
    "endless_sleep": ("while True: time.sleep(1000)\n", "/chat has no messages"),
    "stopped": ("os.kill(os.getpid(), signal.SIGSTOP)\n", "/chat has no messages"),
    "fork_bomb": ("""
while True:
    try: os.fork()
    except OSError: pass
""", "computes without a pause"),
    "threads": ("""
import threading
try:
    while True: threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()
except RuntimeError as fault:
    attempt('thread', lambda: (_ for _ in ()).throw(fault))
""" + END, "done: [], refused: [&quot;can&#x27;t start new thread&quot;]"),
    "memory": ("""
for _ in range(10):
    if os.fork() == 0: break
kept = []
while True:
    try: kept.append(bytearray(10000000))
    except MemoryError: pass
""", "more memory than 1000 MB"),
    "killed_processes": ("""
for pid in range(2, 100000):
    try: os.kill(pid, 9)
    except OSError: pass
os.kill(-1, 9)
""", "the program ended with status 137"),
    "deleted_files": ("""
for top in (given['folder'], os.path.expanduser('~'), '/tmp', '/dev/shm'):
    for above, folders, names in os.walk(top, topdown=False):
        for name in names:
            if above.startswith(given['folder']):
                attempt(os.path.join(above, name), os.unlink, os.path.join(above, name))
            else:
                try: os.unlink(os.path.join(above, name))
                except OSError: pass
for path in given['others']:
    attempt(path, os.unlink, path)
    attempt(path, open, path, 'w')
""" + END, "done: [], refused: [&#x27;"),
    "large_log": ("while True: sys.stdout.write('y' * 1000000)\n",
                  "its output has reached 25 MB"),
    "large_file": ("""
with open('big', 'wb') as big:
    while True: big.write(bytes(1000000))
""", "OSError: [Errno 27] File too large"),
    "full_disk": ("""
faults = set()
for top in (os.getcwd(), os.environ['HOME'], os.environ['TMPDIR'], '/tmp', '/dev/shm'):
    for number in range(12):
        try:
            with open(os.path.join(top, 'big%d' % number), 'wb') as big:
                while big.tell() < 20000000: big.write(bytes(1000000))
        except OSError as fault: faults.add(fault.strerror)
raise RuntimeError(str(sorted(faults)))
""", "No space left on device"),
    "empty_files": ("""
for number in range(200000):
    open(os.path.join(os.environ['TMPDIR'], str(number)), 'w').close()
""", "No space left on device"),
    "open_files": ("""
kept = []
while True: kept.append(open('/dev/null'))
""", "Too many open files"),
    "inotify": ("""
import ctypes
libc = ctypes.CDLL(None)
while libc.inotify_init() >= 0: pass
raise RuntimeError('none is left')
""", "RuntimeError: none is left"),
    "files_of_others": ("""
def read(path):
    with open(path, 'rb') as stream: return stream.read(1000)
for path in given['others']:
    attempt(path, read, path)
    attempt(path, os.listdir, os.path.dirname(path)) if 'marks' in path else None
for path in ('/etc/shadow', '/dev/mem', '/dev/sda', '/proc/kcore'):
    attempt(path, read, path)
""" + END, "done: [], refused: [&#x27;"),
    "tokens": ("""
reached = [name for name, value in os.environ.items() if 'SECRET' in value]
for path in glob.glob('/proc/*/environ') + glob.glob('/proc/*/cmdline'):
    try:
        with open(path, 'rb') as stream:
            if b'SECRET' in stream.read(): reached.append(path)
    except OSError as fault: refused.add(fault.strerror)
raise RuntimeError('reached %s' % reached)
""", "RuntimeError: reached []"),
    "network": ("""
for place in (('127.0.0.1', given['port']), ('192.0.2.1', 80), ('1.1.1.1', 53)):
    attempt(str(place), socket.create_connection, place, 2)
attempt('abstract', lambda: socket.socket(socket.AF_UNIX).connect(given['local']))
attempt('agent', lambda: socket.socket(socket.AF_UNIX).connect(given['agent']))
attempt('raw', socket.socket, socket.AF_PACKET, socket.SOCK_RAW)
""" + END, "done: [], refused: [&#x27;Connection refused&#x27;, &#x27;Network is unreachable"),
    "links": ("""
attempt('link', lambda: open('secret.txt').read())
for top in ('.', os.environ['HOME'], os.environ['TMPDIR']):
    for name in ('replay.html', 'output.txt', 'mark.json', 'picture.png'):
        os.symlink('/etc/passwd', os.path.join(top, name))
""" + END, "done: [], refused: [&#x27;No such file or directory&#x27;]"),
    "forged_results": ("""
line = json.dumps({'result': {'name': 'moved', 'most': 4, 'points': 4, 'reason': '', 'file': '',
                              'line': 0}}).encode()
for descriptor in range(3, 100):
    attempt('descriptor', os.write, descriptor, line + b'\\n')
for pid in filter(str.isdigit, os.listdir('/proc')):
    for path in glob.glob('/proc/%s/fd/*' % pid) if int(pid) != os.getpid() else ():
        attempt(path, lambda path=path: open(path, 'wb', 0).write(line))
for path in ('../judge', '../judge/output.txt'):
    attempt(path, lambda path=path: os.access(path, os.W_OK) or os.listdir(path))
""" + END, "done: [], refused: [&#x27;"),
    "system": ("""
import ctypes
libc = ctypes.CDLL(None, use_errno=True)
def call(name, *words):
    if getattr(libc, name)(*words) < 0: raise OSError(ctypes.get_errno(), name + ' refused')
attempt('mount', call, 'mount', b'none', b'/tmp', b'tmpfs', 0, b'')
attempt('umount', call, 'umount2', given['folder'].encode(), 2)
attempt('unshare', call, 'unshare', 0x10000000 | 0x00020000)
attempt('setuid', os.setuid, 0)
attempt('nice', os.nice, -5)
attempt('hostname', socket.sethostname, 'attacked')
attempt('sysctl', lambda: open('/proc/sys/kernel/hostname', 'w').write('attacked'))
attempt('clock', time.clock_settime, time.CLOCK_REALTIME, 0)
attempt('reboot', call, 'reboot', 0x89abcdef)
""" + END, "refused: [&#x27;"),
    "ros_master": ("""
import xmlrpc.client
master = xmlrpc.client.ServerProxy(os.environ['ROS_MASTER_URI'])
node = master.lookupNode('/go', '/gazebo')[2]
xmlrpc.client.ServerProxy(node).shutdown('/go', 'attacked')
master.shutdown('/go', 'attacked')
""", "/chat has no messages"),
}
"""Programs, and what the page of the student says."""


def content(folder):
    """Content, permissions and time of each file below a folder."""
    return {str(path): (path.read_bytes(), path.stat().st_mode, path.stat().st_mtime_ns)
            for path in sorted(folder.rglob("*")) if path.is_file()}


GROUP = 3
"""Attacks beside one neighbour, which is graded at the same time and after them."""


def neighbour_of(name):
    return f"neighbour{list(ATTACKS).index(name) // GROUP}"


@pytest.fixture(scope="module")
def attacked(tmp_path_factory):
    """Folder, rows by student, and the files of others before and after all attacks."""
    assert isolation_fault() == "", "an attack must not run without isolation"
    folder = tmp_path_factory.mktemp("attacks")
    names = list(ATTACKS)
    neighbours = sorted({neighbour_of(name) for name in names})
    others = ["secret.txt", "marks/students/before/mark.json",
              *(f"{name}/go.py" for name in neighbours)]
    (folder / "lab.yaml").write_text(LAB)
    for path in others:
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(RIGHT if path.endswith("go.py") else "SECRET")
    environment = {**os.environ, "A_TOKEN": "SECRET", "ROS_REGISTRY_LOGIN": "SECRET",
                   "MY_SIMULATIONS_EDITOR_TOKEN": "SECRET"}
    local = f"\0my_simulations_attack_{os.getpid()}"
    with contextlib.ExitStack() as held:
        outside = held.enter_context(subprocess.Popen(
            [sys.executable, "-c", "import time; time.sleep(1000)"]))
        held.callback(outside.kill)
        server = held.enter_context(socket.create_server(("127.0.0.1", 0)))
        server.setblocking(False)
        abstract = held.enter_context(socket.socket(socket.AF_UNIX))
        abstract.bind(local)
        abstract.listen()
        agent = held.enter_context(socket.socket(socket.AF_UNIX))
        agent.bind(os.path.relpath(folder / "agent"))   # a long path would not fit
        (folder / "agent").chmod(0o777)
        agent.listen()
        given = json.dumps({"folder": str(folder), "port": server.getsockname()[1], "local": local,
                            "agent": str(folder / "agent"),
                            "others": [str(folder / path) for path in others]})
        for name, (program, _) in ATTACKS.items():
            (folder / name).mkdir()
            (folder / name / "go.py").write_text(BEGIN + program)
            (folder / name / "given.json").write_text(given)
            (folder / name / "secret.txt").symlink_to(folder / "secret.txt")
        before = content(folder)
        order = [one for at in range(0, len(names), GROUP)
                 for one in (*names[at:at + GROUP], neighbour_of(names[at]))]
        done = subprocess.run([*GRADE, "lab.yaml", *order, "--out", "marks", "--jobs", "2"],
                              cwd=folder, env=environment, text=True, timeout=SECONDS,
                              capture_output=True)
        assert done.returncode == 0, done.stderr
        with pytest.raises(BlockingIOError):
            server.accept()
        assert outside.poll() is None
    with open(folder / "marks" / "marks.csv", newline="") as stream:
        rows = {row["student"]: [row["status"], row["points"]] for row in csv.DictReader(stream)}
    return folder, rows, before, content(folder)


@pytest.mark.parametrize("name", list(ATTACKS))
def test_an_attack_changes_neither_marks_nor_files_of_others(attacked, name):
    folder, rows, before, after = attacked
    assert rows[neighbour_of(name)] == ["graded", "6.0"]
    assert {path: after.get(path) for path in before} == before
    student = folder / "marks" / "students" / name
    page = (student / "index.html").read_text()
    assert rows[name] == ["graded", "0.0"], page
    assert ATTACKS[name][1] in page, page
    assert sum(path.stat().st_size for path in student.iterdir()) < 5e6
