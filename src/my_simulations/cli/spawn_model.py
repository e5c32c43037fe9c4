"""`spawn_model`: spawns a model in a running world."""
from __future__ import annotations

import argparse
import difflib
import math
import os
import sys
import threading
import time
from typing import Any, Dict, List, Optional

from ..errors import InputError, SimulationError
from ..program_end import exit_cleanly
from ..ros.arguments import Parser, is_remapping, parse_number, parse_seconds
from ..ros.call_deadline import CallTimeoutError, call_with_deadline
from ..ros.lifecycle.launch_info import Launch

OK, FAILED, USAGE = 0, 1, 2
WAIT_SECONDS = 120.0
MASTER_SECONDS = 10.0


class SpawnError(SimulationError):
    """The model was not spawned; the text says why and what to do."""


def parser() -> argparse.ArgumentParser:
    """The options, with one dash as Gazebo's."""
    made = Parser(prog="spawn_model", description="Spawn a model in the world.")
    kind = made.add_mutually_exclusive_group(required=True)
    kind.add_argument("-urdf", action="store_true", help="the description is URDF")
    kind.add_argument("-sdf", action="store_true", help="the description is SDF")
    # What the options were called before ROS Lunar.
    kind.add_argument("-gazebo", dest="sdf", action="store_true", help=argparse.SUPPRESS)
    source = made.add_mutually_exclusive_group(required=True)
    source.add_argument("-file", metavar="FILE", help="read the description from a file")
    source.add_argument("-param", metavar="NAME", help="read the description from a ROS parameter")
    source.add_argument("-database", metavar="MODEL", help="name of a model in the model database")
    source.add_argument("-stdin", action="store_true", help="read the description from standard "
                                                            "input")
    made.add_argument("-model", required=True, metavar="NAME",
                      help="name of the model in the world")
    made.add_argument("-reference_frame", default="", metavar="ENTITY",
                      help="model or link that the pose is relative to (default: world frame)")
    made.add_argument("-gazebo_namespace", default="/gazebo", metavar="NS",
                      help="namespace of the server (default %(default)s)")
    made.add_argument("-robot_namespace", default=None, metavar="NS",
                      help="namespace for the model's plugins (default: this node's)")
    made.add_argument("-namespace", dest="robot_namespace", help=argparse.SUPPRESS)
    made.add_argument("-unpause", action="store_true", help="unpause physics after spawning")
    made.add_argument("-wait", metavar="MODEL", help="wait until this model exists before spawning")
    made.add_argument("-timeout", type=parse_seconds, default=WAIT_SECONDS, metavar="SECONDS",
                      help="wall-clock timeout of each call (default %(default)g)")
    for axis, unit in zip(("x", "y", "z", "R", "P", "Y"), ("m",) * 3 + ("rad",) * 3):
        made.add_argument(f"-{axis}", type=parse_number, default=0.0, metavar=unit.upper(),
                          help=f"initial pose ({unit})")
    made.add_argument("-J", dest="joints", nargs=2, action="append", default=[],
                      metavar=("JOINT", "POSITION"),
                      help="initial position of a joint (rad or m); may be repeated")
    made.add_argument("-package_to_model", action="store_true",
                      help="convert package:// URIs of meshes to model://")
    made.add_argument("-b", dest="bond", action="store_true",
                      help="keep running, and delete the model on exit")
    return made


def joint_positions(options: argparse.Namespace) -> Dict[str, float]:
    """Joint positions (rad or m) of the options `-J` by joint; the last one per joint counts.

    Raises ValueError: a position is not a finite number.
    """
    positions: Dict[str, float] = {}
    for joint, text in options.joints:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise ValueError(f"argument -J: position of {joint} must be a number, is {text}")
        positions[joint] = value
    return positions


