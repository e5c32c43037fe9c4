"""Finds the scenarios of a study: roslaunch files with tests, such as `test/*.test`."""
from __future__ import annotations

import glob
import os
from typing import List, Tuple

from lxml import etree

from ..errors import InputError, error
from ..objects.object_documents import package_finder

SCENARIO = "scenario"
"""The column that names the scenario of a case."""

_PACKAGE = "package://"


def scenario_path(name: str, study_file: str) -> str:
    """The absolute path of a scenario.

    Args:
        name: `package://PACKAGE/PATH`, or a path that starts at the folder of the study file.
        study_file: the study file.
    """
    if name.startswith(_PACKAGE):
        package, _, inside = name[len(_PACKAGE):].partition("/")
        folder = package_finder()(package)
        return name if folder is None else os.path.join(folder, inside)
    return os.path.join(os.path.dirname(study_file), os.path.expanduser(name))


def scenarios_named(pattern: str, study_file: str) -> Tuple[str, ...]:
    """The scenarios that a name with or without `*`, `?` or `**` stands for, in order."""
    if not pattern.startswith(_PACKAGE):
        folder = os.path.dirname(study_file)
        found = _files(scenario_path(pattern, study_file))
        return tuple(os.path.relpath(path, folder) for path in found)
    package = pattern[len(_PACKAGE):].partition("/")[0]
    folder = package_finder()(package) or ""
    return tuple(f"{_PACKAGE}{package}/{os.path.relpath(path, folder)}"
                 for path in _files(scenario_path(pattern, study_file)))


def _files(pattern: str) -> List[str]:
    if os.path.isfile(pattern):
        return [pattern]
    return sorted(path for path in glob.glob(pattern, recursive=True) if os.path.isfile(path))


def declared_arguments(path: str) -> List[str]:
    """Names of the launch arguments that a file declares and leaves open.

    Raises InputError: the file cannot be read, or is no roslaunch file; with file and line.
    """
    try:
        root = etree.parse(path, etree.XMLParser(resolve_entities=False)).getroot()
    except OSError:
        raise InputError([error("file-not-found", f"there is no file {path}")]) from None
    except etree.XMLSyntaxError as fault:
        raise InputError([error("xml-malformed", str(fault.msg), file=path,
                                line=fault.lineno or 0)]) from None
    if root.tag != "launch":
        raise InputError([error("study-scenario", f"the first element is <{root.tag}>, not"
                                " <launch>", file=path, line=root.sourceline or 0)])
    return [argument.get("name", "") for argument in root.iterfind("arg")
            if argument.get("value") is None]
