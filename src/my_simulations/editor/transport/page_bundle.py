"""The modules of the page packed into few files, which a browser takes in half of the time.

The set-up makes them with esbuild (`bundle_page` of tools/lib/page.sh). They are used as long as
they were made of the modules that are there now; else the page is served module by module.
"""
from __future__ import annotations

import hashlib
import json
import os
import re
from typing import Any, Dict, Iterator, List, Optional

FOLDER = "my_simulations_page"
"""Beside `three`, in the folder of what npm has fetched."""

PACKED = "bundle/"
"""Below `js` in addresses, and below that folder on the disk."""

_ENTRY, _VIEW = "/js/main.js", "/js/view/view.js"
_PRELOAD = re.compile(r'[ \t]*<link rel="modulepreload"[^>]*>\n')
_SCRIPT = f'<script type="module" src="{_ENTRY}">'


def sources_of(page: str, modules: str) -> str:
    """The hash of all modules in `page` and of three's version, as `page_sources` makes it.

    Raises OSError where one of them cannot be read.
    """
    lines = sorted(_modules(page), key=str.encode)
    text = "".join(f"{_hash(os.path.join(page, name))}  {name}\n" for name in lines)
    three = "three/package.json"
    text += f"{_hash(os.path.join(modules, three))}  {three}\n"
    return hashlib.sha256(text.encode()).hexdigest()


def _modules(page: str) -> Iterator[str]:
    for folder, _, names in os.walk(os.path.join(page, "js")):
        for name in names:
            path = os.path.join(folder, name)
            if name.endswith(".js") and os.path.isfile(path) and not os.path.islink(path):
                yield os.path.relpath(path, page)


def _hash(path: str) -> str:
    with open(path, "rb") as stream:
        return hashlib.sha256(stream.read()).hexdigest()


class PageBundle:
    """The packed modules of one page.

    Args:
        page: the page's folder.
        modules: the folder with `three`; "" for none.
    """

    def __init__(self, page: str, modules: str) -> None:
        self._page, self._modules = page, modules
        self.folder = os.path.join(modules, FOLDER) if modules else ""

    def html(self, text: str) -> str:
        """The page's HTML, with the packed modules where they fit to the page's."""
        names = self._preloads()
        if names is None or _SCRIPT not in text:
            return text
        links = "".join(f'  <link rel="modulepreload" href="/js/{name}">\n' for name in names[1:])
        script = _SCRIPT.replace(_ENTRY, f"/js/{names[0]}")
        return _PRELOAD.sub("", text).replace(f"  {_SCRIPT}", f"{links}  {script}")

    def _preloads(self) -> Optional[List[str]]:
        """The file to begin with, then those that it needs at once; None where nothing fits."""
        try:
            with open(os.path.join(self.folder, "sources"), encoding="ascii") as stream:
                made_of = stream.read().strip()
            if not self.folder or made_of != sources_of(self._page, self._modules):
                return None
            with open(os.path.join(self.folder, "meta.json"), encoding="utf-8") as stream:
                return _needed(json.load(stream)["outputs"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None     # not there, or not what esbuild writes: the page needs none of it


def _needed(outputs: Dict[str, Dict[str, Any]]) -> Optional[List[str]]:
    """The outputs of the entry and of the view, which is asked for at once, and their imports."""
    found: List[str] = []
    for entry in (_ENTRY, _VIEW):
        waiting = [name for name, one in outputs.items()
                   if one.get("entryPoint", "").endswith(entry)]
        if not waiting:
            return None
        while waiting:
            name = waiting.pop(0)
            if name not in found:
                found.append(name)
                waiting += [one["path"] for one in outputs[name]["imports"]
                            if one["kind"] == "import-statement"]
    return found
