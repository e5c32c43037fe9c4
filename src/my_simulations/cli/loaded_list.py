"""Loads object lists to the parameter server, and again when their file has changed."""
from __future__ import annotations

import hashlib
import json
import os
import socket
import sys
import time
import xmlrpc.client
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from ..errors import InputError, Issue, error, errors_of, warning
from ..objects.object_documents import package_finder, package_names
from ..objects.object_list import ObjectList, groups_file, list_file, parse_objects
from ..objects.selection import closest, parse_groups
from ..objects.yaml_source import Source, read_yaml
from ..resources.package_files import PACKAGE
from . import object_client as client

LIST_MARK = "/my_simulations/object_list"
"""Parameter that describes the loaded list; written last by the upload.

`world`, `package`, `file` ("" for none), `place` (path of the list, whether it exists or not),
`host` (machine with that path), `state` (times and sizes of the files), `content` (a digest of the
parameters, which shows whether others have changed them) and `faulty` (whether the files have
errors)."""


class Upload(NamedTuple):
    """What an upload has loaded.

    Attributes:
        file: the object list; "" if the world has none.
        objects: number of valid objects.
        groups: number of valid groups.
        issues: all faults and warnings.
    """

    file: str
    objects: int
    groups: int
    issues: List[Issue]


class Loaded(NamedTuple):
    """The list and the groups on the parameter server.

    Attributes:
        objects: the list; None if none is loaded.
        groups: the members by group name.
        issues: faults of the groups, and of a file that has changed.
    """

    objects: Optional[ObjectList]
    groups: Mapping[str, List[str]]
    issues: List[Issue]


def package_folder(package: str) -> str:
    """The folder of a ROS package.

    Raises ToolError: it is unknown; the text names a similar package.
    """
    folder = package_finder()(package)
    if folder is None:
        near = closest(package, package_names(), 1)
        raise client.ToolError(f"ROS package '{package}' was not found"
                               f"{f' (did you mean {near[0]}?)' if near else ''}; source its "
                               "workspace, or correct --package")
    return folder


def upload(parameters: client.Parameters, world: str, package: str,
           needs_list: bool = True) -> Upload:
    """Replace the object list and the groups by those of a world.

    With `needs_list` a world without a list is a warning.

    Raises ToolError: the package is unknown.
    """
    folder = package_folder(package)
    place = list_file(folder, package, world)
    parameters.delete(LIST_MARK)
    state = _state(place)
    found = _upload_files(parameters, place, package)
    if needs_list and not found.file:
        near = closest(world, _list_folder(os.path.join(folder, "config")), 1)
        meant = f" (did you mean {near[0]}?)" if near else ""
        found.issues.append(warning(
            "no-object-list", f"world '{world}' has no object list{meant}", file=place,
            hint="create one to spawn objects by name, or give its package:"
                 " package:=PACKAGE (launch file) or --package PACKAGE"))
    parameters.set(LIST_MARK, {
        "world": world, "file": found.file, "package": package, "place": place,
        "host": socket.gethostname(), "state": state, "faulty": client.has_errors(found.issues),
        "content": _digest(parameters.get(client.OBJECTS), parameters.get(client.GROUPS))})
    return found


def _upload_files(parameters: client.Parameters, file: str, package: str) -> Upload:
    if not os.path.isfile(file):
        parameters.delete(client.OBJECTS)
        parameters.delete(client.GROUPS)
        return Upload("", 0, 0, [])
    objects, issues = _load(parameters, file, client.OBJECTS, package)
    beside = groups_file(file)
    groups, more = (_load(parameters, beside, client.GROUPS, package)
                    if os.path.isfile(beside) else (0, []))
    if not groups:
        parameters.delete(client.GROUPS)
    return Upload(file, objects, groups, issues + more)


