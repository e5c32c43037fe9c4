"""The scenes of the gymnasium tasks in bare PyBullet, with default settings, and their steps.

Each scene is one client of PyBullet. A step sets the motors, makes the steps of 1 ms, and reads
what the observation of the task has: poses, joints, 360 rays, contacts, or a picture.
"""
from __future__ import annotations

import math
import pathlib
import tempfile
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List, Optional, Sequence, Tuple, Type

import numpy as np
import pybullet

ROOT = pathlib.Path(__file__).resolve().parents[2]
WHEELS = ("left_wheel_joint", "right_wheel_joint")
AXES = ("turn", "lift", "elbow", "roll", "pitch", "hand_turn")
FINGERS = ("left_finger", "right_finger")


class Scene:
    """A client with gravity, a ground plane and one robot.

    Attributes:
        steps: of 1 ms in a step of the task.
        actions: numbers of an action.
    """

    steps, actions = 50, 4

    def __init__(self) -> None:
        self.client = pybullet.connect(pybullet.DIRECT)
        self.at: Dict[str, Any] = {"physicsClientId": self.client}
        pybullet.setGravity(0, 0, -9.8, **self.at)
        pybullet.setPhysicsEngineParameter(fixedTimeStep=0.001, **self.at)
        pybullet.createMultiBody(
            0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, **self.at), **self.at)

    def load(self, file: str, fixed: bool = False) -> int:
        """Load a URDF or SDF file of the repository; note its joints and links by name."""
        path = ROOT / file
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as made:
            if path.suffix == ".sdf":
                made.write(urdf_of(path))
                made.flush()
                path = pathlib.Path(made.name)
            robot: int = pybullet.loadURDF(str(path), useFixedBase=fixed, **self.at)
        infos = [pybullet.getJointInfo(robot, joint, **self.at)
                 for joint in range(pybullet.getNumJoints(robot, **self.at))]
        self.joints = {info[1].decode(): number for number, info in enumerate(infos)}
        self.links = {info[12].decode(): number for number, info in enumerate(infos)}
        return robot

    def box(self, size: Sequence[float], mass: float, place: Sequence[float]) -> int:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=[edge / 2 for edge in size], **self.at)
        body: int = pybullet.createMultiBody(mass, shape, -1, place, **self.at)
        return body

    def drive(self, robot: int, names: Sequence[str], rates: Sequence[float], effort: float,
              ) -> None:
        pybullet.setJointMotorControlArray(
            robot, [self.joints[name] for name in names], pybullet.VELOCITY_CONTROL,
            targetVelocities=list(rates), forces=[effort] * len(names), **self.at)

    def pose(self, body: int) -> Tuple[Any, ...]:
        """Read a pose and a velocity."""
        return (*pybullet.getBasePositionAndOrientation(body, **self.at),
                *pybullet.getBaseVelocity(body, **self.at))

    def make_steps(self) -> None:
        for _ in range(self.steps):
            pybullet.stepSimulation(**self.at)

    def step(self, action: np.ndarray) -> None:
        """Make a step of the task."""
        raise NotImplementedError


class PushBox(Scene):
    """The lab robot and a box."""

    steps, actions = 100, 2
    turns = 2.0

    def __init__(self) -> None:
        super().__init__()
        self.robot = self.load("urdf/robo.urdf")
        self.bodies = [self.robot, *self.others()]

    def others(self) -> List[int]:
        return [self.box([0.2] * 3, 0.5, [0.7, 0.1, 0.1])]

    def step(self, action: np.ndarray) -> None:
        ahead, aside = 0.5 * action[0], 0.12 * self.turns * action[1]
        self.drive(self.robot, WHEELS, ((ahead - aside) / 0.05, (ahead + aside) / 0.05), 2.0)
        self.make_steps()
        for body in self.bodies[:2]:
            self.pose(body)


