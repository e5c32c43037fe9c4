"""Plugins of users in processes of their own: what they can do, and what ends one of them only."""
from __future__ import annotations

import os
import signal
import threading
from concurrent.futures import Future

import numpy as np
import pytest
from plugin_case import kept
from test_plugin_faults import GOOD, HEAD, LOAD, Case, model
from waiting import until

from my_simulations.plugins.call_watch import CallLimits
from my_simulations.plugins.context import Context
from my_simulations.plugins.isolated.messages import (
    CALLS_WITHOUT_RESULT,
    HANDLES,
    METHODS,
    PROPERTIES,
)
from my_simulations.plugins.isolated.remote_context import RemoteContext
from my_simulations.plugins.plugin_state import PluginParameter
from my_simulations.plugins.testing import Message
from my_simulations.sensing.api import RayReturns

CALL = LOAD + """        self.context.every(100.0, self.call)

    def call(self):
"""
MOVES = LOAD + """        context = self.context
        self.hinge, self.base = context.joint("hinge"), context.link("base")
        self.said = context.publish("said", "std_msgs/Float64")
        self.times = []
        context.subscribe("rate", "std_msgs/Float64", self.deliver)
        context.serve("ask", "std_srvs/Trigger", self.answer)
        context.once(15_000_000, lambda: self.times.append(context.now_ns))
        context.every(100.0, self.call)
        context.observe(50.0, self.watch, [self.said])
        context.mark = (context.model, context.parameters.text("word"), self.hinge.parent,
                        self.base.inertial.mass, context.step_size, context.gravity[2])

    def deliver(self, message):
        self.hinge.drive(message.data, 10.0)

    def call(self):
        self.times.append(self.context.now_ns)

    def watch(self):
        message = self.context.message("std_msgs/Float64")
        message.data = (self.context.now_ns, self.hinge.position, self.base.pose.position)
        self.said.publish(message)

    def answer(self, request, response):
        from my_simulations.plugins.context import RequestError
        if request.data == "bad":
            raise RequestError("there is no such word")
        response.message = (self.times, self.context.mark, self.context.link_names())
"""


@pytest.fixture
def case(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    yield from kept(lambda **options: Case(tmp_path, isolate=True, **options))


def test_a_plugin_uses_its_context_from_its_own_process(case):
    one = case()
    one.spawn(MOVES)
    assert one.failed() == []
    one.deliver("rate", data=2.0)
    one.sim.clock.advance(40)
    until(lambda: len(one.graph.on("said")) == 2)
    (first, place, base), (second, later, _) = (said.data for said in one.graph.on("said"))
    assert (first, second) == (20_000_000, 40_000_000)
    assert later - place == pytest.approx(0.04) and base == pytest.approx((0.0, 0.0, 0.0))
    times, mark, names = one.ask("ask", data="good").message
    assert times == [10_000_000, 15_000_000, 20_000_000, 30_000_000, 40_000_000]
    assert mark[:3] == ("bad", "", "base") and mark[4:] == (0.001, pytest.approx(-9.8))
    assert "bad::wheel" in names.values()


def test_the_parameters_that_a_process_reads_are_known_although_it_fails(case):
    one = case()
    one.spawn(LOAD + """        self.context.parameters.number("gain", 0.25)
        raise ValueError("no more")
""")
    until(one.failed)
    (state,) = [state for state in one.host.states() if state.model == "bad"]
    assert state.parameters == (PluginParameter("gain", "number", "0.25"),)


def test_a_caller_of_a_service_is_told_why_its_request_is_refused(case):
    one = case()
    one.spawn(MOVES)
    with pytest.raises(Exception, match="no such word"):
        one.graph.heard["ask"](Message(data="bad"), Message())
    assert one.ask("ask", data="good").message
    assert one.failed() == []


def test_a_fault_of_the_context_is_raised_where_the_plugin_has_asked(case):
    one = case()
    one.spawn(LOAD + """        from my_simulations.plugins.context import PluginError
        try:
            self.context.joint("nowhere")
        except PluginError as fault:
            self.context.warn(f"caught: {fault}")
        self.context.joint("nothing")
""")
    warned, failed = one.issues
    assert "caught: model 'bad' has no joint 'nowhere'" in warned.message
    assert "has no joint 'nothing'" in failed.message


ENDS = [
    ("import os; os._exit(3)", "its process ended with exit status 3", True),
    ("import os; os.fork() or os._exit(0); 1 / 0", "ZeroDivisionError", True),
    ("import os, signal; os.kill(os.getpid(), signal.SIGINT)", "KeyboardInterrupt", True),
    ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "ended by SIGKILL", False),
    ("import ctypes; ctypes.string_at(0)", "ended by SIGSEGV", True),
    ("import _thread; _thread.interrupt_main()", "KeyboardInterrupt", True),
    ("import sys; sys.exit(5)", "SystemExit: 5", True),
    ("bytearray(1 << 46)", "MemoryError", True),
    ("import re; re.match(r'(a+)+$', 'a' * 60 + 'b')", "s of processor time", True),
    ("while True: pass", "s of processor time", True),
    ("import threading; threading.Event().wait()", "it waited for more than 8 s", True),
    ("import os; os.close(int(__import__('sys').argv[1]))", "", False),
    ("import os; os.write(int(__import__('sys').argv[1]), b'\\xff' * 1000)", "damaged message",
     False),
    ("self.context.publish('t', 'std_msgs/Empty').publish(lambda: 1)", "pickle", True),
    ("raise ValueError('x' * 50_000_000)", "49999500 more characters", True),
    ("import threading; threading.Thread(target=self.context.models).start(); 1 / 0",
     "ZeroDivisionError", True),
]


