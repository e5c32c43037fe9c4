"""`upload_objects.py`: loads the object list of a world to the parameter server."""
from __future__ import annotations

import argparse
import os
import time
from typing import Optional, Sequence

from ..objects.object_documents import package_finder
from ..objects.object_list import list_file, world_name
from ..program_end import exit_cleanly
from ..resources.package_files import PACKAGE
from ..resources.ros_packages import package_of
from ..ros.arguments import Parser
from . import object_client as client
from .loaded_list import upload

NAME = "upload_objects.py"


def parser() -> argparse.ArgumentParser:
    """The command line."""
    made = Parser(
        prog=NAME, description="Load config/WORLD_NAME/object_locations.yaml to /objects and "
        "object_groups.yaml to /object_groups, replacing both parameters.",
        epilog="Exit code: 0 on success (a world without a list is a warning), 1 on failure, 2 "
        "for an invalid command line.")
    made.add_argument("--world", default="", metavar="NAME",
                      help="name or file of the world (default: the running world)")
    made.add_argument("--package", default="", metavar="PKG",
                      help="package whose folder 'config' contains the list (default: the package "
                      "of the world's file, then my_simulations)")
    client.add_common_options(made)
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    return client.run_tool(NAME, parser(), argv, _upload)


def _upload(options: argparse.Namespace, remappings: Sequence[str]) -> int:
    parameters = client.Parameters(remappings)
    node = client.full_name(options.gazebo_namespace, remappings)
    name = world_name(options.world) or _running_world(parameters, options, node)
    file = "" if options.package else _world_file(parameters, options, node, name)
    package = options.package or _package_of_world(file, name)
    needs_list = not file or bool(package_of(file))   # one saved outside of all packages does not
    found = upload(parameters, name, package, needs_list)
    if found.file:
        print(f"{NAME}: world '{name}': {found.objects} objects, {found.groups} groups from "
              f"{os.path.dirname(found.file)}", flush=True)
    elif not needs_list:
        print(f"{NAME}: world '{name}' has no object list", flush=True)
    client.show(found.issues)
    return client.FAILED if client.has_errors(found.issues) else client.OK


def _running_world(parameters: client.Parameters, options: argparse.Namespace, node: str) -> str:
    param = f"{node}/world_base_name"
    return str(parameters.wait(
        lambda: parameters.get(param), options.timeout,
        f"name of the running world (parameter {param})",
        "start the simulator, or give the world with world_name:=NAME"))


def _package_of_world(file: str, name: str) -> str:
    """The package that contains the world's file, unless only this package has a list for it."""
    package = package_of(file)
    find = package_finder()
    folder = find(package) if package else None
    if folder is None:
        return PACKAGE
    own = find(PACKAGE)
    lists = [at is not None and os.path.isfile(list_file(at, of, name))
             for at, of in ((folder, package), (own, PACKAGE))]
    return PACKAGE if lists == [False, True] else package


def _world_file(parameters: client.Parameters, options: argparse.Namespace, node: str,
                name: str) -> str:
    """Path of the world's file; "" if neither the option nor the simulator gives it."""
    if os.path.isabs(options.world):
        return str(options.world)
    param = f"{node}/my_simulations/world_file"
    if options.world and world_name(options.world) != options.world:
        # A launch file that starts the simulator gives the name of a file to look up.
        until = time.monotonic() + min(options.timeout, client.LIST_SECONDS)
        while parameters.get(param) is None and time.monotonic() < until:
            time.sleep(client.POLL_SECONDS)
    running = str(parameters.get(param) or "")
    return running if world_name(running) == name else ""
