"""What the rostests share: waiting with deadlines, the API's proxies, small models."""
from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
from unittest import mock

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, "unit",
                                "support"))

import rosgraph
import rospy
import rostest
from free_ports import free_port
from gazebo_msgs import srv
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rosgraph_msgs.msg import Log

from my_simulations.ros import interface
from my_simulations.ros.lifecycle import master_api
from my_simulations.ros.prompt_end import end_promptly
from my_simulations.ros.registration import class_of

PACKAGE = "my_simulations"
SECONDS = 120.0
"""Until something must have happened, on a machine that is busy with much else."""

def wait_for(condition, what, seconds=SECONDS):
    """The first true value of `condition()`; an AssertionError that says `what` is missing."""
    until = time.monotonic() + seconds
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > until:
            raise AssertionError(f"{what} did not happen within {seconds} s")
        time.sleep(0.01)


class Gazebo:
    """The services of a running server, each as a method."""

    def __init__(self, node="/gazebo", persistent=True):
        self.node = node
        self._persistent = persistent
        for row in interface.offered_rows(extensions=False):
            if row.direction is interface.SERVES:
                rospy.wait_for_service(row.under(node), timeout=SECONDS)

    def __getattr__(self, name):
        try:
            row = interface.row_of(name, interface.SERVES)
        except KeyError:
            raise AttributeError(name) from None
        rospy.wait_for_service(row.under(self.node), timeout=SECONDS)
        proxy = rospy.ServiceProxy(row.under(self.node), class_of(row),
                                   persistent=self._persistent)
        setattr(self, name, proxy)
        return proxy

    def names(self):
        """Models of the world, in its order."""
        return list(self.get_world_properties().model_names)

    def sim_time(self):
        return self.get_world_properties().sim_time

    def is_paused(self):
        return self.get_physics_properties().pause

    def z(self, model):
        return self.get_model_state(model, "").pose.position.z

    def spawn(self, name, xml=None, where=None, frame="", namespace=""):
        return self.spawn_urdf_model(name, box() if xml is None else xml, namespace,
                                     where or pose(), frame)

    def place(self, model, where, twist=None, frame=""):
        request = srv.SetModelStateRequest()
        request.model_state.model_name = model
        request.model_state.pose = where
        request.model_state.twist = twist or Twist()
        request.model_state.reference_frame = frame
        return self.set_model_state(request)

    def place_link(self, link, where, twist=None, frame=""):
        request = srv.SetLinkStateRequest()
        request.link_state.link_name = link
        request.link_state.pose = where
        request.link_state.twist = twist or Twist()
        request.link_state.reference_frame = frame
        return self.set_link_state(request)

    def clear(self, keep=("ground_plane",)):
        """Delete every model that a test has put in."""
        for name in self.names():
            if name not in keep:
                self.delete_model(name)


def pose(x=0.0, y=0.0, z=0.0, yaw=0.0):
    """A geometry_msgs/Pose turned about z."""
    return Pose(Point(x, y, z), Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))


def twist(linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0)):
    return Twist(Vector3(*linear), Vector3(*angular))


def numbers(where):
    """Position and orientation as a flat tuple."""
    p, q = where.position, where.orientation
    return (p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def box(size=0.2, mass=1.0, link="body", extra="", attributes=""):
    """A URDF box with the inertia of its size."""
    i = mass * size * size / 6.0
    geometry = f'<geometry><box size="{size} {size} {size}"/></geometry>'
    return (f'<robot name="a_box" {attributes}><link name="{link}">'
            f'<inertial><mass value="{mass}"/>'
            f'<inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial>'
            f"<collision>{geometry}</collision><visual>{geometry}</visual></link>{extra}</robot>")


def static_box_sdf(own_pose="0 0 0 0 0 0"):
    return ('<sdf version="1.6"><model name="block"><static>true</static>'
            f"<pose>{own_pose}</pose>"
            '<link name="body"><collision name="c"><geometry><box><size>1 1 1</size></box>'
            "</geometry></collision></link></model></sdf>")


class Collected:
    """Everything that arrives on a topic, with a lock."""

    def __init__(self, topic, message_class, **options):
        self._lock = threading.Lock()
        self._messages = []
        self._subscriber = rospy.Subscriber(topic, message_class, self._add, tcp_nodelay=True,
                                            **options)

    def _add(self, message):
        with self._lock:
            self._messages.append(message)

    def all(self):
        with self._lock:
            return list(self._messages)

    def clear(self):
        with self._lock:
            self._messages.clear()

    def sources(self):
        """Names of the nodes it listens to."""
        return [connection.callerid_pub for connection in self._subscriber.impl.connections]

    def is_served_by(self, node):
        """Whether a node sends its messages here from now on.

        rospy's publishers answer a subscriber before they add it to those that get messages.
        """
        ports = [connection.socket.getsockname()[1]
                 for connection in list(self._subscriber.impl.connections)
                 if connection.callerid_pub == node]
        told = [row[6] for row in node_answer(node, "getBusInfo") or [] if len(row) > 6]
        return any(f":{port} on socket" in text for port in ports for text in told)

    def close(self):
        self._subscriber.unregister()


class Transforms:
    """What tf knows."""

    def __init__(self):
        import tf2_ros  # few tests need it, and it takes its time

        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)

    def wait(self, target, source, what, at=rospy.Time(0)):
        """Wait for a way from frame `source` to frame `target`; of any time, if `at` is 0."""
        wait_for(lambda: self._buffer.can_transform(target, source, at), what)

    def get(self, target, source, at=rospy.Time(0)):
        """The transform of a time, as soon as it is known; the newest, if `at` is 0."""
        self.wait(target, source, f"a way from {source} to {target}", at)
        return self._buffer.lookup_transform(target, source, at).transform