def read_list(parameters: client.Parameters, package: str, wait: float) -> Loaded:
    """Read the object list and the groups; the file is loaded again if it has changed.

    Args:
        parameters: the parameter server.
        package: package for the files of 2012-style entries; "" for the package of the list.
        wait: wall seconds to wait for a list that is not loaded yet.

    Raises:
        InputError: the file cannot be read.
        ToolError: its package does not exist any more.
    """
    mark = _await_mark(parameters, wait)
    tree, groups = parameters.get(client.OBJECTS), parameters.get(client.GROUPS)
    ours = (_text(mark, "host") == socket.gethostname()
            and _text(mark, "content") == _digest(tree, groups))
    faults: List[Issue] = []
    if ours and _is_outdated(mark, tree):
        # Faults of entries are found again below.
        faults = [issue for issue in upload(parameters, mark["world"], mark["package"]).issues
                  if issue.code.startswith("list-")]
        if not faults:
            print(f"{mark['place']} has changed and was loaded again", file=sys.stderr, flush=True)
        mark = parameters.get(LIST_MARK)
        tree, groups = parameters.get(client.OBJECTS), parameters.get(client.GROUPS)
    source, file = Source(client.OBJECTS), _text(mark, "file") if ours else ""
    if file and mark.get("faulty") and not faults and os.path.isfile(file):
        # The file has the lines, and entries that the parameter server cannot hold.
        tree, source, _ = read_yaml(file, client.OBJECTS, angles=True)
    listing = None if tree is None else parse_objects(
        tree, source, package or _text(mark, "package") or PACKAGE)
    members, issues = parse_groups(groups, Source(client.GROUPS))
    return Loaded(listing, members, [*faults, *issues])


def missing_list_message(parameters: client.Parameters) -> str:
    """Why no object list is loaded, and what to do."""
    mark = parameters.get(LIST_MARK)
    if isinstance(mark, Mapping) and mark.get("world"):
        return (f"world '{mark['world']}' has no object list in package "
                f"'{mark.get('package') or PACKAGE}'; create "
                f"config/{mark['world']}/object_locations.yaml there and run "
                "roslaunch my_simulations upload_param.launch, with package:=PACKAGE for another "
                "package")
    return (f"parameter {client.OBJECTS} is not set; load an object list with "
            "roslaunch my_simulations upload_param.launch")


def _await_mark(parameters: client.Parameters, wait: float) -> Any:
    """The mark of the list, as soon as there is one or `/objects` is set without it."""
    until = time.monotonic() + wait
    while True:
        mark = parameters.get(LIST_MARK)
        if mark is not None or time.monotonic() >= until \
                or parameters.get(client.OBJECTS) is not None:
            return mark if isinstance(mark, Mapping) else None
        time.sleep(client.POLL_SECONDS)


def _is_outdated(mark: Mapping[str, Any], tree: Any) -> bool:
    """Whether the files have changed since the upload, or could not be read then."""
    place = _text(mark, "place")
    return os.path.isfile(place) and (_state(place) != _text(mark, "state")
                                      or tree is None)


def _state(file: str) -> str:
    """Times and sizes of an object list and its groups; equal as long as neither has changed."""
    found = []
    for path in (file, groups_file(file)):
        try:
            status = os.stat(path)
        except OSError:
            found.append("none")
        else:
            found.append(f"{status.st_mtime_ns} {status.st_size}")
    return "; ".join(found)


def _digest(objects: Any, groups: Any) -> str:
    """A digest of the values of both parameters, None for one that is not set."""
    text = json.dumps([objects, groups], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _text(mark: Any, key: str) -> str:
    found = mark.get(key) if isinstance(mark, Mapping) else None
    return found if isinstance(found, str) else ""


def _list_folder(folder: str) -> List[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


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
    kept, more = storable_entries(tree, source.where)
    if kept:
        parameters.set(param, kept)
    else:
        parameters.delete(param)
    faulty = [issue.xpath + "/" for issue in errors_of(issues)]
    return count, issues + [issue for issue in more if not any(
        path.startswith(issue.xpath + "/") for path in faulty)]


def storable_entries(tree: Mapping[Any, Any], source_where: Any) -> Tuple[Dict[str, Any],
                                                                          List[Issue]]:
    """Return the entries of a list that can be stored on the parameter server.

    Args:
        tree: the entries by name.
        source_where: from a path of keys to the place for an `Issue`.

    Returns:
        The entries that can be sent, faulty ones among them, and an error for each that cannot;
        entries without a value are left out.
    """
    kept: Dict[str, Any] = {}
    issues: List[Issue] = []
    for name, value in tree.items():
        if value is None:  # the reader of the list reports it
            continue
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
