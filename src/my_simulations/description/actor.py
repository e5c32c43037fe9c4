"""Actors: animated figures that follow a scripted path; drawn, not simulated."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List

from ..geometry import IDENTITY, Pose
from .model import PluginSpec


@dataclass
class Animation:
    """A named animation of a skeleton. Source: SDF spec 1.7, actor/animation.

    Attributes:
        name: name that trajectories refer to.
        filename: URI of the file with the animation.
        scale: scale of the skeleton, no unit.
        interpolate_x: whether the animation advances with the distance walked along x.
        extra: XML of child elements that no field holds.
    """

    name: str = ""
    filename: str = ""
    scale: float = 1.0
    interpolate_x: bool = False
    extra: List[str] = field(default_factory=list)


@dataclass
class Waypoint:
    """A point of a trajectory. Source: SDF spec 1.7, actor/script/trajectory/waypoint.

    Attributes:
        time: time since the start of the trajectory, s.
        pose: pose of the actor in the world frame (Gazebo behaviour).
        extra: XML of child elements that no field holds.
    """

    time: float = 0.0
    pose: Pose = IDENTITY
    extra: List[str] = field(default_factory=list)


@dataclass
class Trajectory:
    """A timed path of an actor. Source: SDF spec 1.7, actor/script/trajectory.

    Attributes:
        id: trajectories run in ascending order of their ids.
        type: name of the animation played on the way.
        tension: tension of the spline through the waypoints, 0 to 1.
        waypoints: the points, in ascending order of time.
        extra: XML of child elements that no field holds.
    """

    id: int = 0
    type: str = ""
    tension: float = 0.0
    waypoints: List[Waypoint] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)


@dataclass
class Actor:
    """An animated figure. Source: SDF spec 1.7, actor.

    Attributes:
        name: name of the actor.
        pose: pose of the actor in the world frame.
        skin: URI of the mesh file with the skin, "" for none.
        skin_scale: scale of the skin, no unit.
        animations: the animations that trajectories refer to.
        loop: whether the script starts again when it has ended.
        delay_start: time before the script starts, and starts again, s.
        auto_start: whether the script starts with the simulation.
        trajectories: the path, in ascending order of id.
        plugins: plugins of the actor.
        base_dir: folder from which relative URIs of `skin` and of animations start.
        include: XML of the `<include>` that brings the actor and is written in its place; "" for
            an actor that the world file describes itself.
        extra: XML of child elements that no field holds.
    """

    name: str
    pose: Pose = IDENTITY
    skin: str = ""
    skin_scale: float = 1.0
    animations: List[Animation] = field(default_factory=list)
    loop: bool = True
    delay_start: float = 0.0
    auto_start: bool = True
    trajectories: List[Trajectory] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    base_dir: str = ""
    include: str = ""
    extra: List[str] = field(default_factory=list)
