"""`spawn_object.py`: spawns objects of the list in the running world."""
from __future__ import annotations

import argparse
import contextlib
from typing import List, Optional, Sequence, Set

from ..errors import InputError
from ..objects.object_documents import Document, Documents, package_finder
from ..objects.object_list import PlacedObject
from ..objects.selection import select
from ..program_end import exit_cleanly
from ..ros.arguments import Parser
from ..ros.lifecycle.launch_info import Launch
from . import object_client as client
from .loaded_list import missing_list_message, package_folder, read_list
from .progress import MANY, Progress

NAME = "spawn_object.py"
SPAWNED = "Successfully spawned entity"
"""Gazebo's status message; our server adds the warnings."""


def parser() -> argparse.ArgumentParser:
    """The command line."""
    made = Parser(
        prog=NAME, description="Spawn objects of the list in parameter /objects. Existing objects "
        "are replaced at their listed pose. The world is paused while more than ten are spawned.",
        epilog="Exit code: 0 on success, 1 on failure, 2 for an invalid command line.")
    made.add_argument("names", nargs="+", metavar="NAME",
                      help="an object, a group of /object_groups, or 'all'")
    made.add_argument("--package", default="", metavar="PKG",
                      help="package whose folder 'objects' contains the files of entries with "
                      "model_type (default: the package of the list, then my_simulations)")
    client.add_common_options(made)
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    return client.run_tool(NAME, parser(), argv, _spawn_all)


def _spawn_all(options: argparse.Namespace, remappings: Sequence[str]) -> int:
    parameters = client.Parameters(remappings)
    simulator = client.SimulatorClient(
        parameters, client.full_name(options.gazebo_namespace, remappings), options.timeout)
    if options.package:
        package_folder(options.package)
    loaded = read_list(parameters, options.package, min(options.timeout, client.LIST_SECONDS))
    if loaded.objects is None:
        if not client.has_errors(loaded.issues):
            raise client.ToolError(missing_list_message(parameters))
        client.show(loaded.issues)
        return client.FAILED
    selection = select(options.names, loaded.objects, loaded.groups)
    issues = [*loaded.issues, *selection.issues]
    client.show(issues)
    failed = client.has_errors(issues)
    if not selection.objects:
        if not failed:
            print(f"{NAME}: nothing to spawn")
        return client.FAILED if failed else client.OK
    wrong = _spawn_each(selection.objects, simulator, options.timeout, Launch.of(remappings))
    return client.FAILED if failed or wrong else client.OK


def _spawn_each(objects: List[PlacedObject], simulator: client.SimulatorClient, timeout: float,
                launch: Launch) -> int:
    """Spawn one after the other; returns how many failed."""
    there = set(simulator.model_names())
    progress = Progress(len(objects))
    wrong = 0
    # Paused, objects that stand on others do not fall before those are spawned, and the engine
    # does not spend its time on stepping. Within Documents, whose end waits for a running xacro.
    pause = simulator.paused() if len(objects) > MANY else contextlib.nullcontext()
    with Documents(objects, package_finder(), timeout) as documents, pause:
        for placed in objects:
            progress.start(placed.name)
            try:
                document = documents.of(placed)
                progress.done(_spawn_one(placed, document, simulator, there, launch))
            except InputError as fault:
                wrong += 1
                progress.failed("\n".join(map(str, fault.issues)))
            except client.ToolError as fault:
                wrong += 1
                progress.failed(f"{NAME}: cannot spawn {placed.name}: {fault}")
    progress.end(f"{NAME}: {len(objects) - wrong} of {len(objects)} objects spawned")
    return wrong


def _spawn_one(placed: PlacedObject, document: Document, simulator: client.SimulatorClient,
               there: Set[str], launch: Launch) -> str:
    replaced = placed.name in there
    if simulator.replaces:
        said = simulator.spawn_object(placed.name, document.xml, placed.position, placed.rpy,
                                      replace=replaced, file=document.origin, launch_pid=launch.pid)
    else:
        if replaced:
            simulator.delete(placed.name)
        said = simulator.spawn(placed.name, document.xml, document.sdf, placed.position, placed.rpy)
    there.add(placed.name)
    x, y, z = placed.position
    also = f" (not {document.other})" if document.other else ""
    return (f"{placed.name} {'replaced' if replaced else 'spawned'} at {x:g} {y:g} {z:g} from "
            f"{document.path}{also}{said.partition(SPAWNED)[2]}")
