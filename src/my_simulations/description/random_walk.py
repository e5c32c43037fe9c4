"""The walk of an actor with Gazebo's ActorPlugin, as a script.

Source: plugins/ActorPlugin.cc of Gazebo 9 to 11: the actor walks from target to target at 0.8 m/s
times `<target_weight>`, and turns on the spot before. Targets are random, within the same bounds.
Where it differs: the actor walks straight through models, at height 0, and along the same way again
after 40 targets; its limbs move with the distance if the animation has `<interpolate_x>`.
"""
from __future__ import annotations

import math
import random
import re
import zlib
from dataclasses import replace
from typing import Iterator, List, Tuple

from ..geometry import Pose, quat_from_rpy, rpy_from_quat
from .actor import Actor, Trajectory, Waypoint
from .plugin import PluginSpec

_LIBRARY = re.compile(r"(^|/)(lib)?ActorPlugin(\.so)?$")
_ANIMATION = "walking"
_SPEED = 0.8                                    # m/s
_FIRST, _WEIGHT = (0.0, -5.0), 1.15             # defaults
_LEAST, _MOST = (-3.0, -10.0), (3.5, 2.0)       # m, of targets
_NEAREST = 2.0                                  # m between targets
_TARGETS = 40
_SPACING = 0.5                                  # m between waypoints, so that the way is straight
_TURN_RATE, _LAG = 1.0, math.radians(10.0)      # 1/s of the angle, until this is left of it, rad
_AHEAD = math.pi / 2.0                          # from the heading to the yaw of the plugin's poses

_Place = Tuple[float, float]


def with_random_walk(actor: Actor) -> Actor:
    """Return the actor with the script of its walk; the same actor if it has no ActorPlugin.

    The walk depends on the name of the actor only.
    """
    plugin = next((one for one in actor.plugins if _LIBRARY.search(one.filename.strip())), None)
    if plugin is None or _ANIMATION not in (one.name for one in actor.animations):
        return actor
    waypoints = _waypoints(actor, plugin)
    return replace(actor, trajectories=[Trajectory(0, _ANIMATION, waypoints=waypoints)],
                   loop=True, auto_start=True, delay_start=0.0)


def _waypoints(actor: Actor, plugin: PluginSpec) -> List[Waypoint]:
    speed = _SPEED * max(0.01, _numbers(plugin, "target_weight", (_WEIGHT,))[0])
    here: _Place = (actor.pose.position[0], actor.pose.position[1])
    yaw = rpy_from_quat(actor.pose.orientation)[2] - _AHEAD
    time, made = 0.0, [_waypoint(0.0, here, yaw)]
    for target in _targets(here, _numbers(plugin, "target", (*_FIRST, 0.0)), actor.name):
        way = math.dist(here, target)
        if way < 1e-6:
            continue
        heading = math.atan2(target[1] - here[1], target[0] - here[0])
        turn = abs(math.remainder(heading - yaw, 2.0 * math.pi))
        time += max(0.01, math.log(turn / _LAG) / _TURN_RATE if turn > _LAG else 0.0)
        yaw = heading
        made.append(_waypoint(time, here, yaw))
        parts = max(1, round(way / _SPACING))
        for n in range(1, parts + 1):
            made.append(_waypoint(time + way / speed * n / parts, (
                here[0] + (target[0] - here[0]) * n / parts,
                here[1] + (target[1] - here[1]) * n / parts), yaw))
        time, here = time + way / speed, target
    return made


def _targets(start: _Place, first: Tuple[float, ...], name: str) -> Iterator[_Place]:
    """The first target, random ones, and the start."""
    chance = random.Random(zlib.crc32(name.encode()))
    last = (first[0], first[1])
    yield last
    for _ in range(_TARGETS):
        target = last
        while math.dist(target, last) < _NEAREST:
            target = (chance.uniform(_LEAST[0], _MOST[0]), chance.uniform(_LEAST[1], _MOST[1]))
        yield target
        last = target
    yield start


def _waypoint(time: float, place: _Place, yaw: float) -> Waypoint:
    return Waypoint(time, Pose((*place, 0.0), quat_from_rpy(0.0, 0.0, yaw)))


def _numbers(plugin: PluginSpec, name: str, default: Tuple[float, ...]) -> Tuple[float, ...]:
    """The numbers in a child of the plugin's element; the default if they cannot be read."""
    found = re.search(rf"<{name}\s*>([^<]*)</{name}\s*>", plugin.xml)
    if found is None:
        return default
    try:
        values = tuple(map(float, found.group(1).split()))
    except ValueError:
        return default
    return values if len(values) == len(default) and all(map(math.isfinite, values)) else default
