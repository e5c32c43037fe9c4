"""`upload_objects.py`: loads the object list of a world to the parameter server."""
from __future__ import annotations

import argparse
import os
import xmlrpc.client
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..errors import InputError, Issue, error, warning
from ..objects.list_files import groups_file, list_file, world_name
from ..objects.object_documents import package_finder, package_names
from ..objects.object_list import parse_objects
from ..objects.selection import closest, parse_groups
from ..objects.yaml_source import read_yaml
from ..program_end import program
from ..ros.arguments import Parser
from . import object_client as client

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
    made.add_argument("--package", default="my_simulations", metavar="PKG",
                      help="package whose folder 'config' contains the list (default %(default)s)")
    client.common_options(made)
    return made


@program
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run the tool.

    Args:
        argv: the whole command line, program name first; default `sys.argv`.

    Returns:
        0 if the whole list was loaded or there is none, 1 otherwise, 2 for an invalid command
        line.
    """
    words, remappings = client.plain_words(argv)
    options = parser().parse_args(words)
    return client.run(NAME, lambda: _upload(options, remappings))


def transferable(tree: Mapping[Any, Any], source_where: Any) -> Tuple[Dict[str, Any], List[Issue]]:
    """The entries of a list that can be stored on the parameter server.

    Args:
        tree: the entries by name.
        source_where: from a path of keys to the place for an `Issue`.

    Returns:
        The entries that can be sent, faulty ones among them, and an error for each that cannot.
    """
    kept: Dict[str, Any] = {}
    issues: List[Issue] = []
    for name, value in tree.items():
        try:
            # rosparam's limits: texts as keys, no null, integers of 32 bits, no cycles.
            xmlrpc.client.dumps(({name: value},))
        except (TypeError, OverflowError, RecursionError, ValueError) as fault:
            issues.append(error("not-a-parameter",
                                f"cannot set '{name}' on the parameter server: {fault}",
                                **source_where((str(name),))))
        else:
            kept[name] = value
    return kept, issues


def _upload(options: argparse.Namespace, remappings: Sequence[str]) -> int:
    parameters = client.Parameters(remappings)
    name = world_name(options.world) or _running_world(parameters, options, remappings)
    folder = package_finder()(options.package)
    if folder is None:
        raise client.ToolError(f"ROS package '{options.package}' was not found"
                               f"{_meant(options.package, package_names())}; source its "
                               "workspace, or correct --package")
    parameters.delete(client.LIST_MARK)
    file = list_file(folder, options.package, name)
    if os.path.isfile(file):
        count, issues = _load(parameters, file, client.OBJECTS, options.package)
        beside = groups_file(file)
        groups, more = (_load(parameters, beside, client.GROUPS, options.package)
                        if os.path.isfile(beside) else (0, []))
        if not groups:
            parameters.delete(client.GROUPS)
        issues += more
        print(f"{NAME}: world '{name}': {count} objects, {groups} groups from "
              f"{os.path.dirname(file)}", flush=True)
    else:
        parameters.delete(client.OBJECTS)
        parameters.delete(client.GROUPS)
        issues = [warning("no-object-list", f"world '{name}' has no object list"
                          f"{_meant(name, _listed(os.path.join(folder, 'config')))}", file=file,
                          hint="create one to spawn objects by name, or give its package:"
                               " package:=PACKAGE (launch file) or --package PACKAGE")]
        file = ""
    parameters.set(client.LIST_MARK, {"world": name, "file": file,
                                      "package": options.package})
    client.show(issues)
    return client.FAILED if client.has_errors(issues) else client.OK


def _meant(name: str, known: Sequence[str]) -> str:
    near = closest(name, known, 1)
    return f" (did you mean {near[0]}?)" if near else ""


def _listed(folder: str) -> List[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


def _running_world(parameters: client.Parameters, options: argparse.Namespace,
                   remappings: Sequence[str]) -> str:
    node = client.full_name(options.gazebo_namespace, remappings)
    param = f"{node}/world_base_name"
    return str(parameters.wait(
        lambda: parameters.get(param), options.timeout,
        f"name of the running world (parameter {param})",
        "start the simulator, or give the world with world_name:=NAME"))


def _load(parameters: client.Parameters, file: str, param: str, package: str
          ) -> Tuple[int, List[Issue]]:
    """Load a file to a parameter tree; returns the number of valid entries, and all issues.

    Invalid entries are loaded too if possible, so that spawning one reports its errors.
    """
    try:
        tree, source, issues = read_yaml(file, param, angles=True)
    except InputError as fault:
        parameters.delete(param)
        return 0, fault.issues
    if param == client.OBJECTS:
        listing = parse_objects(tree, source, package)
        issues, count = issues + listing.issues(), len(listing.objects)
    else:
        groups, faults = parse_groups(tree, source)
        issues, count = issues + faults, len(groups)
    if not isinstance(tree, Mapping) or not tree:
        parameters.delete(param)
        return 0, issues
    kept, more = transferable(tree, source.where)
    if kept:
        parameters.set(param, kept)
    else:
        parameters.delete(param)
    return count, issues + more
