"""Selects the description file of a model folder (model.config, or the older manifest.xml)."""
from __future__ import annotations

import os
from typing import List, Optional, Tuple

NEWEST: Tuple[int, ...] = (1, 7)
"""The newest SDF version the reader knows."""


def version_of(text: str) -> Tuple[int, ...]:
    """`1.10` as (1, 10); () if the text is not a version."""
    try:
        return tuple(int(part) for part in text.strip().split("."))
    except ValueError:
        return ()


def description_in(folder: str) -> Optional[str]:
    """The path of the model's description; None if the folder has none.

    The `<sdf>` with the highest version up to `NEWEST` is used; one without a version counts as the
    lowest. If all are newer, the lowest is used. Without a config file it is model.sdf, or the only
    .sdf or .urdf file. Source: Gazebo's model folders.
    """
    for config in ("model.config", "manifest.xml"):
        path = os.path.join(folder, config)
        if os.path.isfile(path):
            for name in _listed_files(path):
                candidate = os.path.join(folder, name)
                if os.path.isfile(candidate):
                    return candidate
    return _only_description(folder)


def _listed_files(config: str) -> List[str]:
    """Names of `<sdf>` entries (then `<urdf>` ones), best first."""
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, recover=True
    )
    try:
        root = etree.parse(config, parser).getroot()
    except (OSError, etree.XMLSyntaxError):
        return []
    if root is None:
        return []
    entries = [
        (version_of(entry.get("version", "")), (entry.text or "").strip())
        for entry in root.iter("sdf")
    ]
    fitting = sorted((e for e in entries if e[0] <= NEWEST), key=lambda e: e[0], reverse=True)
    newer = sorted((e for e in entries if e[0] > NEWEST), key=lambda e: e[0])
    urdfs = [(entry.text or "").strip() for entry in root.iter("urdf")]
    return [name for _, name in fitting + newer if name] + [name for name in urdfs if name]


def _only_description(folder: str) -> Optional[str]:
    usual = os.path.join(folder, "model.sdf")
    if os.path.isfile(usual):
        return usual
    for extension in (".sdf", ".urdf"):
        found = [name for name in os.listdir(folder) if name.lower().endswith(extension)]
        if len(found) == 1 and os.path.isfile(os.path.join(folder, found[0])):
            return os.path.join(folder, found[0])
    return None
