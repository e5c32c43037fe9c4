"""`move_object.py`: sets the pose of a model, or moves it along a polygon or circle."""
from __future__ import annotations

import argparse
import math
import re
import time
from typing import Any, Callable, List, Optional, Sequence, Union

from ..errors import InputError, SimulationError
from ..geometry import Pose, quat_from_rpy
from ..objects.motion_path import Circle, Polygon, parse_numbers, parse_points
from ..objects.selection import unknown_name
from ..program_end import exit_cleanly
from ..ros.arguments import Parser
from . import object_client as client

NAME = "move_object.py"
RATE = 100.0
"""Pose updates per second of ROS time."""

BLOCKED_SECONDS = 60.0
"""Seconds of ROS time after which a blocked object starts again (Care-O-bot tools)."""

NEAR = 0.01
"""Distance (m) within which an initial pose counts as reached (Care-O-bot tools)."""

Path = Union[Polygon, Circle]


class MotionStoppedError(SimulationError):
    """The program is being shut down by ROS."""


def parser() -> argparse.ArgumentParser:
    """The command line."""
    made = Parser(
        prog=NAME, description="Move a model of the running world. Polygons and circles repeat "
        "until Ctrl-C.",
        epilog="Exit code: 0 on success (also after Ctrl-C), 1 on failure, 2 for an invalid "
        "command line.")
    made.add_argument("-m", "--mode", required=True, choices=("initialpose", "polygon", "circle"))
    made.add_argument("-n", "--name", required=True, help="name of the model")
    made.add_argument("-i", "--initialpose", metavar="[X,Y,Z,R,P,Y]",
                      help="pose in mode initialpose (m, rad)")
    made.add_argument("-p", "--polygon", metavar="[[X,Y],...]", help="corners in mode polygon (m)")
    made.add_argument("-c", "--center", metavar="[X,Y]", help="centre in mode circle (m)")
    made.add_argument("-r", "--radius", type=float, help="radius in mode circle (m)")
    made.add_argument("-v", "--velocity", type=float, default=0.5,
                      help="speed in m/s of ROS time (default %(default)g)")
    made.add_argument("-z", "--height", type=float, default=0.0,
                      help="height of the path (m, default %(default)g)")
    made.add_argument("-o", "--stop-objects", default="", metavar="\"NAME ...\"",
                      help="stop while one of these models is near the next point")
    made.add_argument("-d", "--distance", type=float, default=2.0,
                      help="distance for --stop-objects (m, default %(default)g)")
    made.add_argument("--laps", type=int, default=0,
                      help="exit after this many rounds (default: never)")
    client.add_common_options(made)
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    words, remappings = client.split_command_line(argv)
    made = parser()
    options = made.parse_args(words)
    try:
        target = target_of(options)
    except InputError as fault:
        made.error(fault.issues[0].message)
    return client.run(NAME, lambda: _move(options, target, remappings))


def target_of(options: argparse.Namespace) -> Union[Pose, Path]:
    """The pose or path given by the options.

    Raises InputError: an option that the mode needs is missing or invalid.
    """
    from ..errors import error

    if not all(map(math.isfinite, (options.velocity, options.height, options.distance))) \
            or options.velocity <= 0.0 or options.laps < 0:
        raise InputError([error("argument", "velocity must be greater than 0, laps not "
                                "negative, and all values finite")])

    def given(value: Any, option: str) -> Any:
        if value is None:
            raise InputError([error("argument", f"mode {options.mode} needs {option}")])
        return value

    if options.mode == "initialpose":
        x, y, z, *rpy = parse_numbers(given(options.initialpose, "-i"), 6, "-i")
        return Pose((x, y, z), quat_from_rpy(*rpy))
    if options.mode == "polygon":
        return Polygon(parse_points(given(options.polygon, "-p"), "-p"))
    cx, cy = parse_numbers(given(options.center, "-c"), 2, "-c")
    return Circle((cx, cy), given(options.radius, "-r"))


def _move(options: argparse.Namespace, target: Union[Pose, Path], remappings: Sequence[str]) -> int:
    parameters = client.Parameters(remappings)
    simulator = client.SimulatorClient(
        parameters, client.full_name(options.gazebo_namespace, remappings), options.timeout)
    stops = options.stop_objects.split()
    _wait_for_models(simulator, parameters, [options.name, *stops], options.timeout)
    if isinstance(target, Pose):
        _place(simulator, parameters, options, target)
        print(f"{options.name} moved to its pose")
        return client.OK
    try:
        _as_node(options.name, remappings,
                 lambda: _follow(simulator, options, target, stops))
    except (MotionStoppedError, KeyboardInterrupt):
        print(f"{NAME}: stopped")
    return client.OK