@exit_cleanly
def main(argv: Optional[List[str]] = None) -> int:
    """Run a command line, program name first.

    Returns 0 if the model was spawned, 1 if not, 2 for an invalid command line.
    """
    words = sys.argv if argv is None else argv
    reader = parser()
    options = reader.parse_args([word for word in words[1:] if not is_remapping(word)])
    try:
        joint_positions(options)
    except ValueError as fault:
        reader.error(str(fault))
    for source in ("file", "param", "database"):
        if getattr(options, source) == "":
            reader.error(f"argument -{source}: is empty")
    try:
        _spawn(options, words)
    except SpawnError as fault:
        print(f"spawn_model: {fault}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("spawn_model: interrupted", file=sys.stderr)
        return FAILED
    return OK


def _spawn(options: argparse.Namespace, words: List[str]) -> None:
    launch = Launch.of(words)
    text = None if options.param is not None else _document(options)
    _reach_master(words)
    import rospy

    from ..ros import service_client
    from ..ros.prompt_end import end_promptly

    rospy.init_node("spawn_model", argv=words, anonymous=True, disable_rostime=True)
    end_promptly()
    try:
        if options.wait:
            _wait_for_model(options)
        if text is None:
            text = _parameter(options.param)
        _call_spawn(options, text, launch)
        if options.joints:
            _set_joints(options)
        if options.unpause:
            from std_srvs.srv import Empty, EmptyRequest

            _call(options, "unpause_physics", Empty, EmptyRequest())
        if options.bond:
            _bond(options)
    except (service_client.ServiceUnavailableError, CallTimeoutError, rospy.ROSException) as fault:
        raise SpawnError(str(fault)) from fault
    except rospy.ServiceException as fault:
        raise SpawnError(f"service call failed: {fault}") from fault


def _reach_master(words: List[str]) -> None:
    from ..ros.lifecycle import master_api

    def say(line: str) -> None:
        print(f"spawn_model: {line}", file=sys.stderr, flush=True)

    uri = master_api.master_uri(words)
    deadline = time.monotonic() + MASTER_SECONDS
    if not master_api.wait_for_master(uri, "/spawn_model", threading.Event(), say, deadline):
        raise SpawnError(f"no ROS master responded at {uri} within {MASTER_SECONDS:g} s")


def _document(options: argparse.Namespace) -> str:
    """The description from a file, the database or standard input."""
    if options.database:
        from xml.sax.saxutils import escape

        return ('<sdf version="1.4"><world name="default"><include>'
                f"<uri>model://{escape(options.database)}</uri></include></world></sdf>")
    from ..objects.object_documents import decoded

    if options.stdin:
        raw, where = sys.stdin.buffer.read(), "standard input"
    else:
        raw, where = _content(options.file), options.file
    if not raw.strip():
        raise SpawnError(f"{where} is empty")
    try:
        return decoded(raw, where)
    except InputError as fault:
        raise SpawnError(str(fault)) from fault


def _content(path: str) -> bytes:
    if not os.path.exists(path):
        raise SpawnError(f"file not found: {path}")
    if not os.path.isfile(path):
        raise SpawnError(f"{path} is not a file")
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as fault:
        raise SpawnError(f"cannot read {path}: {fault}") from fault


def _parameter(name: str) -> str:
    import rospy

    value = rospy.get_param(name, None)
    full = rospy.resolve_name(name)
    if value is None:
        near = difflib.get_close_matches(full, rospy.get_param_names(), 1, 0.8)
        meant = f"did you mean {near[0]}? Otherwise " if near else ""
        raise SpawnError(f'parameter {full} is not set; {meant}load it with <param '
                          f'name="{name}" textfile=.../> or command=...')
    if not isinstance(value, str):
        raise SpawnError(f"parameter {full} must be a string, is {type(value).__name__}")
    if not value.strip():
        raise SpawnError(f"parameter {full} is empty")
    return value


def _wait_for_model(options: argparse.Namespace) -> None:
    import rospy
    from gazebo_msgs.srv import GetWorldProperties

    from ..ros import service_client

    name = service_client.api_name(options.gazebo_namespace, "get_world_properties")
    world = service_client.service_proxy(name, GetWorldProperties, options.timeout)

    def is_there() -> bool:
        try:
            return options.wait in world().model_names
        except rospy.ServiceException:
            return False

    service_client.wait_until(is_there, f"model {options.wait!r}", options.timeout)


def _origin(options: argparse.Namespace) -> str:
    """Name of the description in messages."""
    if options.param:
        return f"parameter {options.param}"
    return "" if options.database or options.stdin else os.path.abspath(options.file)


def _call_spawn(options: argparse.Namespace, text: str, launch: Launch) -> None:
    import rospy
    from gazebo_msgs.srv import SpawnModel, SpawnModelRequest

    from ..geometry import quat_from_rpy
    from ..objects.object_documents import root_tag
    from ..ros import service_client
    from ..ros.own_server import spawns_objects

    name = "spawn_urdf_model" if options.urdf else "spawn_sdf_model"
    service_client.service_proxy(
        service_client.api_name(options.gazebo_namespace, name), SpawnModel, options.timeout
    )
    if options.package_to_model:
        text = _package_to_model(text)
    kind, request = SpawnModel, SpawnModelRequest()
    if (not options.urdf or root_tag(text) in ("robot", "")) and spawns_objects(
            lambda parameter: rospy.get_param(parameter, None), options.gazebo_namespace):
        from my_simulations_msgs.srv import SpawnObject, SpawnObjectRequest

        name, kind = "spawn_object", SpawnObject
        request = SpawnObjectRequest(file=_origin(options), launch_pid=launch.pid)
    namespace = options.robot_namespace
    request.model_name, request.model_xml = options.model, text
    request.robot_namespace = rospy.get_namespace() if namespace is None else namespace
    request.reference_frame = options.reference_frame
    position, orientation = request.initial_pose.position, request.initial_pose.orientation
    position.x, position.y, position.z = options.x, options.y, options.z
    (orientation.x, orientation.y, orientation.z,
     orientation.w) = quat_from_rpy(options.R, options.P, options.Y)
    print(f"spawn_model: {_call(options, name, kind, request)}", flush=True)


def _set_joints(options: argparse.Namespace) -> None:
    from gazebo_msgs.srv import SetModelConfiguration, SetModelConfigurationRequest

    positions = joint_positions(options)
    request = SetModelConfigurationRequest(
        model_name=options.model, urdf_param_name=options.param or "",
        joint_names=list(positions), joint_positions=list(positions.values()))
    said = _call(options, "set_model_configuration", SetModelConfiguration, request)
    print(f"spawn_model: {said}", flush=True)
    _warn_of_unknown_joints(options, list(positions))


def _warn_of_unknown_joints(options: argparse.Namespace, wanted: List[str]) -> None:
    """Name the joints that do not exist on stderr. Gazebo's spawn_model ignores them.

    Launch files name the joints of optional parts, so an unknown joint is not a failure.
    """
    from gazebo_msgs.srv import GetModelProperties, GetModelPropertiesRequest

    answer = _answer(options, "get_model_properties", GetModelProperties,
                     GetModelPropertiesRequest(model_name=options.model))
    known = list(answer.joint_names)
    for joint in wanted:
        plain = joint[len(options.model) + 2:] if joint.startswith(options.model + "::") else joint
        if "::" in plain or plain in known:
            continue  # joints of nested models are not in Gazebo's list
        near = difflib.get_close_matches(plain, known, 1)
        hint = (f"did you mean {near[0]}?" if near else
                f"its joints are {', '.join(known)}" if known else "it has no joints")
        print(f"spawn_model: model {options.model!r} was spawned, but has no joint "
              f"{joint!r}; {hint}", file=sys.stderr, flush=True)


def _call(options: argparse.Namespace, name: str, kind: Any, request: Any) -> str:
    """Call a service; returns its status message. Raises SpawnError if it fails."""
    return str(getattr(_answer(options, name, kind, request), "status_message", ""))


def _answer(options: argparse.Namespace, name: str, kind: Any, request: Any) -> Any:
    """Call a service; returns its response. Raises SpawnError if it fails."""
    from ..ros import service_client

    full = service_client.api_name(options.gazebo_namespace, name)
    proxy = service_client.service_proxy(full, kind, options.timeout)
    answer = call_with_deadline(options.timeout, f"service {full}", lambda: proxy(request))
    if not getattr(answer, "success", True):
        raise SpawnError(answer.status_message)
    return answer


def _package_to_model(text: str) -> str:
    """Convert every `<mesh filename="package://…">` to `model://…`."""
    import xml.etree.ElementTree as ElementTree

    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as fault:
        raise SpawnError(f"the description is not well-formed XML: {fault}") from fault
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "")
        if name.startswith("package:"):
            mesh.set("filename", "model:" + name[len("package:"):])
    return ElementTree.tostring(root, encoding="unicode")


def _bond(options: argparse.Namespace) -> None:
    """Wait for the shutdown, then delete the model."""
    import rospy
    from gazebo_msgs.srv import DeleteModel

    from ..ros import service_client

    name = service_client.api_name(options.gazebo_namespace, "delete_model")
    proxy: Any = rospy.ServiceProxy(name, DeleteModel)

    def delete() -> None:
        try:
            proxy(options.model)
        except rospy.ServiceException as fault:
            print(f"spawn_model: cannot delete {options.model}: {fault}", file=sys.stderr)

    rospy.on_shutdown(delete)
    rospy.spin()