@pytest.mark.parametrize("when", ["import", "load", "call"])
@pytest.mark.parametrize(("statement", "said", "located"), ENDS, ids=range(len(ENDS)))
def test_nothing_that_a_plugin_does_ends_another_one(case, statement, said, located, when):
    one = case(limits=CallLimits(0.5, 8.0))
    if when == "import" and "self" in statement:
        statement, said = "1 / 0", "ZeroDivisionError"
    source = {"import": "{}\n", "load": LOAD + "        {}\n", "call": CALL + "        {}\n"}
    one.spawn(source[when].format(statement))
    one.goes_on()
    (issue,) = one.failed()
    assert (issue.file, issue.line) == ("robot.urdf", 12) and said in issue.message
    assert len(issue.message) < 1000
    if located:
        assert f"{one.file}:{ {'import': 1, 'load': 6, 'call': 9}[when]})" in issue.message


SCANS = LOAD + """        from my_simulations.sensing.api import RayFan
        self.topic = self.context.publish("scan", "sensor_msgs/LaserScan")
        place = "base", self.context.pose
        self.context.observe(0.0, lambda: self.context.scan(
            RayFan(3), False, self.publish, place), world=True)

    def publish(self, found, ns):
        message = self.context.message("sensor_msgs/LaserScan")
        message.data = (ns, list(found.ranges))
        self.topic.publish(message)
"""


def test_a_plugin_receives_scans_in_its_own_process(case):
    one = case()

    def cast(mount, fan, visuals, ns, rows):
        cast = Future()
        cast.set_result(RayReturns(np.arange(float(fan.samples)), np.zeros(3, np.float32),
                                   np.zeros(3, np.int32)))
        return cast

    one.host._scene.cast = cast
    one.spawn(SCANS)
    for step in range(1, 4):
        one.sim.clock.advance(1)
        until(lambda step=step: len(one.graph.on("scan")) == step)
    assert [said.data for said in one.graph.on("scan")] == [
        (ns, [0.0, 1.0, 2.0]) for ns in (10 ** 6, 2 * 10 ** 6, 3 * 10 ** 6)]
    assert one.failed() == []


def test_a_process_that_a_plugin_forks_does_not_serve_it(case, tmp_path):
    one = case()
    one.spawn(CALL + f"""        import os
        child = os.fork()
        if child == 0:
            open({str(tmp_path / "forked")!r}, "w").close()
            self.context.models()
            open({str(tmp_path / "served")!r}, "w").close()
        else:
            os.waitpid(child, 0)
""")
    one.goes_on()
    until((tmp_path / "forked").exists)
    assert one.failed() == [] and not (tmp_path / "served").exists()


def test_a_context_is_refused_in_a_thread_of_the_plugin(case):
    one = case()
    one.spawn(LOAD + """        import threading
        said = []

        def run():
            try:
                self.context.models()
            except Exception as fault:
                said.append(str(fault))

        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
        self.context.warn(said[0])
""")
    (issue,) = one.issues
    assert "'models' was used in a thread of the plugin" in issue.message


def test_a_plugin_that_is_mended_works_with_the_next_spawn(case):
    one = case()
    for number, source in enumerate((
            "x = (\n", "undefined_name\n", LOAD + "        1 / 0\n",
            HEAD.replace("Bad", "Other"))):
        one.spawn(source)
        assert len(one.failed()) == number + 1
        one.sim.models.delete("bad")
    one.spawn(GOOD.replace("Good", "Bad"))
    one.sim.clock.advance(20)
    until(lambda: len(one.graph.on("bad/alive")) == 2)
    assert len(one.failed()) == 4


def test_a_helper_of_a_plugin_that_is_mended_is_read_again(case):
    one = case()
    helper = f"helper_of_{one.bad}"
    source = f"from {helper} import RATE\n" + GOOD.replace("Good", "Bad").replace("100.0", "RATE")
    (one.folder / f"{helper}.py").write_text("RATE = None\n")
    one.spawn(source)
    assert len(one.failed()) == 1
    one.sim.models.delete("bad")
    (one.folder / f"{helper}.py").write_text("RATE = 100.0\n")
    one.spawn(source)
    one.sim.clock.advance(20)
    until(lambda: len(one.graph.on("bad/alive")) == 2)


def is_running(pid):
    """Whether a process runs; one that has ended and was not waited for does not."""
    try:
        with open(f"/proc/{pid}/stat") as stream:
            return stream.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("how", ["delete", "stop", "kill"])
