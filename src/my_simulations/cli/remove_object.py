"""`remove_object.py`: deletes objects from the running world."""
from __future__ import annotations

import argparse
import contextlib
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

from ..errors import Issue
from ..objects.object_list import ObjectList
from ..objects.selection import ALL, select, unknown_name
from ..program_end import exit_cleanly
from ..ros.arguments import Parser
from . import object_client as client
from .loaded_list import missing_list_message, read_list
from .progress import MANY, Progress

NAME = "remove_object.py"


def parser() -> argparse.ArgumentParser:
    """The command line."""
    made = Parser(
        prog=NAME, description="Delete objects from the world. A name may be any model of the "
        "world; 'all' and groups mean those objects of the list that exist. The world is paused "
        "while more than ten are deleted.",
        epilog="Exit code: 0 on success, 1 on failure, 2 for an invalid command line.")
    made.add_argument("names", nargs="+", metavar="NAME",
                      help="a model, a group of /object_groups, or 'all'")
    client.add_common_options(made)
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    return client.run_tool(NAME, parser(), argv, _remove_all)


def chosen_models(words: Sequence[str], world: Sequence[str], listing: ObjectList,
                  groups: Mapping[str, Sequence[str]]) -> Tuple[List[str], List[Issue]]:
    """The models to delete, without repeats, and issues for unknown names.

    A model of the world takes precedence over a group of the same name. Objects of `all` or of a
    group that are not in the world are no error.
    """
    names: Dict[str, None] = {}
    issues: List[Issue] = []
    for word in words:
        if word in world and word != ALL:
            names[word] = None
            continue
        selection = select([word], listing, groups)
        names.update(dict.fromkeys(name for name in selection.names if name in world))
        if word == ALL or word in groups:
            # A member may be a model of the world that is in no list.
            names.update(dict.fromkeys(name for name in selection.unknown if name in world))
        elif not any(name in world for name in selection.names):
            issues.append(unknown_name(word, [*world, *groups], "in the world"))
    return list(names), issues


def _remove_all(options: argparse.Namespace, remappings: Sequence[str]) -> int:
    parameters = client.Parameters(remappings)
    simulator = client.SimulatorClient(
        parameters, client.full_name(options.gazebo_namespace, remappings), options.timeout)
    loaded = read_list(parameters, "", 0.0)
    if loaded.objects is None and ALL in options.names:
        if not client.has_errors(loaded.issues):
            raise client.ToolError(missing_list_message(parameters))
        client.show(loaded.issues)
        return client.FAILED
    names, unknown = chosen_models(options.names, simulator.model_names(),
                                   loaded.objects or ObjectList(), loaded.groups)
    issues = [*loaded.issues, *unknown]
    client.show(issues)
    if not names and not unknown:
        print(f"{NAME}: nothing to remove: none of these objects exists")
    with simulator.paused() if len(names) > MANY else contextlib.nullcontext():
        wrong = _remove_each(names, simulator)
    return client.FAILED if wrong or client.has_errors(issues) else client.OK


def _remove_each(names: Sequence[str], simulator: client.SimulatorClient) -> int:
    progress = Progress(len(names))
    wrong = 0
    for name in names:
        progress.start(name)
        try:
            simulator.delete(name)
            progress.done(f"{name} removed")
        except client.ToolError as fault:
            wrong += 1
            progress.failed(f"{NAME}: cannot remove {name}: {fault}")
    progress.end(f"{NAME}: {len(names) - wrong} of {len(names)} objects removed")
    return wrong
