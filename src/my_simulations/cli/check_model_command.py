"""`check_model`: checks world, SDF, URDF and xacro files and model folders."""
from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from ..description.actor import Actor
from ..description.flatten import flatten_model
from ..description.light import Light
from ..description.model import Model
from ..description.world import World
from ..errors import InputError, Issue, Severity, error, errors_of, tolerated_as_errors
from ..formats.reading import read_any
from ..formats.xml.parsing import read_content
from ..objects.object_documents import run_xacro
from ..program_end import exit_cleanly
from ..resources.database.download_notes import DownloadNotes
from ..resources.model_config import description_in
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.ros_packages import is_in_workspace
from ..resources.world_lookup import ENDINGS, advice_on, find_world
from ..ros.arguments import Parser

NAME = "check_model"
XACRO_SECONDS = 60.0

Loaded = Union[World, Model, Light, Actor]


def parser() -> argparse.ArgumentParser:
    made = Parser(
        prog=NAME, description="Check worlds, models and robots as the simulator reads them. Needs"
        " no ROS master.",
        epilog="Exit code: 0 without errors (warnings are allowed), 1 with errors, 2 for an"
        " invalid command line.")
    made.add_argument("files", nargs="*", metavar="FILE",
                      help=".world, .sdf, .urdf or .xacro file, the name of a world, or a model"
                      " folder")
    made.add_argument("--strict", action="store_true", help="report as errors what Gazebo accepts"
                      " although the format forbids it")
    made.add_argument("--run-xacro", action="store_true", help="run also xacro files outside of the"
                      " workspace's packages: xacro may run any Python code of the file")
    made.add_argument("--json", action="store_true", help="print one JSON object per file, one per"
                      " line, with counts and issues")
    made.add_argument("--explain", metavar="CODE", help="print meaning and remedy of an issue code"
                      " (listed in doc/issue_codes.md) and exit")
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    made = parser()
    options = made.parse_args((sys.argv if argv is None else list(argv))[1:])
    if options.explain:
        return _explain(options.explain, made)
    if not options.files:
        made.error("the following arguments are required: FILE")
    resolver = Resolver.from_environment(DownloadNotes(lambda note: print(note, file=sys.stderr)))
    failed = False
    for file in options.files:
        loaded, issues = check(file, resolver, options.run_xacro)
        if options.strict:
            issues = tolerated_as_errors(issues)
        failed = failed or bool(errors_of(issues))
        if options.json:
            print(json.dumps({"file": file, **counts(loaded),
                              "issues": [issue.to_json() for issue in issues]}), flush=True)
        else:
            _show(file, loaded, issues)
    return 1 if failed else 0


def _explain(code: str, made: argparse.ArgumentParser) -> int:
    from ..issue_codes import CODES

    entry = CODES.get(code)
    if entry is None:
        made.error(f"unknown issue code {code!r}")
    print(f"{entry.code} ({entry.severity}): {entry.meaning}\n{entry.action}")
    return 0


def check(file: str, resolver: Resolver,
          any_xacro: bool = False) -> Tuple[Optional[Loaded], List[Issue]]:
    """The content of a file, None if it is unusable, and all issues found in it.

    `any_xacro`: whether to run xacro files that lie in no package of the workspace.
    """
    try:
        path, text = _document(_place_of(file, resolver), any_xacro)
        loaded, issues = read_any(text, resolver, path)
    except InputError as fault:
        return None, fault.issues
    return loaded, [*issues, *unknown_plugins(loaded)]


