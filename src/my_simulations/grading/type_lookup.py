"""Looks up whether the types of messages and services exist that an assignment names."""
from __future__ import annotations

import difflib
import importlib.util
import pkgutil
import re
from importlib.machinery import ModuleSpec
from typing import List, NamedTuple, Optional

from ..messages.definitions import standard_definitions

MESSAGE, SERVICE = "msg", "srv"
_TYPE = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*\Z")


class TypeFault(NamedTuple):
    """What is wrong with the name of a type.

    Attributes:
        message: the fault.
        hint: a similar name, or what to do.
        is_certain: False if the type may exist on another machine.
    """

    message: str
    hint: str
    is_certain: bool


def type_fault(kind: str, sort: str) -> Optional[TypeFault]:
    """Return the fault of a type's name; None if the type exists.

    Types are those of this library and those whose Python modules can be imported: packages of
    Debian do not always have the files they were generated from.

    Args:
        kind: such as `std_msgs/String`.
        sort: MESSAGE or SERVICE.
    """
    noun = "message" if sort == MESSAGE else "service"
    example = "std_msgs/String" if sort == MESSAGE else "std_srvs/Empty"
    if not _TYPE.match(kind):
        return TypeFault(f"{kind!r} is not a {noun} type", f"write for instance {example}", True)
    package = kind.partition("/")[0]
    standard = _standard_types(sort)
    of_ros = _types_of_ros(package, sort)
    if kind in standard or kind in (of_ros or ()):
        return None
    near = difflib.get_close_matches(kind, [*standard, *(of_ros or ())], 1, 0.7)
    hint = f"did you mean {near[0]}?" if near else ""
    if of_ros is not None:
        return TypeFault(f"the package {package} has no {noun} type {kind}", hint, True)
    source = f"source the workspace that defines {package}"
    return TypeFault(f"the {noun} type {kind} cannot be found", f"{hint} Otherwise {source}"
                     if hint else source, _module("genpy") is not None)


def _standard_types(sort: str) -> List[str]:
    names = standard_definitions()
    if sort == SERVICE:
        return [name[:-len("Request")] for name in names if name.endswith("Request")
                and f"{name[:-len('Request')]}Response" in names]
    return [name for name in names if not name.endswith(("Request", "Response"))]


def _types_of_ros(package: str, sort: str) -> Optional[List[str]]:
    """The types of a package of ROS; None if it cannot be imported."""
    found = _module(f"{package}.{sort}")
    if found is None:
        other = SERVICE if sort == MESSAGE else MESSAGE
        return None if _module(f"{package}.{other}") is None else []
    return [f"{package}/{module.name[1:]}" for module in pkgutil.iter_modules(
        found.submodule_search_locations) if module.name.startswith("_")]


def _module(name: str) -> Optional[ModuleSpec]:
    try:
        return importlib.util.find_spec(name)
    except ImportError:      # of its package
        return None
