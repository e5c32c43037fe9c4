"""Plugins in a simulator without physics: starting, failing, resetting, ending."""
from __future__ import annotations

import threading
from concurrent.futures import Future
from dataclasses import replace

import pytest
from kinematic_backend import KinematicBackend
from plugin_case import PluginCase, kept
from plugin_graph import Graph
from waiting import until

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.sensor import Ray, ScanAngles, Sensor
from my_simulations.description.shapes import Collision, Sphere
from my_simulations.description.world import World
from my_simulations.engine.ring import RECORDS
from my_simulations.errors import Severity
from my_simulations.geometry import Pose
from my_simulations.plugins.base import Plugin
from my_simulations.plugins.call_watch import CALL_LIMITS, CallLimits
from my_simulations.plugins.context import PluginError, RequestError
from my_simulations.plugins.graph import TopicUse
from my_simulations.plugins.registry import PluginRegistry, library_name, plugin_class, read_exports
from my_simulations.plugins.testing import Message
from my_simulations.sensing.api import RayReturns

DRIVE = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
<leftJoint>left</leftJoint><rightJoint>right</rightJoint><wheelDiameter>0.2</wheelDiameter>
<odometrySource>encoder</odometrySource></plugin>"""


class Failing(Plugin):
    def load(self):
        self.context.every(100.0, self.update)

    def update(self):
        raise ZeroDivisionError("nothing to divide")


class Counting(Plugin):
    calls = []

    def load(self):
        self.context.every(100.0, lambda: self.calls.append(self.context.now_ns))

    def reset(self):
        self.calls.append("reset")

    def clock_set(self):
        self.calls.append("clock set")


def robot(name="robot", xml=DRIVE, library="libgazebo_ros_diff_drive.so"):
    links = [Link(one, inertial=Inertial()) for one in ("base", "wheel_l", "wheel_r")]
    joints = [Joint("left", "revolute", "base", "wheel_l", axis=JointAxis()),
              Joint("right", "revolute", "base", "wheel_r", axis=JointAxis())]
    return Model(name, links=links, joints=joints,
                 plugins=[PluginSpec("drive", library, xml, "robot.urdf", 12)])


class Case(PluginCase):
    def __init__(self, *models, extra=None, limits=CALL_LIMITS, plugins=()):
        super().__init__(World(models=list(models), plugins=list(plugins)), KinematicBackend,
                         extra, limits)

    def failed(self):
        return [issue for issue in self.issues if issue.code == "plugin-failed"]

    def backend(self):
        return self.sim._session.supervisor.engine.backend

    def command(self, **fields):
        self.graph.heard["robot/cmd_vel"](Message(**fields))


@pytest.fixture
def case():
    yield from kept(Case)


def test_a_robot_of_the_world_drives(case):
    one = case(robot())
    one.command(linear={"x": 0.5}, angular={"z": 0.0})
    one.sim.clock.advance(1010)
    until(lambda: len(one.graph.on("robot/odom")) == 101)
    odom = one.graph.on("robot/odom")[-1]
    assert odom.pose.pose.position.x == pytest.approx(0.5)
    assert odom.header.stamp == 1_010_000_000
    assert one.graph.transforms[-1][:3] == (1_010_000_000, "odom", "base_footprint")


P3D = """<plugin name="p3d" filename="libgazebo_ros_p3d.so"><topicName>truth</topicName>
<bodyName>{}</bodyName></plugin>"""


def test_a_link_of_another_model_is_not_taken_for_the_own_one_of_that_name(case):
    """Gazebo finds links of a model by their plain name, or below the name of that model."""
    library = "libgazebo_ros_p3d.so"
    one = case(robot("other", P3D.format("base"), library),
               robot("robot", P3D.format("other::base"), library))
    (told,) = one.failed()
    assert "model 'robot' has no link 'other::base'" in told.message


def test_links_and_joints_may_be_named_below_their_model(case):
    scoped = DRIVE.replace(">left<", ">robot::left<").replace(">right<", ">robot::right<")
    one = case(robot(xml=scoped), robot("seen", P3D.format("seen::base"), "libgazebo_ros_p3d.so"))
    one.command(linear={"x": 0.5}, angular={"z": 0.0})
    one.sim.clock.advance(1010)
    until(lambda: len(one.graph.on("robot/odom")) == 101)
    assert one.graph.on("robot/odom")[-1].pose.pose.position.x == pytest.approx(0.5)
    assert one.failed() == []


def test_the_same_run_gives_the_same_messages(case):
    def run():
        one = case(robot())
        one.command(linear={"x": 0.5}, angular={"z": 0.3})
        one.sim.clock.advance(500)
        until(lambda: len(one.graph.on("robot/odom")) == 50)
        return [(m.header.stamp, m.pose.pose.position.x, m.pose.pose.position.y,
                 m.twist.twist.linear.x) for m in one.graph.on("robot/odom")]

    assert run() == run()


def test_a_spawned_robot_has_its_plugin_and_a_deleted_one_has_not(case):
    one = case()
    one.sim.models.spawn(robot())
    one.host.wait_until_loaded()
    assert "robot/cmd_vel" in one.graph.heard
    one.sim.models.delete("robot")
    one.host.wait_until_loaded()
    assert "robot/cmd_vel" not in one.graph.heard
    assert one.sim.clock.advance(50) == 50


def test_a_plugin_that_fails_is_switched_off_and_the_others_go_on(case):
    failing = robot("bad", "<plugin/>", "libfailing.so")
    one = case(failing, robot(), extra={"libfailing.so": f"{__name__}:Failing"})
    one.sim.clock.advance(100)
    until(lambda: len(one.graph.on("robot/odom")) == 10)
    (issue,) = [issue for issue in one.issues if issue.code == "plugin-failed"]
    assert issue.severity is Severity.ERROR and (issue.file, issue.line) == ("robot.urdf", 12)
    assert "nothing to divide" in issue.message and "test_host.py" in issue.message


def test_an_unknown_library_is_one_warning_that_names_it(case):
    one = case(robot("a", "<plugin/>", "libmystery.so"), robot("b", "<plugin/>", "libmystery.so"))
    (issue,) = [issue for issue in one.issues if issue.code == "plugin-unknown"]
    assert "libmystery.so" in issue.message and issue.line == 12


@pytest.mark.parametrize("library", ["libmystery.so", "libfailing.so"])
def test_messages_about_a_plugin_of_the_world_say_so(case, library):
    one = case(plugins=[PluginSpec("sky", library, "<plugin/>", "a.world", 3)],
               extra={"libfailing.so": f"{__name__}:Failing"})
    one.sim.clock.advance(20)
    until(lambda: one.issues)
    assert " of the world " in one.issues[0].message


def test_a_well_known_library_without_a_substitute_has_a_reason_and_an_alternative(case):
    one = case(robot("a", "<plugin/>", "libgazebo_ros_controller_manager.so"))
    (issue,) = [issue for issue in one.issues if issue.code == "plugin-unknown"]
    assert "libgazebo_ros_controller_manager.so: the controllers of PR2 are" in issue.message
    assert "libgazebo_ros_control.so" in issue.hint


@pytest.mark.parametrize("library, reason", [
    ("libKeyboardGUIPlugin.so", "Gazebo's own window"),
    ("libFlashLightPlugin.so", "the lights stay as the file sets them"),
    ("libCameraPlugin.so", "topics of Gazebo's own transport"),
    ("libBloomVisualPlugin.so", "no bloom"),
    ("libLensFlareVisualPlugin.so", "no lens flare"),
])
def test_a_library_without_an_effect_here_is_one_note_with_its_reason(case, library, reason):
    one = case(robot("a", "<plugin/>", library), robot("b", "<plugin/>", library))
    (issue,) = one.issues
    assert (issue.code, issue.severity) == ("not-simulated", Severity.NOTE)
    assert library in issue.message and reason in issue.message and issue.line == 12
    assert one.host.faults("a") == []


def test_a_joint_that_is_missing_is_the_users_fault_and_said_without_a_traceback(case):
    one = case(robot(xml="<plugin><leftJoint>nowhere</leftJoint></plugin>"))
    (issue,) = [issue for issue in one.issues if issue.code == "plugin-failed"]
    assert "no joint 'nowhere'; there are left, right" in issue.message
    assert one.sim.clock.advance(20) == 20


def test_resets_are_told_apart(case):
    Counting.calls = []
    one = case(robot("c", "<plugin/>", "libcounting.so"),
               extra={"libcounting.so": f"{__name__}:Counting"})
    one.sim.clock.advance(20)
    one.sim.resets.reset_time()
    one.sim.clock.advance(10)
    one.sim.resets.reset_simulation()
    one.sim.clock.advance(10)
    one.sim.resets.reset_world()
    until(lambda: len(Counting.calls) == 7)
    assert Counting.calls == [10_000_000, 20_000_000, "clock set", 10_000_000, "reset",
                              10_000_000, "reset"]


def test_plugins_go_on_when_the_engine_is_another(case):
    one = case(robot())
    one.command(linear={"x": 0.5}, angular={"z": 0.0})
    one.sim.clock.advance(100)
    one.sim._session.supervisor.engine.kill()
    one.sim.clock.advance(0)
    one.sim.clock.advance(110)
    until(lambda: len(one.graph.on("robot/odom")) == 21)
    places = [odom.pose.pose.position.x for odom in one.graph.on("robot/odom")]
    assert max(b - a for a, b in zip(places, places[1:])) == pytest.approx(0.005)


def test_an_edited_robot_keeps_its_plugin(case):
    one = case(robot())
    one.command(linear={"x": 0.5}, angular={"z": 0.0})
    one.sim.clock.advance(100)
    one.sim.models.set_link_inertial("robot::base", Inertial(mass=3.0))
    one.sim.clock.advance(110)
    until(lambda: len(one.graph.on("robot/odom")) == 21)
    assert one.graph.on("robot/odom")[-1].twist.twist.linear.x == pytest.approx(0.5)
    assert one.graph.sent.count(("robot/odom", None)) == 0


def test_ending_leaves_no_thread_and_holds_nobody_up(case):
    one = case(robot())
    one.host.stop()
    assert one.sim.clock.advance(100 * RECORDS) == 100 * RECORDS
    assert not any(thread.name == "plugins" for thread in threading.enumerate())


def test_libraries_are_known_by_their_file_name(tmp_path):
    assert library_name("/opt/ros/lib/libfoo.so") == library_name("foo") == "libfoo.so"
    (tmp_path / "package.xml").write_text(
        '<package><export><my_simulations plugin="a.b:C" library="libfoo.so"/></export></package>')
    assert read_exports(str(tmp_path / "package.xml")) == [
        {"plugin": "a.b:C", "library": "libfoo.so"}]


def test_a_package_brings_a_plugin(case, tmp_path):
    (tmp_path / "package.xml").write_text(
        f'<package><export><my_simulations plugin="{__name__}:Counting" library="libfoo.so"/>'
        "</export></package>")
    assert plugin_class(PluginRegistry({}, lambda: [str(tmp_path)]).locate("libfoo.so")) is Counting


class Spinning(Plugin):
    """Loops for ever in the named function."""

    where = "update"

    def load(self):
        self.context.subscribe("talk", "std_msgs/Empty", lambda message: self.spin("hear"))
        self.context.every(100.0, lambda: self.spin("update"))
        self.spin("load")

    def reset(self):
        self.spin("reset")

    def spin(self, where):
        while where == self.where:
            pass


class Sleeping(Plugin):
    """Waits in the kernel, where no exception reaches it."""

    ends = threading.Event()

    def load(self):
        self.context.every(100.0, self.ends.wait)


@pytest.mark.parametrize("where", ["load", "update", "reset", "hear"])
def test_a_plugin_that_never_returns_is_switched_off_and_the_others_go_on(case, monkeypatch, where):
    monkeypatch.setattr(Spinning, "where", where)
    one = case(robot("bad", "<plugin/>", "libspin.so"), robot(), limits=CallLimits(0.1, 10.0),
               extra={"libspin.so": f"{__name__}:Spinning"})
    if where == "reset":
        one.sim.resets.reset_simulation()
    if where == "hear":
        one.graph.heard["talk"](Message())
    one.sim.clock.advance(100)
    until(lambda: len(one.graph.on("robot/odom")) == 10)
    until(lambda: one.failed())
    (issue,) = one.failed()
    assert (issue.file, issue.line) == ("robot.urdf", 12)
    limit = "0.2" if where == "load" else "0.1"
    assert f"{limit} s of processor time (in spin, " in issue.message
    assert "test_host.py" in issue.message


def test_a_plugin_that_waits_for_ever_is_left_behind(case, monkeypatch):
    monkeypatch.setattr(Sleeping, "ends", threading.Event())
    one = case(robot("bad", "<plugin/>", "libsleep.so"), robot(), limits=CallLimits(5.0, 0.2),
               extra={"libsleep.so": f"{__name__}:Sleeping"})
    one.command(linear={"x": 0.5}, angular={"z": 0.0})
    one.sim.clock.advance(110)
    until(lambda: len(one.graph.on("robot/odom")) == 11)
    (issue,) = one.failed()
    assert "waited for more than 0.2 s" in issue.message and "left behind" in issue.message
    assert "advance" not in issue.message
    Sleeping.ends.set()
    until(lambda: sum(thread.name == "plugins" for thread in threading.enumerate()) == 1)
    one.sim.clock.advance(100)
    until(lambda: len(one.graph.on("robot/odom")) == 21)
    assert len(one.failed()) == 1


class Grumbling(Plugin):
    def load(self):
        for topic in "ab":
            self.context.subscribe(topic, "std_msgs/Empty", self.receive, queue=5)
        self.context.serve("ask", "std_srvs/Empty", lambda request, response: self.receive(None))
        self.context.every(100.0, lambda: self.receive(None))
        self.context.every(50.0, lambda: self.receive(None))

    def receive(self, message):
        raise RuntimeError("no")


def test_a_plugin_that_raises_in_everything_is_switched_off_once(case):
    one = case(robot("bad", "<plugin/>", "libgrumble.so"),
               extra={"libgrumble.so": f"{__name__}:Grumbling"})
    ask = one.graph.heard["ask"]
    for topic in "aabab":
        one.graph.heard.get(topic, lambda message: None)(Message())
    one.sim.clock.advance(100)
    until(one.failed)
    one.sim.clock.advance(100)
    assert len(one.failed()) == 1 and not one.host.has_pending_input
    with pytest.raises(PluginError, match="ended"):
        ask(Message(), Message())


def test_who_asks_a_service_hears_why_it_failed(case):
    one = case(robot("bad", "<plugin/>", "libgrumble.so"),
               extra={"libgrumble.so": f"{__name__}:Grumbling"})
    with pytest.raises(PluginError, match="no"):
        one.graph.heard["ask"](Message(), Message())


class Refusing(Plugin):
    calls = []

    def load(self):
        self.context.serve("ask", "std_srvs/Empty", self.asked)
        self.context.every(100.0, lambda: self.calls.append(self.context.now_ns))

    def asked(self, request, response):
        raise RequestError("there is no such value")


class Offering(Plugin):
    """Offers a service under a name that is the same for all."""

    updates = []

    def load(self):
        self.context.serve("/default_imu", "std_srvs/Empty", lambda request, response: None)
        self.context.every(100.0, self.update)

    def update(self):
        self.updates.append(self.context.now_ns)


def test_a_plugin_goes_on_without_a_service_that_another_one_offers(case):
    first, second = robot("first", library="liboffer.so"), robot("second", library="liboffer.so")
    one = case(first, second, extra={"liboffer.so": f"{__name__}:Offering"})
    Offering.updates.clear()
    one.sim.clock.advance(20)
    until(lambda: Offering.updates == [10_000_000, 10_000_000, 20_000_000, 20_000_000])
    (told,) = [issue for issue in one.issues if "/default_imu is offered already" in issue.message]
    assert (told.severity, told.line) == (Severity.WARNING, 12) and "'second'" in told.message
    assert not one.failed()
    one.sim.models.delete("second")
    one.host.wait_until_loaded()
    assert "/default_imu" in one.graph.heard


def test_a_request_that_makes_no_sense_is_refused_and_the_plugin_goes_on(case, monkeypatch):
    monkeypatch.setattr(Refusing, "calls", [])
    one = case(robot("choosy", "<plugin/>", "librefuse.so"),
               extra={"librefuse.so": f"{__name__}:Refusing"})
    with pytest.raises(RequestError, match="no such value"):
        one.graph.heard["ask"](Message(), Message())
    one.sim.clock.advance(20)
    until(lambda: len(Refusing.calls) == 2)
    assert not one.failed()


class OfTheWorld(Plugin):
    found = []

    def load(self):
        self.found.append((self.context.model, sorted(self.context.models())))


def test_a_world_has_plugins_too(case, monkeypatch):
    monkeypatch.setattr(OfTheWorld, "found", [])
    case(robot(), extra={"libworld.so": f"{__name__}:OfTheWorld"},
         plugins=[PluginSpec("w", "libworld.so", "<plugin/>", "a.world", 3)])
    assert OfTheWorld.found == [("world", ["robot"])]


class Moving(Plugin):
    faults = []

    def load(self):
        self.context.move_model("robot", Pose((1.0, 2.0, 3.0)))
        try:
            self.context.move_model("nobody", Pose())
        except PluginError as fault:
            self.faults.append(str(fault))


def test_a_plugin_of_the_world_moves_models(case, monkeypatch):
    monkeypatch.setattr(Moving, "faults", [])
    one = case(robot(), extra={"libmoving.so": f"{__name__}:Moving"},
               plugins=[PluginSpec("m", "libmoving.so", "<plugin/>", "a.world", 3)])
    one.sim.clock.advance(1)
    assert one.sim.states.model_state("robot")[0].position == (1.0, 2.0, 3.0)
    assert "nobody" in Moving.faults[0]


class Looking(Plugin):
    def load(self):
        self.context.use_namespace("eyes")
        self.topic = self.context.publish("scan", "sensor_msgs/LaserScan")
        self.context.subscribe("/stop", "std_msgs/Empty", lambda message: self.topic.close())


def with_eyes():
    model, place = robot("robot", "<plugin/>", "libnone.so"), Pose((0.1, 0.0, 0.2))
    model.plugins = []
    model.links[1].sensors = [Sensor("laser", "ray", place, plugins=[
        PluginSpec("look", "liblook.so", "<plugin/>", "robot.urdf", 3)])]
    return model, place


def test_topics_of_plugins_are_known_with_the_place_of_their_sensor(case):
    model, place = with_eyes()
    one = case(model, extra={"liblook.so": f"{__name__}:Looking"})
    scan = TopicUse("eyes/scan", "sensor_msgs/LaserScan", False, "robot", "wheel_l", "ray", place)
    stop = TopicUse("/stop", "std_msgs/Empty", True, "robot", "wheel_l", "ray", place)
    assert one.host.topic_uses() == [scan, stop]
    one.graph.heard["/stop"](Message())
    until(lambda: one.host.topic_uses() == [stop])
    one.sim.models.delete("robot")
    one.host.wait_until_loaded()
    assert one.host.topic_uses() == []


def test_topics_of_a_drive_belong_to_no_link(case):
    one = case(robot())
    uses = {use.name: use for use in one.host.topic_uses()}
    assert uses["robot/cmd_vel"].is_subscription and not uses["robot/odom"].is_subscription
    assert {(use.model, use.link, use.sensor) for use in uses.values()} == {("robot", "", "")}


class Mumbling(Plugin):
    def load(self):
        self.context.use_namespace("eyes")
        self.topic = self.context.publish("", "sensor_msgs/LaserScan")
        self.context.publish("scan", "sensor_msgs/LaserScan")
        self.context.every(100.0, lambda: self.topic.publish(str(self.topic.wanted)))
        self.context.subscribe("/stop", "std_msgs/Empty", lambda message: self.topic.close())


def test_a_topic_without_a_name_is_offered_to_nobody(case):
    one = case(robot("robot", "<plugin/>", "libmumble.so"),
               extra={"libmumble.so": f"{__name__}:Mumbling"})
    one.sim.clock.advance(20)
    assert [use.name for use in one.host.topic_uses()] == ["eyes/scan", "/stop"]
    one.deliver("/stop")
    assert (one.graph.sent, one.failed()) == ([], [])


class Asking(Plugin):
    found = []

    def load(self):
        self.context.use_namespace(self.context.parameters.text("robotNamespace"))
        self.context.publish("scan", "sensor_msgs/LaserScan")
        self.found.append(self.context.parameter("rate", None))


@pytest.mark.parametrize(("namespace", "topic", "rate"), [
    ("", "scan", 1), ("/", "/scan", 2), (" / ", "/scan", 2), ("a", "a/scan", 3),
    ("a/", "a/scan", 3), ("/a/", "/a/scan", 4)])
def test_names_are_in_the_node_s_namespace_the_root_or_the_one_given(
        case, namespace, topic, rate, monkeypatch):
    monkeypatch.setattr(Asking, "found", [])
    rates = {"": 1, "/": 2, "a": 3, "/a": 4}
    monkeypatch.setattr(Graph, "parameter", lambda _, at, name, default: rates.get(at, default))
    xml = f"<plugin><robotNamespace>{namespace}</robotNamespace></plugin>"
    one = case(robot("robot", xml, "libask.so"), extra={"libask.so": f"{__name__}:Asking"})
    assert [use.name for use in one.host.topic_uses()] == [topic]
    assert Asking.found == [rate]


def test_a_plugin_that_was_switched_off_has_no_topics(case):
    one = case(robot("bad", "<plugin/>", "libgrumble.so"),
               extra={"libgrumble.so": f"{__name__}:Grumbling"})
    assert [use.name for use in one.host.topic_uses()] == ["a", "b"]
    one.sim.clock.advance(20)
    until(one.failed)
    assert one.host.topic_uses() == []


class Pushing(Plugin):
    def load(self):
        self.context.subscribe("push", "std_msgs/Float64", self.receive)

    def receive(self, message):
        self.context.set_wrench("wheel_l", (message.data, 0.0, 0.0), (0.0, 0.0, 0.0))
        self.context.set_wrench("other::base", (0.0, message.data, 0.0), (0.0, 0.0, 0.0))
        self.context.set_wrench("gone::base", (0.0, message.data, 0.0), (0.0, 0.0, 0.0))


def test_wrenches_replace_each_other_in_one_gap_and_end_with_the_plugin(case):
    one = case(robot("me", "<plugin/>", "libpush.so"), robot("other"),
               extra={"libpush.so": f"{__name__}:Pushing"})

    def acting():
        return {(force.row, force.force)
                for force in one.sim.wrenches.pending(one.sim.clock.step)}

    for newton in (1.0, 2.0, 0.0, 3.0):
        one.graph.heard["push"](Message(data=newton))
        wanted = {(1, (newton, 0.0, 0.0)), (3, (0.0, newton, 0.0))} if newton else set()
        until(lambda wanted=wanted: acting() == wanted)
    one.sim.models.delete("me")
    until(lambda: acting() == set())


class Joining(Plugin):
    def load(self):
        self.context.attach("hold", "me::base", "other::base")
        self.context.subscribe("leave", "std_msgs/Empty",
                               lambda message: self.context.detach("hold"))


@pytest.mark.parametrize("how", ["told", "reset", "deleted", "switched off"])
def test_what_is_attached_is_let_go(case, how):
    one = case(robot("me", "<plugin/>", "libjoin.so"), robot("other"),
               extra={"libjoin.so": f"{__name__}:Joining"})
    connected = one.backend().connected
    assert list(connected) == ["hold"] and not one.sim.models.inter_model_joints
    if how == "told":
        one.graph.heard["leave"](Message())
    elif how == "reset":
        one.sim.resets.reset_simulation()
    elif how == "deleted":
        one.sim.models.delete("me")
    else:
        (running,) = [running for running in one.host._at_work() if "libjoin" in
                      running.found.spec.filename]
        running.context.inbox.append(lambda: 1 / 0)
        one.host._mark_input(running)
    until(lambda: not connected)


SLIP = """<plugin name="slip" filename="libWheelSlipPlugin.so"><wheel link_name="wheel_l">
<wheel_normal_force>10</wheel_normal_force><wheel_radius>0.1</wheel_radius></wheel></plugin>"""
SUCTION = """<plugin name="cup" filename="libgazebo_ros_vacuum_gripper.so">
<topicName>holds</topicName><bodyName>base</bodyName></plugin>"""
WRENCH = """<plugin name="ft" filename="libgazebo_ros_ft_sensor.so"><jointName>left</jointName>
<topicName>wrench</topicName></plugin>"""


def test_plugins_of_a_nested_model_find_its_links_and_joints_by_their_plain_names(case):
    """They slip, hold, and measure, as those of a model that is not nested."""
    inner = robot("inner")
    inner.links[1].collisions.append(Collision("c", Sphere(0.1)))
    inner.plugins = [PluginSpec(library, f"lib{library}.so", xml, "robot.sdf", 3)
                     for library, xml in (("WheelSlipPlugin", SLIP),
                                          ("gazebo_ros_vacuum_gripper", SUCTION),
                                          ("gazebo_ros_ft_sensor", WRENCH))]
    outer = Model("outer", links=[Link("frame", inertial=Inertial())], models=[inner])
    one = case(outer, Model("cube", pose=Pose((0.01, 0.0, 0.0)),
                            links=[Link("link", inertial=Inertial())]))
    one.graph.heard["on"](Message(), Message())
    one.sim.clock.advance(50)
    assert one.issues == []
    assert len(one.backend().wheel_slips) == 1
    until(lambda: any(message.data for message in one.graph.on("holds")))


FAST_LASER = """<plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>scan</topicName>
</plugin>"""


class Rays:
    """Stands for the sensing process; answers when it is told to."""

    def __init__(self, host):
        self.waiting, self.rows = [], []
        host._scene.cast = self.cast

    def cast(self, mount, fan, visuals, ns, rows):
        self.waiting.append(Future())
        self.rows.append(rows)
        return self.waiting[-1]

    def answer(self):
        import numpy as np

        self.waiting.pop().set_result(RayReturns(np.ones(3), np.zeros(3), np.zeros(3, int)))


def fast_laser():
    model = robot()
    sensor = Sensor("laser", "ray", update_rate=0.0, ray=Ray(ScanAngles(3, 1.0, -1.0, 1.0)),
                    plugins=[PluginSpec("laser", "libgazebo_ros_laser.so", FAST_LASER, "", 1)])
    return replace(model, plugins=[], links=[replace(model.links[0], sensors=[sensor]),
                                             *model.links[1:]])


def test_rays_at_every_step_do_not_hold_a_world_that_runs(case):
    one = case(fast_laser())
    rays = Rays(one.host)
    one.sim.clock.unpause()
    until(lambda: rays.waiting)
    before = one.sim.clock.step
    until(lambda: one.sim.clock.step > before + 2 * RECORDS)
    assert len(rays.waiting) == 1
    rays.answer()
    until(lambda: rays.waiting and len(one.graph.on("scan")) == 1)
    rays.answer()
    until(lambda: len(one.graph.on("scan")) == 2)
    first, second = (message.header.stamp for message in one.graph.on("scan"))
    assert second - first > RECORDS * 10 ** 6


def test_rays_at_every_step_see_each_step_of_a_world_that_is_stepped(case):
    one = case(fast_laser())
    rays = Rays(one.host)
    for step in range(1, 4):
        one.sim.clock.advance(1)
        until(lambda: rays.waiting)
        rays.answer()
        until(lambda step=step: len(one.graph.on("scan")) == step)
    assert [message.header.stamp for message in one.graph.on("scan")] == [
        10 ** 6, 2 * 10 ** 6, 3 * 10 ** 6]


def test_states_say_whether_plugins_run_and_why_not(case):
    libraries = {"fails": "libfails.so", "counts": "libcounts.so"}
    made = case(robot("drives"), robot("fails", "<plugin/>", "libfails.so"),
                robot("counts", "<plugin/>", "libcounts.so"),
                robot("unknown", "<plugin/>", "libnot_there.so"),
                robot("provided", "<plugin/>", "libgazebo_ros_api_plugin.so"),
                extra={libraries["fails"]: f"{__name__}:Failing",
                       libraries["counts"]: f"{__name__}:Counting"})
    made.sim.clock.unpause()
    until(lambda: made.failed())
    states = {one.model: one for one in made.host.states()}
    assert {name: one.state for name, one in states.items()} == {
        "drives": "running", "fails": "failed", "counts": "running", "unknown": "failed",
        "provided": "off"}
    assert "nothing to divide" in states["fails"].reason
    assert states["provided"].reason and not states["drives"].reason


class Rates(Plugin):
    seen = []

    def load(self):
        self.seen.append(self.context.sensor.update_rate)


def test_the_plugin_of_an_edited_sensor_starts_again_with_its_new_values(case):
    model = robot()
    sensor = Sensor("laser", "ray", update_rate=5.0, ray=Ray(),
                    plugins=[PluginSpec("rates", "librates.so", "<plugin/>")])
    model.links[0].sensors.append(sensor)
    made = case(model, extra={"librates.so": f"{__name__}:Rates"})
    assert Rates.seen == [5.0]
    base = replace(model.links[0], sensors=[replace(sensor, update_rate=7.0)])
    made.sim.models.edit("robot", replace(model, links=[base, *model.links[1:]]))
    until(lambda: Rates.seen == [5.0, 7.0])
    assert not made.failed()
