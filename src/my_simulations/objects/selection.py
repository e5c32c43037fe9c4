"""Selects objects of a list by the arguments of a command line."""
from __future__ import annotations

import difflib
from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, List, Mapping, Sequence, Tuple

from ..errors import Issue, error
from .object_list import ObjectList, PlacedObject
from .yaml_source import Source

ALL = "all"


@dataclass
class Selection:
    """The selected objects.

    Attributes:
        objects: valid objects, each once, in the requested order.
        names: all requested names that the list contains, including those of faulty objects.
        unknown: arguments and group members that are not in the list.
        issues: faults of the request and of the requested objects.
    """

    objects: List[PlacedObject] = field(default_factory=list)
    names: List[str] = field(default_factory=list)
    unknown: List[str] = field(default_factory=list)
    issues: List[Issue] = field(default_factory=list)


def parse_groups(tree: Any, source: Source) -> Tuple[Dict[str, List[str]], List[Issue]]:
    """Read object groups: `group: [name, ...]`.

    Args:
        tree: the values of the file, or of the parameter `/object_groups`; None for no groups.
        source: origin of the values, for messages.

    Returns:
        The members by group name, and the faults; faulty groups are skipped.
    """
    if tree is None:
        return {}, []
    if not isinstance(tree, Mapping):
        return {}, [error("groups-wrong-type", "object groups must map names to lists of objects",
                          **source.where(()))]
    groups: Dict[str, List[str]] = {}
    issues: List[Issue] = []
    for name, members in tree.items():
        where = source.where((str(name),))
        if not isinstance(name, str) or not name.strip():
            issues.append(error("group-name", "the name of a group must be a string, is "
                                              f"{name!r}", **where))
        elif not isinstance(members, (list, tuple)):
            issues.append(error("group-wrong-type",
                                f"group '{name}' must be a list of object names", **where))
        elif not all(isinstance(member, str) for member in members):
            issues.append(error("group-member", f"group '{name}': every member must be a "
                                                "string", **where))
        else:
            groups[name] = list(members)
    return groups, issues


def closest(name: str, known: Iterable[str], count: int = 3) -> List[str]:
    """The known names most similar to `name`, best first, ignoring letter case."""
    by_lower: Dict[str, List[str]] = {}
    for candidate in known:
        by_lower.setdefault(candidate.lower(), []).append(candidate)
    found = difflib.get_close_matches(name.lower(), list(by_lower), count, 0.5)
    return [candidate for lower in found for candidate in by_lower[lower]][:count]


def unknown_name(name: str, known: Sequence[str], where: str) -> Issue:
    """The error for an unknown name, with the most similar known ones."""
    near = closest(name, known)
    if near:
        hint = "did you mean " + " or ".join(near) + "?"
    elif known:
        listed = ", ".join(known[:10]) + (", ..." if len(known) > 10 else "")
        hint = f"available: {listed}"
    else:
        hint = "none are available"
    return error("unknown-object", f"there is no object '{name}' {where}", hint=hint)


def select(words: Sequence[str], listing: ObjectList,
           groups: Mapping[str, Sequence[str]]) -> Selection:
    """Resolve `all`, group names and object names.

    An argument is, in this order, `all`, a group, or an object. Members of groups may have their
    flattened names in either order of parts, `PARENT_CHILD` or `CHILD_PARENT`.

    Args:
        words: the arguments of the command line.
        listing: the object list.
        groups: members by group name.

    Returns:
        The selection, without faults of other objects.
    """
    result = Selection()
    aliases = {placed.old_name: name for name, placed in listing.objects.items()}
    chosen: Dict[str, None] = {}
    for word in words:
        if word == ALL:
            chosen.update(dict.fromkeys(listing.names))
            result.issues.extend(listing.faults.get("", []))
        elif word in groups:
            for member in groups[word]:
                _choose(member, listing, aliases, f"(member of group '{word}')", chosen, result)
        else:
            _choose(word, listing, aliases, "in the object list", chosen, result, list(groups))
    result.names = list(chosen)
    for name in chosen:
        result.issues.extend(listing.faults.get(name, []))
        if name in listing.objects:
            result.objects.append(listing.objects[name])
    return result


def _choose(name: str, listing: ObjectList, aliases: Mapping[str, str], where: str,
            chosen: Dict[str, None], result: Selection, more: Sequence[str] = ()) -> None:
    known = listing.names
    found = name if name in listing.objects or name in listing.faults else aliases.get(name)
    if not name or found is None:
        result.unknown.append(name)
        result.issues.append(unknown_name(name, [*known, *more], where))
    else:
        chosen[found] = None