class Navigate(PushBox):
    """The lab robot and its laser in a room with boxes."""

    turns = 1.5

    def others(self) -> List[int]:
        walls = [self.box(size, 0.0, place) for side in (-2.55, 2.55) for size, place in (
            ((0.1, 5.2, 0.5), (side, 0.0, 0.25)), ((5.2, 0.1, 0.5), (0.0, side, 0.25)))]
        return walls + [self.box([0.5] * 3, 0.0, (x, y, 0.25))
                        for x in (-1.5, 1.5) for y in (-1.5, 1.5)]

    def step(self, action: np.ndarray) -> None:
        super().step(action)
        (x, y, z), turn, *_ = self.pose(self.robot)
        yaw = pybullet.getEulerFromQuaternion(turn)[2]
        x, y = x + 0.08 * math.cos(yaw), y + 0.08 * math.sin(yaw)
        ways = [(math.cos(angle), math.sin(angle))
                for angle in np.linspace(yaw - math.pi, yaw + math.pi, 360, endpoint=False)]
        pybullet.rayTestBatch([(x + 0.12 * a, y + 0.12 * b, z + 0.09) for a, b in ways],
                              [(x + 10.0 * a, y + 10.0 * b, z + 0.09) for a, b in ways], **self.at)


class StackBoxes(Scene):
    """A gripper on three linear axes and two boxes."""

    def __init__(self) -> None:
        super().__init__()
        self.robot = self.load("models/gantry_gripper/model.sdf", fixed=True)
        self.boxes = [self.box([0.05] * 3, 0.1, (x, 0.0, 0.025)) for x in (-0.15, 0.15)]

    def step(self, action: np.ndarray) -> None:
        self.drive(self.robot, "xyz", 0.25 * action[:3], 200.0)
        self.drive(self.robot, FINGERS, [0.2 if action[3] > 0.0 else -0.2] * 2, 10.0)
        self.make_steps()
        pybullet.getJointStates(self.robot, list(self.joints.values()), **self.at)
        for body in self.boxes:
            self.pose(body)


class Reach(Scene):
    """A six-axis arm."""

    actions = 6

    def __init__(self) -> None:
        super().__init__()
        self.robot = self.load("models/six_axis_arm/model.sdf", fixed=True)

    def step(self, action: np.ndarray) -> None:
        self.drive(self.robot, AXES, 1.5 * action, 50.0)
        self.make_steps()
        pybullet.getJointStates(self.robot, list(self.joints.values()), **self.at)
        pybullet.getLinkState(self.robot, self.links["hand"], **self.at)


class ReachCamera(Reach):
    """The same with a picture by PyBullet's renderer without a graphics processor."""

    def step(self, action: np.ndarray) -> None:
        super().step(action)
        place = pybullet.getLinkState(self.robot, self.links["hand"], **self.at)[0]
        view = pybullet.computeViewMatrix(place, [place[0], place[1], place[2] - 0.1], [1, 0, 0])
        pybullet.getCameraImage(64, 64, view, pybullet.computeProjectionMatrixFOV(69, 1, 0.02, 20),
                                renderer=pybullet.ER_TINY_RENDERER, **self.at)


class PickAndPlace(Scene):
    """The arm, whose hand moves along lines, and a cube."""

    def __init__(self) -> None:
        super().__init__()
        self.robot = self.load("models/six_axis_arm/model.sdf", fixed=True)
        self.cube = self.box([0.04] * 3, 0.1, (0.3, 0.2, 0.02))

    def step(self, action: np.ndarray) -> None:
        states = pybullet.getJointStates(self.robot, [
            number for name, number in self.joints.items() if name in (*AXES, *FINGERS)], **self.at)
        zeros = [0.0] * len(states)
        linear, angular = pybullet.calculateJacobian(
            self.robot, self.links["hand"], (0.0, 0.0, -0.08), [state[0] for state in states],
            zeros, zeros, **self.at)
        jacobian = np.vstack((linear, angular))[:, :6]
        wanted = np.concatenate((0.3 * action[:3], np.zeros(3)))
        rates = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 4e-4 * np.eye(6), wanted)
        self.drive(self.robot, AXES, rates / max(1.0, np.abs(rates).max() / 1.5), 50.0)
        self.drive(self.robot, FINGERS, [0.15 if action[3] > 0.0 else -0.15] * 2, 10.0)
        self.make_steps()
        pybullet.getJointStates(self.robot, list(self.joints.values()), **self.at)
        pybullet.getLinkState(self.robot, self.links["hand"], **self.at)
        self.pose(self.cube)
        pybullet.getContactPoints(self.cube, self.robot, **self.at)