def _as_node(model: str, remappings: Sequence[str], work: Callable[[], None]) -> None:
    """Run `work` as a ROS node, to receive sim time.

    Raises MotionStoppedError: the node was shut down from elsewhere.
    """
    import rospy

    from ..ros.prompt_end import end_promptly

    clean = re.sub(r"\W", "_", model)
    # rospy's own handler of Ctrl-C would cut a service call off in the middle.
    rospy.init_node(f"move_{clean}", argv=list(remappings), anonymous=True, disable_signals=True)
    end_promptly()
    try:
        work()
    except client.ToolError:
        if rospy.is_shutdown():
            raise MotionStoppedError from None
        raise
    finally:
        rospy.signal_shutdown("done")


def _wait_for_models(simulator: client.SimulatorClient, parameters: client.Parameters,
                     names: Sequence[str], timeout: float) -> None:
    def all_there() -> bool:
        return set(names) <= set(simulator.model_names())

    try:
        parameters.wait(all_there, timeout, "models", "")
    except client.ToolError:
        world = simulator.model_names()
        missing = [name for name in names if name not in world]
        if not missing:
            return
        hint = unknown_name(missing[0], world, "in the world").hint
        raise client.ToolError(f"model '{missing[0]}' does not exist after waiting "
                               f"{timeout:g} s; {hint}") from None


def _place(simulator: client.SimulatorClient, parameters: client.Parameters,
           options: argparse.Namespace, pose: Pose) -> None:
    def reached() -> bool:
        simulator.set_model_pose(options.name, pose)
        state = simulator.model_state(options.name)
        if state is None:
            raise client.ToolError(f"model '{options.name}' was deleted")
        at = state.pose.position
        return math.dist((at.x, at.y, at.z), pose.position) < NEAR

    parameters.wait(reached, options.timeout, f"'{options.name}' to reach its pose",
                    "is it blocked by another model?")


def _follow(simulator: client.SimulatorClient, options: argparse.Namespace, path: Path,
            stops: List[str]) -> None:
    clock = _Clock(options.timeout)
    distance, last = 0.0, clock.now()
    end = options.laps * path.length or math.inf
    blocked_since: Optional[float] = None
    while distance < end:
        now = clock.tick()
        ahead = min(end, distance + options.velocity * max(0.0, now - last))
        last = now
        if _is_blocked(simulator, path, ahead, stops, options):
            blocked_since = now if blocked_since is None or now < blocked_since else blocked_since
            if now - blocked_since >= BLOCKED_SECONDS:
                distance, blocked_since = path.restart(distance), now
        else:
            distance, blocked_since = ahead, None
        place = path.at(distance)
        simulator.set_model_pose(options.name, Pose((place.x, place.y, options.height),
                                                     quat_from_rpy(0.0, 0.0, place.yaw)))


def _is_blocked(simulator: client.SimulatorClient, path: Path, ahead: float, stops: List[str],
                options: argparse.Namespace) -> bool:
    point = path.at(ahead)
    for name in stops:
        state = simulator.model_state(name)
        # A deleted stop object blocks nothing.
        if state is not None and math.hypot(state.pose.position.x - point.x,
                                            state.pose.position.y - point.y) < options.distance:
            return True
    return False


class _Clock:
    """ROS time, with a wall-clock timeout in case it does not advance."""

    def __init__(self, limit: float) -> None:
        """Wait for the first `/clock` message; ROS time is 0 until then.

        Raises:
            MotionStoppedError: ROS shuts down.
            ToolError: no `/clock` message within `limit` wall seconds.
        """
        self._limit = limit
        self._next = 0.0
        self._wait_until(lambda now: now > 0.0)

    def now(self) -> float:
        """ROS time in seconds."""
        import rospy

        return rospy.get_time()

    def tick(self) -> float:
        """Wait until the next pose update is due; returns ROS time (s).

        Raises:
            MotionStoppedError: ROS shuts down.
            ToolError: ROS time does not advance.
        """
        # A reset world begins again at zero.
        now = self._wait_until(lambda now: now >= self._next or now < self._next - 1.0)
        self._next = now + 1.0 / RATE
        return now

    def _wait_until(self, due: Callable[[float], bool]) -> float:
        """Wait until `due` is true of the ROS time, s; return that time.

        Raises MotionStoppedError if ROS shuts down, ToolError if ROS time stands still.
        """
        import rospy

        seen, since = self.now(), time.monotonic()
        while True:
            now = self.now()
            if due(now):
                return now
            if rospy.is_shutdown():
                raise MotionStoppedError
            if now != seen:
                seen, since = now, time.monotonic()
            elif time.monotonic() - since > self._limit:
                raise client.ToolError(
                    f"ROS time did not advance for {self._limit:g} s; is the world paused? "
                    "rosservice call /gazebo/unpause_physics resumes it")
            time.sleep(0.001)
