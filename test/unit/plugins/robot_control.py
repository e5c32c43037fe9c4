"""An arm with transmissions, controllers by name, and messages as they come from clients."""
from __future__ import annotations

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.description.transmission import Actuator, Transmission, TransmissionJoint
from my_simulations.geometry import Pose
from my_simulations.messages import Duration
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.control.gazebo_ros_control import GazeboRosControl
from my_simulations.plugins.testing import FakeContext, Message

NS = "robot"


class Span(Duration):
    """A time or duration of a message."""

    def __init__(self, seconds=0.0):
        super().__init__(*divmod(round(seconds * 1e9), 10 ** 9))


def transmission(joint, *interfaces, actuated=True):
    return Transmission(f"{joint}_trans", joints=[TransmissionJoint(joint, list(interfaces))],
                        actuators=[Actuator(f"{joint}_motor")] if actuated else [])


class Arm:
    """A robot of joints `one` and `two`, or others, driven through an interface, and its
    controllers. `places` says where joints are, `kind` is the class of the plugin. An item of
    `interfaces` can be several, in one string. `actuated` says whether transmissions have motors;
    `transmissions` replaces them.
    """

    def __init__(self, interface="hardware_interface/PositionJointInterface", inside="",
                 axis=None, parameters=None, interfaces=None, names=("one", "two"), places=None,
                 kind=GazeboRosControl, actuated=True, transmissions=None, **controllers):
        self.context = FakeContext(f"<plugin>{inside}</plugin>", joints=names)
        axis = axis or JointAxis((0.0, 0.0, 1.0), lower=-3.0, upper=3.0, effort=100.0,
                                 velocity=50.0)
        kinds = [interface] * len(names) if interfaces is None else interfaces
        self.context.description = Model(
            NS, links=[Link("base"), *(Link(name, pose=Pose((places or {}).get(
                name, (0.0, 0.0, 0.0)))) for name in names)],
            joints=[Joint(name, "revolute", "base", name, axis=axis) for name in names],
            transmissions=transmissions or [
                transmission(name, *one.split(), actuated=actuated)
                for name, one in zip(names, kinds)])
        for joint in self.context.description.joints:
            self.context.joints[joint.name].spec = joint
        self.context.ros_parameters = {NS: {**controllers, **(parameters or {})}}
        self.plugin = self.context.load(kind)

    def ask(self, service, **fields):
        response = Message()
        self.context.services[f"{NS}/controller_manager/{service}"](Message(**fields), response)
        return response

    def load(self, name):
        return self.ask("load_controller", name=name).ok

    def switch(self, start=(), stop=(), strictness=2):
        return self.ask("switch_controller", start_controllers=list(start),
                        stop_controllers=list(stop), strictness=strictness).ok

    def run(self, *names):
        """Load and start."""
        for name in names:
            assert self.load(name), self.context.log_messages
        assert self.switch(names), self.context.log_messages

    def states(self):
        return {one.name: one.state for one in self.ask("list_controllers").controller}

    def at(self, name="one"):
        return self.context.joints[name].position

    def published(self, topic):
        return self.context.published[f"{NS}/{topic}"]

    def deliver(self, topic, **fields):
        self.context.deliver(f"{NS}/{topic}", **fields)


def trajectory(names, *points, stamp=0.0):
    """(time, positions[, velocities[, accelerations]])."""
    return Message(header={"stamp": Span(stamp)}, joint_names=list(names), points=[
        Message(time_from_start=Span(time), positions=list(states[0]),
                velocities=list(states[1]) if len(states) > 1 else [],
                accelerations=list(states[2]) if len(states) > 2 else [])
        for time, *states in points])


class Client:
    """Sends goals of FollowJointTrajectory."""

    def __init__(self, arm, controller):
        self._arm, self._at = arm, f"{controller}/follow_joint_trajectory"
        self._count = 0

    def send(self, wanted, path=(), end=(), late=0.0):
        self._count += 1
        self._arm.deliver(f"{self._at}/goal", goal_id=Message(id=f"g{self._count}", stamp=Span()),
                       goal=Message(trajectory=wanted, path_tolerance=list(path),
                                    goal_tolerance=list(end), goal_time_tolerance=Span(late)))
        return f"g{self._count}"

    def cancel(self, goal=""):
        self._arm.deliver(f"{self._at}/cancel", id=goal, stamp=Span())

    @property
    def results(self):
        """(goal, status, error code, reason)."""
        return [(one.status.goal_id.id, one.status.status, one.result.error_code,
                 one.result.error_string) for one in self._arm.published(f"{self._at}/result")]

    @property
    def status(self):
        """Of each goal that is told of."""
        last = self._arm.published(f"{self._at}/status")[-1]
        return {one.goal_id.id: one.status for one in last.status_list}


def tolerance(name, position=0.0, velocity=0.0):
    return Message(name=name, position=position, velocity=velocity, acceleration=0.0)


def hide_package(context, package):
    """Let the messages of a package be absent from what a plugin publishes."""
    publish = context.publish

    def publish_known(name, kind, *more):
        if kind.startswith(package):
            raise PluginError(f"{kind} is not there")
        return publish(name, kind, *more)

    context.publish = publish_known