def test_a_process_ends_with_all_that_it_has_started(case, tmp_path, how):
    one = case()
    pids, ended = tmp_path / "pids", tmp_path / "ended"
    one.spawn(LOAD + f"""        import atexit, os, subprocess
        other = subprocess.Popen(["sleep", "1000"])
        open({str(pids)!r}, "w").write(f"{{os.getpid()}} {{other.pid}}")
        self.context.subscribe("talk", "std_msgs/Empty", print)
        atexit.register(lambda: open({str(ended)!r}, "w").close())
""")
    mine, started = map(int, pids.read_text().split())
    assert is_running(mine) and is_running(started) and mine != os.getpid()
    if how == "delete":
        one.sim.models.delete("bad")
    elif how == "stop":
        one.host.stop()
    else:
        os.kill(mine, signal.SIGKILL)
        one.deliver("talk")
    until(lambda: not is_running(mine))
    until(lambda: not is_running(started))
    if how == "kill":
        until(one.failed)
    else:
        assert ended.exists()


def test_the_context_of_a_process_has_all_that_a_context_has():
    wanted = {name for name in (*vars(Context), *Context.__annotations__)
              if not name.startswith("_")}
    given = {*METHODS, *PROPERTIES, *HANDLES, *vars(RemoteContext), "parameters", "sensor",
             "sensor_link", "sensor_joint"}
    assert wanted - given == set()
    assert CALLS_WITHOUT_RESULT - vars(RemoteContext).keys() == set()
    assert set(HANDLES) - wanted == set()


SLOW = LOAD + """        context = self.context
        self.said = context.publish("said", "std_msgs/Float64")
        self.calls = []
        context.serve("ask", "std_srvs/Trigger", self.answer)
        context.every(100.0, self.call)
        context.once(context.now_ns + 300_000_000, lambda: self.calls.append("once"))

    def reset(self):
        self.calls.append("reset")

    def call(self):
        if not self.calls:
            self.calls.append("slow")
            while not {gate}:
                pass
        self.said.publish(self.context.message("std_msgs/Float64"))

    def answer(self, request, response):
        response.message = list(self.calls)
"""


def runs(one, count=20):
    """The world makes steps by itself, and the plugin that works is called on the way."""
    before, step = len(one.graph.on("works/alive")), one.sim.clock.step
    until(lambda: len(one.graph.on("works/alive")) >= before + count)
    assert one.sim.clock.step > step


PARTS = """import os, sys, time; out = int(sys.argv[1]); os.write(out, b'\\xff\\xff' + bytes(6)); \
[(os.write(out, b'x'), time.sleep(0.1)) for _ in range(9000)]"""   # of a message


@pytest.mark.parametrize(("when", "statement"), [
    ("import", "__import__('time').sleep(1000)"),
    ("load", "while True: pass"),
    ("load", "while True: self.context.models()"),
    ("load", PARTS),
    ("call", "__import__('time').sleep(1000)"),
])
def test_the_world_continues_while_a_plugin_hangs(case, when, statement):
    one = case(limits=CallLimits(1000.0, 1000.0))
    one.sim.clock.unpause()
    source = {"import": "{}\n", "load": LOAD + "        {}\n", "call": CALL + "        {}\n"}
    one.file.write_text(source[when].format(statement))
    one.sim.models.spawn(model("bad", "libbad.so"))
    one.host.wake()
    until(lambda: any(running.is_busy for running in one.host._running.values()))
    runs(one)
    assert one.failed() == []
    one.sim.models.delete("bad")   # which ends the call
    until(lambda: not any(running.is_busy for running in one.host._running.values()))
    runs(one)
    assert one.host.wait_until_loaded() and one.failed() == []


def test_a_plugin_that_hangs_in_a_running_world_is_named_and_the_next_one_is_loaded(case):
    one = case(limits=CallLimits(0.75, 1000.0))
    one.sim.clock.unpause()
    one.spawn(LOAD + "        while True: pass\n")   # returns when it is known
    (issue,) = one.failed()
    assert "s of processor time" in issue.message and f"{one.file}:6)" in issue.message
    runs(one)
    one.sim.models.delete("bad")
    one.spawn(MOVES)
    assert len(one.failed()) == 1 and one.ask("ask", data="good").message


def test_a_slow_call_ends_and_what_came_meanwhile_follows(case, tmp_path):
    one = case(limits=CallLimits(1000.0, 1000.0))
    gate = tmp_path / "gate"
    one.sim.clock.unpause()
    one.spawn(SLOW.format(gate=f"__import__('os').path.exists({str(gate)!r})"))
    until(lambda: any(running.is_busy for running in one.host._running.values()))
    asked = Future()
    threading.Thread(target=lambda: asked.set_result(one.ask("ask").message)).start()
    runs(one, 100)
    one.sim.resets.reset_world()
    runs(one)
    assert not asked.done() and one.graph.on("said") == []
    gate.touch()
    assert asked.result(60.0)[0] == "slow"
    until(lambda: len(one.graph.on("said")) > 10)
    assert sorted(one.ask("ask").message) == ["once", "reset", "slow"] and one.failed() == []
