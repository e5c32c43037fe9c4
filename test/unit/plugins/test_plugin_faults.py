"""Every exception of a plugin ends that plugin only, and is reported with its file and line."""
from __future__ import annotations

import itertools
from dataclasses import replace

import pytest
from kinematic_backend import KinematicBackend
from plugin_case import PluginCase, kept
from waiting import until

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.world import World
from my_simulations.plugins.call_watch import CALL_LIMITS, CallLimits

NUMBERS = itertools.count()
HEAD = "from my_simulations.plugins.base import Plugin\n\n\nclass Bad(Plugin):\n"
LOAD = HEAD + "    def load(self):\n"
LONG = "raise ValueError('x' * 50_000_000)"


def model(name, library="libgood.so"):
    links = [Link("base", inertial=Inertial()), Link("wheel", inertial=Inertial())]
    return Model(name, links=links,
                 joints=[Joint("hinge", "revolute", "base", "wheel", axis=JointAxis())],
                 plugins=[PluginSpec("p", library, "<plugin/>", "robot.urdf", 12)])


GOOD = HEAD.replace("Bad", "Good") + """
    def load(self):
        self.topic = self.context.publish(f"{self.context.model}/alive", "std_msgs/Empty")
        self.context.every(100.0, lambda: self.topic.publish(self.context.now_ns))
"""


class Case(PluginCase):
    """A world with a plugin that works, and modules of plugins that a test writes."""

    def __init__(self, folder, limits=CALL_LIMITS, isolate=False):
        number = next(NUMBERS)
        self.good, self.bad = f"good_{number}", f"bad_{number}"
        self.folder = folder
        (folder / f"{self.good}.py").write_text(GOOD)
        super().__init__(World(models=[model("works")]), KinematicBackend,
                         {"libgood.so": f"{self.good}:Good", "libbad.so": f"{self.bad}:Bad"},
                         limits, isolate=isolate)

    @property
    def file(self):
        return self.folder / f"{self.bad}.py"

    def spawn(self, source):
        self.file.write_text(source)
        self.sim.models.spawn(model("bad", "libbad.so"))
        assert self.host.wait_until_loaded()

    def failed(self):
        return [issue for issue in self.issues if issue.code == "plugin-failed"]

    def goes_on(self):
        """The plugin that works is called at the next steps."""
        before = len(self.graph.on("works/alive"))
        self.sim.clock.advance(50)
        until(lambda: len(self.graph.on("works/alive")) == before + 5)


@pytest.fixture
def case(tmp_path, monkeypatch, request):
    monkeypatch.syspath_prepend(str(tmp_path))
    yield from kept(lambda **options: Case(tmp_path, **options))


@pytest.mark.parametrize(("source", "line", "said"), [
    ("x = = 1\n", 1, "SyntaxError"),
    ("import no_such_module_at_all\n", 1, "ModuleNotFoundError"),
    ("\nundefined_name\n", 2, "NameError"),
    ("import sys\nsys.exit(3)\n", 2, "SystemExit: 3"),
    ("raise KeyboardInterrupt\n", 1, "KeyboardInterrupt"),
    ("raise GeneratorExit\n", 1, "GeneratorExit"),
    ("x = 1\n" + LONG, 2, "ValueError: xxx"),
    (HEAD + "    def __init__(self, context):\n        1 / 0\n", 6, "ZeroDivisionError"),
    (HEAD + "    def __init__(self, context):\n        raise SystemExit\n", 6, "SystemExit"),
    (LOAD + "        raise KeyboardInterrupt('here')\n", 6, "KeyboardInterrupt: here"),
    (LOAD + f"        {LONG}\n", 6, "49999500 more characters"),
    (LOAD + "        def again(): again()\n        again()\n", 6, "RecursionError"),
    (LOAD + "        self.context.every(100.0, None)\n", 0, "TypeError"),
    (LOAD + "        self.context.link('nowhere')\n", 6, "nowhere"),
    (HEAD + "    pass\n", 0, ".py has no method 'load'"),
    ("Bad = 1\n", 0, ".py is not a class derived from"),
    (LOAD + "        def call():\n            exit(1)\n        self.context.every(100.0, call)\n",
     7, "SystemExit: 1"),
], ids=itertools.count())
def test_an_exception_ends_one_plugin_only(case, source, line, said):
    one = case()
    one.spawn(source)
    one.goes_on()
    (issue,) = one.failed()
    assert "plugin 'p' (libbad.so) of model 'bad'" in issue.message
    assert (issue.file, issue.line) == ("robot.urdf", 12)
    assert said in issue.message and len(issue.message) < 1000
    if line:
        assert f"{one.file}:{line})" in issue.message


