"""The JavaScript of the page, which the set-up makes of its TypeScript modules.

esbuild makes it (`bundle_page` of tools/lib/page.sh): packed into few files, which a browser takes
in half of the time, and module by module, for tests.
"""
from __future__ import annotations

import hashlib
import json
import os
import re
from typing import Any, Dict, Iterator, List, Optional, Tuple

FOLDER = "my_simulations_page"
"""Beside `three`, in the folder of what npm has fetched."""

PACKED = "bundle/"
"""Below `js` in addresses, and below that folder on the disk."""

_ENTRY, _VIEW = "/js/main.ts", "/js/view/view.ts"
_ADDRESS = "/js/main.js"
_PRELOAD = re.compile(r'[ \t]*<link rel="modulepreload"[^>]*>\n')
_SCRIPT = f'<script type="module" src="{_ADDRESS}">'


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
            if name.endswith(".ts") and os.path.isfile(path) and not os.path.islink(path):
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

    def module(self, inside: str) -> Tuple[str, str]:
        """The folder of a built module, and its path in it; `inside`: its address below `/js`.

        The folder is "" if there is no such module.
        """
        if not self.folder:
            return "", inside
        if inside.startswith(PACKED):
            return os.path.join(self.folder, PACKED), inside[len(PACKED):]
        return os.path.join(self.folder, "js"), inside

    def html(self, text: str) -> Optional[str]:
        """The page's HTML with the packed modules; None if they were made of other sources.

        A page without TypeScript needs none.
        """
        if not os.path.isfile(os.path.join(self._page, _ENTRY.lstrip("/"))):
            return text
        names = self._preloads()
        if names is None:
            return None
        links = "".join(f'  <link rel="modulepreload" href="/js/{name}">\n' for name in names[1:])
        script = _SCRIPT.replace(_ADDRESS, f"/js/{names[0]}")
        return _PRELOAD.sub("", text).replace(f"  {_SCRIPT}", f"{links}  {script}")

    def _preloads(self) -> Optional[List[str]]:
        """The file to begin with, then those that it needs at once; None where nothing fits."""
        try:
            with open(os.path.join(self.folder, "sources"), encoding="ascii") as stream:
                made_of = stream.read().strip()
            if not self.folder or made_of != sources_of(self._page, self._modules):
                return None
            with open(os.path.join(self.folder, "meta.json"), encoding="utf-8") as stream:
                return _list_needed_outputs(json.load(stream)["outputs"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None     # not there, or not what esbuild writes: the page needs none of it


def _list_needed_outputs(outputs: Dict[str, Dict[str, Any]]) -> Optional[List[str]]:
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