SCENES: Dict[str, Type[Scene]] = {
    "PushBox": PushBox, "Navigate": Navigate, "StackBoxes": StackBoxes, "Reach": Reach,
    "Reach with camera": ReachCamera, "PickAndPlace": PickAndPlace}


class Bare:
    """Worlds of one scene as clients of this process, stepped one after another."""

    def __init__(self, scene: Type[Scene], count: int) -> None:
        self._worlds = [scene() for _ in range(count)]

    def step(self, actions: np.ndarray) -> None:
        """One step of the task in every world."""
        for world, action in zip(self._worlds, actions):
            world.step(action)

    def close(self) -> None:
        """End the clients."""
        for world in self._worlds:
            pybullet.disconnect(world.client)


def urdf_of(path: pathlib.Path) -> str:
    """Return the URDF of an SDF model whose links are not turned and lie at their joints.

    PyBullet's reader of SDF accepts no joints to the world.
    """
    model = ElementTree.parse(path).getroot().find("model")
    assert model is not None
    places = {"world": np.zeros(3)}
    robot = ElementTree.Element("robot", name="robot")
    ElementTree.SubElement(robot, "link", name="world")
    for link in model.findall("link"):
        name = link.get("name", "")
        places[name] = _numbers(link.findtext("pose"))[:3]
        made = ElementTree.SubElement(robot, "link", name=name)
        made.append(_inertial(link))
        for collision in link.findall("collision"):
            one = ElementTree.SubElement(made, "collision")
            _origin(one, _numbers(collision.findtext("pose")))
            shape = collision.find("geometry/*")
            assert shape is not None
            ElementTree.SubElement(ElementTree.SubElement(one, "geometry"), shape.tag,
                                   {each.tag: each.text or "" for each in shape})
    for joint in model.findall("joint"):
        parent, child = joint.findtext("parent", ""), joint.findtext("child", "")
        made = ElementTree.SubElement(robot, "joint", name=joint.get("name", ""),
                                      type=joint.get("type", ""))
        _origin(made, np.concatenate((places[child] - places[parent], np.zeros(3))))
        ElementTree.SubElement(made, "parent", link=parent)
        ElementTree.SubElement(made, "child", link=child)
        if joint.find("axis") is not None:
            ElementTree.SubElement(made, "axis", xyz=joint.findtext("axis/xyz", ""))
            ElementTree.SubElement(made, "limit", {
                each.tag: each.text or "" for each in joint.findall("axis/limit/*")})
            ElementTree.SubElement(made, "dynamics",
                                   damping=joint.findtext("axis/dynamics/damping", "0"))
    return ElementTree.tostring(robot, "unicode")


def _inertial(link: ElementTree.Element) -> ElementTree.Element:
    made = ElementTree.Element("inertial")
    _origin(made, _numbers(link.findtext("inertial/pose")))
    ElementTree.SubElement(made, "mass", value=link.findtext("inertial/mass", "1"))
    ElementTree.SubElement(made, "inertia", {
        name: link.findtext(f"inertial/inertia/{name}", "0")
        for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")})
    return made


def _numbers(text: Optional[str]) -> np.ndarray:
    return np.array((text or "0 0 0 0 0 0").split(), dtype=float)


def _origin(element: ElementTree.Element, pose: np.ndarray) -> None:
    ElementTree.SubElement(element, "origin", xyz=" ".join(map(str, pose[:3])),
                           rpy=" ".join(map(str, pose[3:])))