def node_answer(node, method):
    """What a node answers to a call of its own interface; None if it does not run."""
    # rosnode.rosnode_ping would limit every later connection of this process to 3 s.
    found = master_api.call(rosgraph.get_master_uri(), "lookupNode", "/test", node, seconds=SECONDS)
    try:
        return master_api.call(found, method, "/test", seconds=SECONDS) if found else None
    except OSError:
        return None


def is_running(node):
    """Whether a node of that name runs, however long it takes to say so."""
    return bool(node_answer(node, "getPid"))


def is_alive(pid):
    """Whether a process runs (one that ended and was not waited for does not)."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def heard_on_rosout(text, node="/gazebo"):
    """A function that waits until a log line of `node` holds `text`; call it after the fault.

    A node that runs already is listened to when this returns.
    """
    lines = Collected("/rosout", Log)
    if is_running(node):
        wait_for(lambda: lines.is_served_by(node), "a connection to the node's log")

    def wait():
        found = wait_for(lambda: [line for line in lines.all()
                                  if line.name == node and text in line.msg],
                         f"a log line with {text!r}")
        lines.close()
        return found

    return wait


def executable(package, name):
    """Path of a node's executable, as roslaunch would find it."""
    import roslib.packages

    found = roslib.packages.find_node(package, name)
    assert found, f"{package} has no executable {name}"
    return found[0]


class Program:
    """A program of ours, with its output; always ended."""

    def __init__(self, words, folder=None, start_new_session=False, **environment):
        self.process = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            text=True, cwd=folder, env={**os.environ, **environment},
            start_new_session=start_new_session)
        self._text = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            self._text.append(line)

    @property
    def text(self):
        return "".join(self._text)

    def ended(self, seconds=SECONDS):
        """Its exit status."""
        status = self.process.wait(seconds)
        self._reader.join(SECONDS)
        return status

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


class GazeboCase(unittest.TestCase):
    """Tests of one running server; `gazebo` has its services."""

    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()

    def done(self, answer):
        """Return the answer of a service, which succeeded."""
        self.assertTrue(answer.success, answer.status_message)
        return answer


class Launched:
    """A roslaunch on a master of its own; use it in a `with`."""

    def __init__(self, folder, home, *words):
        port = free_port()
        self.uri = f"http://127.0.0.1:{port}"
        self.program = Program(["roslaunch", "-p", str(port), *words], folder=folder,
                               ROS_MASTER_URI=self.uri, HOME=home,
                               ROS_HOME=os.path.join(home, ".ros"))

    def ask(self, service, kind, **fields):
        # rospy asks the master of the environment at each call.
        with mock.patch.dict(os.environ, ROS_MASTER_URI=self.uri):
            rospy.wait_for_service(f"/gazebo/{service}", SECONDS)
            return rospy.ServiceProxy(f"/gazebo/{service}", kind)(**fields)

    def names(self):
        return list(self.ask("get_world_properties", srv.GetWorldProperties).model_names)

    def says(self, text):
        try:
            wait_for(lambda: text in self.program.text or self.program.process.poll() is not None,
                     f"the words {text!r}")
        finally:
            assert text in self.program.text, self.program.text

    def __enter__(self):
        return self

    def __exit__(self, *_):
        # Killed without this, roslaunch would leave its nodes behind.
        if self.program.process.poll() is None:
            self.program.interrupt()
            self.program.ended()
        self.program.__exit__(None, None, None)


class Prepared(unittest.TestSuite):
    """Tests of one module, before which the world of a shared node is put back."""

    def __init__(self, tests, prepare):
        super().__init__(tests)
        self._prepare = prepare

    def run(self, result, debug=False):
        self._prepare()
        return super().run(result, debug)


def at_one_node(modules, prepare):
    """A `load_tests` (of unittest) for modules that share a node: to start one takes two seconds.

    Args:
        modules: names of modules beside this one; they run in this order.
        prepare: called before each; puts back what the module before it may have left.
    """
    def load_tests(loader, _standard, _pattern):
        return unittest.TestSuite(Prepared([loader.loadTestsFromName(name)], prepare)
                                  for name in modules)

    return load_tests


def run(test_name):
    """Run every test case of the module `test_name` as a rostest.

    The node runs on wall time: the world may stand still.
    """
    rospy.init_node(test_name, disable_rostime=True)
    end_promptly()
    rostest.rosrun(PACKAGE, test_name, test_name)