@pytest.mark.parametrize("call", ["reset", "clock_set", "close"])
def test_an_exception_in_a_notification_ends_one_plugin_only(case, call):
    one = case()
    one.spawn(LOAD + f"        pass\n    def {call}(self):\n        raise SystemExit(4)\n")
    if call == "reset":
        one.sim.resets.reset_simulation()
    elif call == "clock_set":
        one.sim.clock.advance(10)
        one.sim.resets.reset_time()
    else:
        one.sim.models.delete("bad")
    until(one.failed)
    one.goes_on()
    (issue,) = one.failed()
    assert f"SystemExit: 4 (in {call}, {one.file}:8)" in issue.message


@pytest.mark.parametrize("call", [
    "self.context.transform('a', 'b', None)",
    "self.context.joint('hinge').drive('fast', 1.0)",
    "self.context.joint('hinge').set_servo(None)",
    "self.context.joint('hinge').drive(float('nan'), 1.0)",
    "self.context.set_wrench('base', 'up', None)",
    "self.context.set_planar_velocity('x', None, {})",
    "self.context.move(None)",
    "self.context.publish('t', 'std_msgs/Empty').publish_later(None)",
])
def test_a_wrong_argument_ends_one_plugin_only(case, call):
    one = case()
    one.spawn(LOAD + f"        {call}\n")
    until(one.failed)
    one.goes_on()
    (issue,) = one.failed()
    assert "plugin 'p' (libbad.so) of model 'bad'" in issue.message
    one.sim.models.delete("bad")
    one.goes_on()


def test_an_exception_with_a_broken_text_is_reported(case):
    one = case()
    one.spawn("class Odd(Exception):\n    def __str__(self):\n        raise SystemExit\n"
              "raise Odd\n")
    one.goes_on()
    (issue,) = one.failed()
    assert "Odd: its message cannot be read (SystemExit)" in issue.message


def test_faults_of_a_model_are_known(case):
    one = case()
    one.spawn("undefined_name\n")
    assert one.host.faults("bad") == one.failed()
    assert one.host.faults("works") == one.host.faults("none") == []


@pytest.mark.parametrize("source", [
    "while True:\n    pass\n",
    HEAD + "    def __init__(self, context):\n        while True: pass\n",
    LOAD + "        while True: pass\n",
])
def test_a_loop_before_the_first_call_is_ended(case, source):
    one = case(limits=CallLimits(0.1, 10.0))
    one.spawn(source)
    one.goes_on()
    (issue,) = one.failed()
    assert "0.2 s of processor time (in " in issue.message
    assert f"{one.file}:" in issue.message


def test_a_replaced_model_has_new_plugins(case):
    """Also if the host has seen no moment without the model."""
    one = case()
    one.spawn("undefined_name\n")
    one.sim.models.spawn(model("bad"), replace=True)
    assert one.host.wait_until_loaded()
    one.sim.clock.advance(20)
    until(lambda: len(one.graph.on("bad/alive")) == 2)


NEEDS_JOINT = HEAD + """
    def load(self):
        self.joint = self.context.joint("late_hinge")
        self.topic = self.context.publish(f"{self.context.model}/late", "std_msgs/Empty")
        self.context.every(100.0, lambda: self.topic.publish(self.context.now_ns))
"""


def test_a_plugin_that_failed_starts_again_when_its_model_is_edited(case):
    made = case()
    made.spawn(NEEDS_JOINT)
    assert len(made.failed()) == 1
    described = made.sim.models.get("bad")
    hinge = Joint("late_hinge", "revolute", "base", "extra", axis=JointAxis())
    extra = Link("extra", inertial=Inertial())
    made.sim.models.edit("bad", replace(described, links=[*described.links, extra]))
    assert made.host.wait_until_loaded()
    assert len(made.failed()) == 2  # it lacks its joint still
    made.sim.models.edit("bad", replace(described, links=[*described.links, extra],
                                        joints=[*described.joints, hinge]))
    assert made.host.wait_until_loaded()
    assert made.host.faults("bad") == []
    made.sim.clock.advance(50)
    until(lambda: len(made.graph.on("bad/late")) == 5)
    assert len(made.failed()) == 2
    made.goes_on()


def test_an_edit_starts_no_plugin_again_that_works(case):
    made = case()
    made.goes_on()
    running = made.host._models.plugins_of("works")[0].plugin
    described = made.sim.models.get("works")
    made.sim.models.edit("works", replace(described, allow_auto_disable=False))
    assert made.host.wait_until_loaded()
    assert made.host._models.plugins_of("works")[0].plugin is running
    made.goes_on()


def test_a_plugin_starts_again_when_its_model_gets_other_joints(case):
    made = case()
    running = made.host._models.plugins_of("works")[0].plugin
    described = made.sim.models.get("works")
    made.sim.models.edit("works", replace(described, joints=[
        replace(joint, name="renamed") for joint in described.joints]))
    assert made.host.wait_until_loaded()
    assert made.host._models.plugins_of("works")[0].plugin is not running
    made.goes_on()