def unknown_plugins(loaded: Loaded) -> List[Issue]:
    """Notes on the plugins of libraries for which there is no class, one for each library."""
    from ..plugins.found_plugins import plugins_of, world_plugins

    specs = [one.spec for model in _models(loaded) for one in plugins_of(flatten_model(model))]
    if isinstance(loaded, World):
        specs += world_plugins(loaded)
    elif isinstance(loaded, Actor):
        specs += loaded.plugins
    if not specs:
        return []
    from ..plugins.missing_plugins import missing_plugin
    from ..plugins.registry import PluginRegistry, library_name
    from ..plugins.without_effect import no_effect_note
    from ..resources.ros_packages import PackageIndex

    registry = PluginRegistry(folders=PackageIndex().folders)
    unknown: Dict[str, Issue] = {}
    for spec in specs:
        library = library_name(spec.filename)
        if library not in unknown and not registry.is_supported(spec.filename):
            reason, hint = missing_plugin(library)
            unknown[library] = no_effect_note(spec) or Issue(
                Severity.NOTE, "not-simulated", f"<plugin {spec.name}> has no effect: {reason}",
                spec.file, spec.line, hint=hint)
    return list(unknown.values())


def _place_of(file: str, resolver: Resolver) -> str:
    """A file that exists, or the world that a launch file would find by this name."""
    if os.path.exists(file) or not file.endswith(ENDINGS):
        return file
    try:
        return find_world(file, resolver)
    except ResourceNotFoundError as missing:
        raise InputError([error("file-unreadable", "cannot be read: there is no such file",
                                file=file, hint=advice_on(missing.uri))]) from None


def _document(file: str, any_xacro: bool) -> Tuple[str, Union[str, bytes]]:
    path = file
    if os.path.isdir(file):
        found = description_in(file)
        if found is None:
            raise InputError([error("model-missing", "the folder contains neither a model.config"
                                    " that names a file nor a model.sdf", file=file)])
        path = found
    if path.endswith(".xacro"):
        if not any_xacro and os.path.isfile(path) and not is_in_workspace(path):
            raise InputError([error(
                "xacro-consent", "xacro was not run: it may run any Python code of the file, which "
                "lies in no package of the workspace", file=path,
                hint="read the file, then use --run-xacro")])
        return path, run_xacro(path, XACRO_SECONDS)
    try:
        return path, read_content(path)
    except OSError as fault:
        raise InputError([error("file-unreadable", f"cannot be read: {fault.strerror or fault}",
                                file=path)]) from None


def _models(loaded: Loaded) -> List[Model]:
    if isinstance(loaded, World):
        return loaded.models
    return [loaded] if isinstance(loaded, Model) else []


def counts(loaded: Optional[Loaded]) -> Dict[str, Any]:
    """Number of entities by kind, for `--json`."""
    models = [] if loaded is None else _models(loaded)
    flat = [flatten_model(model) for model in models]
    links = [link for model in flat for link in model.links]
    kinds: Dict[str, int] = {}
    for link in links:
        for collision in link.collisions:
            kind = type(collision.geometry).__name__.lower()
            kinds[kind] = kinds.get(kind, 0) + 1
    lights = loaded.lights if isinstance(loaded, World) else []
    return {
        "models": sum(1 + _count_nested(model) for model in models),
        "links": len(links),
        "joints": sum(len(model.joints) for model in flat),
        "collisions": dict(sorted(kinds.items())),
        "visuals": sum(len(link.visuals) for link in links),
        "lights": len(lights) + isinstance(loaded, Light),
        "plugins": sum(map(_plugins, models)) + (
            len(loaded.plugins) if isinstance(loaded, World) else 0),
    }


def _count_nested(model: Model) -> int:
    return sum(1 + _count_nested(inner) for inner in model.models)


def _plugins(model: Model) -> int:
    return len(model.plugins) + sum(map(_plugins, model.models))


def _show(file: str, loaded: Optional[Loaded], issues: Sequence[Issue]) -> None:
    for issue in issues:
        print(issue)
    found = counts(loaded)
    warnings = sum(issue.severity is Severity.WARNING for issue in issues)
    faults = [_counted(len(errors_of(issues)), "error"), _counted(warnings, "warning")]
    content = [_counted(found["models"], "model"), _counted(found["links"], "link"),
               _counted(found["joints"], "joint"),
               _counted(sum(found["collisions"].values()), "collision"),
               _counted(found["visuals"], "visual"), _counted(found["lights"], "light"),
               _counted(found["plugins"], "plugin")]
    print(f"{file}: {', '.join(faults)}; {', '.join(content)}", flush=True)


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
