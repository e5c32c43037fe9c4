"""A robot with two driven wheels and a laser drives to a mark in a room with obstacles."""
from __future__ import annotations

import math
import os
from typing import Any, Dict, List, Optional, Tuple

import gymnasium
import numpy as np

from ..geometry import Pose, rpy_from_quat
from ..python_api import OpenWorld, Randomisation, WorldChoice
from ..resources.package_files import own_directory
from .task_models import box, disc, world_file
from .world_env import Evaluation, View, WorldEnv, clipped_action, clipped_observation

FASTEST = 0.5      # m/s
TURNS = 1.5        # rad/s
NEAR = 0.25        # m: the robot has arrived
RANGE = 10.0       # m, of the laser
SECTORS = 36
OBSTACLES = 4
_HALF = 2.5        # m, from the centre of the room to a wall
_MARGIN = 0.6      # m, from a wall to the centre of what is placed
_APART = 1.4       # m, between the centres of what is placed
_START = 2.0       # m, least distance of the mark from the robot
_SAFE = 0.35       # m: no contact is possible if nothing is nearer to the laser
_LIMITS = (FASTEST * 2, TURNS * 2)


class Navigate:
    """Task: drive until the robot's origin is within 0.25 m of the mark, without a collision.

    The room measures 5 m x 5 m; four boxes stand in it. Robot, mark and boxes are placed at random.

    Action: forward speed and turn rate, each -1 to 1 of the most (0.5 m/s, 1.5 rad/s).
    Observation, 40 numbers: the least distance that the laser measures in each of 36 sectors of 10
    degrees, from -180 degrees to the left (m, 0 to 10); distance (m) and bearing of the mark from
    the robot (rad, 0 is ahead, to the left positive); forward speed (m/s) and turn rate (rad/s).
    Reward: metres by which the robot came nearer to the mark; 1 more on arrival, 1 less for a
    collision, which ends the episode.

    `accurate_friction` selects Coulomb's friction for the wheels; see doc/gymnasium.md.
    """

    period = 0.1
    view = View((-3.4, -3.4, 4.2), (0.0, 0.0, 0.0))

    def __init__(self, accurate_friction: bool = False) -> None:
        robot = os.path.join(own_directory(), "urdf", "robo.urdf")
        walls = [(f"wall_{n}", box(f"wall_{n}", size, "0.75 0.75 0.7 1"), Pose(position))
                 for n, (size, position) in enumerate(_walls())]
        boxes = [(name, box(name, (0.5, 0.5, 0.5), "0.8 0.5 0.2 1"), Pose((0.0, 0.0, -10.0 - n)))
                 for n, name in enumerate(_boxes())]
        self.choice = WorldChoice(world_file(accurate_friction), models=(
            ("robo", robot, Pose()), ("mark", disc("mark", NEAR, "0.1 0.7 0.2 1"), Pose()),
            *walls, *boxes))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)
        high = np.array([*SECTORS * [RANGE], 2 * math.hypot(_HALF, _HALF), math.pi, *_LIMITS],
                        dtype=np.float32)
        low = np.array([*(SECTORS + 1) * [0.0], -math.pi, *(-value for value in _LIMITS)],
                       dtype=np.float32)
        self.observation_space = gymnasium.spaces.Box(low, high, dtype=np.float32)
        self._mark = np.zeros(2)
        self._scan: Any = None
        self._left = self._before = 0.0  # m to the mark, now and a step ago
        self._nearest = RANGE

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Place robot, mark and boxes at random, apart from each other."""
        robot, self._mark, *boxes = _places(random)
        yaw = float(random.uniform(-math.pi, math.pi))
        world.set_pose("robo", [*robot, 0.0, 0.0, 0.0, yaw])
        world.set_pose("mark", [*self._mark, 0.0])
        for name, place in zip(_boxes(), boxes):
            world.set_pose(name, [*place, 0.25, 0.0, 0.0, float(random.uniform(0.0, math.pi))])
        self._scan = world.topics["/scan"]
        self._scan.wait()
        self._before = math.dist(self._mark, robot)

    def act(self, world: OpenWorld, action: Any) -> None:
        forward, turn = clipped_action(action).tolist()
        world.publish("/cmd_vel", {"linear": {"x": forward * FASTEST},
                                   "angular": {"z": turn * TURNS}})

    def observe(self, world: OpenWorld) -> np.ndarray:
        ranges = np.minimum(self._scan.latest.ranges, RANGE).reshape(SECTORS, -1).min(axis=1)
        self._nearest = float(ranges.min())
        states = world.states()
        pose = states.pose["robo"]
        vx, vy, _, _, _, turn = states.twist["robo"]
        yaw = rpy_from_quat(tuple(pose[3:]))[2]
        to_mark = self._mark - pose[:2]
        self._left = float(np.hypot(*to_mark))
        bearing = math.remainder(math.atan2(to_mark[1], to_mark[0]) - yaw, 2.0 * math.pi)
        forward = vx * math.cos(yaw) + vy * math.sin(yaw)
        return clipped_observation(self.observation_space,
                                   [*ranges, self._left, bearing, forward, turn])

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        nearer, self._before = self._before - self._left, self._left
        collided = self._nearest < _SAFE and _collides(world)
        arrived = self._left < NEAR and not collided
        return Evaluation(nearer + arrived - collided, arrived or collided,
                         {"is_success": arrived, "collision": collided})


def _walls() -> List[Tuple[Tuple[float, float, float], Tuple[float, float, float]]]:
    """Size and position of each wall, m."""
    edge, long = _HALF + 0.05, 2 * _HALF + 0.2
    return [((0.1, long, 0.5), (side * edge, 0.0, 0.25)) for side in (-1.0, 1.0)] + [
        ((long, 0.1, 0.5), (0.0, side * edge, 0.25)) for side in (-1.0, 1.0)]


def _boxes() -> List[str]:
    return [f"box_{n}" for n in range(OBSTACLES)]


def _places(random: np.random.Generator) -> List[np.ndarray]:
    """Centres of robot, mark and boxes, shape (2,), m: apart by `_APART` at least."""
    most = _HALF - _MARGIN
    while True:
        points = random.uniform(-most, most, (2 + OBSTACLES, 2))
        gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
        np.fill_diagonal(gaps, np.inf)
        if gaps.min() >= _APART and gaps[0, 1] >= _START:
            return list(points)


def _collides(world: OpenWorld) -> bool:
    """Whether the robot touches a box or a wall."""
    return any(("robo::" in pair[0]) != ("robo::" in pair[1])
               and any(link.startswith(("box_", "wall_")) for link in pair)
               for pair in world.contact_forces())


def make(render_mode: Optional[str] = None, randomisation: Optional[Randomisation] = None,
         accurate_friction: bool = False) -> WorldEnv:
    """The environment `my_simulations/Navigate-v0`."""
    return WorldEnv(Navigate(accurate_friction), render_mode, randomisation=randomisation)
