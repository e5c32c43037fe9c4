"""Finds the simulator that a launch file has started, and the world that it has loaded.

Any program can register the name `/gazebo`, so the name alone proves nothing. The process behind
it is found by its sockets, and its command line is read from `/proc`.
"""
from __future__ import annotations

import contextlib
import os
from typing import List, Optional
from urllib.parse import urlparse

import yaml

from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import find_world
from ..ros.lifecycle import master_api, server_options
from . import box
from .box_process import contains
from .program import Program

SIMULATOR = "/gazebo"
PROPERTIES = f"{SIMULATOR}/get_world_properties"
_SERVERS = ("gzserver", "debug")
_LISTENING = "0A"   # state of a socket in /proc/net/tcp
_PRELOADS = ("PYTHON", "LD_")   # variables that could put other code into a program


def simulator_command(program: Program, master: str, scratch: str) -> Optional[List[str]]:
    """The arguments of the simulator's server that is the node /gazebo; None if it is another.

    Args:
        program: what has started the node.
        master: URI of its ROS master.
        scratch: folder of the box; a program in it is not the simulator.
    """
    found = None
    with contextlib.suppress(OSError):
        found = master_api.running_node(master, SIMULATOR)
    inodes = _listening(urlparse(found[0]).port or 0) if found else []
    for pid in box.descendants(program.pid):
        with contextlib.suppress(OSError):
            if any(_link(file.path) in inodes for file in os.scandir(f"/proc/{pid}/fd")):
                words = _words(pid, "cmdline")
                return words[2:] if _is_server(pid, words, scratch) else None
    return None


def different_world(arguments: Optional[List[str]], folder: str, name: str) -> str:
    """Why a server's world is not the file `name` in a submission's `folder`; "" if it is.

    Args:
        arguments: as of `simulator_command`.
        folder: of the submission, from which it was started.
        name: path of the world file in it.
    """
    if arguments is None:
        return f"the node {SIMULATOR} is not the simulator"
    try:
        given = server_options.parse(arguments).world
    except SystemExit:
        return f"the simulator has the arguments {' '.join(arguments)}"
    try:
        path = find_world(given, Resolver.from_environment(), folder)
    except ResourceNotFoundError:
        return f"the simulator runs the world {given}, which is not in the submission"
    if os.path.realpath(path) == os.path.realpath(os.path.join(folder, name)):
        return ""
    shown = os.path.relpath(path, folder) if contains(folder, path) else given
    return f"the simulator runs the world {shown}, not {name} of the submission"


def model_names(answer: bytes) -> Optional[List[str]]:
    """The names in an answer of `rosservice call` to PROPERTIES; None if it is none."""
    try:
        found = yaml.safe_load(answer)
    except (yaml.YAMLError, UnicodeDecodeError):
        return None
    names = found.get("model_names") if isinstance(found, dict) else None
    return [str(name) for name in names] if isinstance(names, list) else None


def _is_server(pid: int, words: List[str], scratch: str) -> bool:
    """Whether a process runs the installed server, with no code of the submission in it."""
    files = [os.path.realpath(path) for path in (f"/proc/{pid}/exe", *words[1:2])]
    variables = [variable for variable in _words(pid, "environ")
                 if variable.startswith(_PRELOADS)]
    return (len(files) == 2 and os.path.basename(files[1]) in _SERVERS
            and not any(contains(os.path.realpath(scratch), path) for path in files)
            and not any(scratch in variable for variable in variables))


def _words(pid: int, name: str) -> List[str]:
    with open(f"/proc/{pid}/{name}", encoding="utf-8", errors="surrogateescape") as stream:
        return stream.read().split("\0")[:-1]


def _link(path: str) -> str:
    with contextlib.suppress(OSError):
        return os.readlink(path)
    return ""


def _listening(port: int) -> List[str]:
    """The sockets that listen to a TCP port, as links in `/proc/PID/fd`."""
    found = []
    for name in ("tcp", "tcp6"):
        with contextlib.suppress(OSError):
            with open(f"/proc/net/{name}", encoding="ascii") as table:
                next(table)
                found += [f"socket:[{words[9]}]" for words in map(str.split, table)
                          if words[3] == _LISTENING
                          and int(words[1].rpartition(":")[2], 16) == port]
    return found
