"""World files: opened, saved, begun anew; and what a file dialog lists."""
from __future__ import annotations

import os
import threading
from typing import Any, Callable, Dict, List, Set, Tuple

from ..errors import Issue
from ..formats.sdf_write import write_world
from ..resources.resolver import Resolver
from ..simulator.history import History
from ..simulator.saving import EXTENSIONS, allowed_path, default_roots, present_world, save_world
from ..simulator.simulator import Simulator
from ..simulator.starting import load_world
from .faults import Refusal

NEW_WORLD = "worlds/empty.world"
_MOST_LISTED = 5000


class WorldFiles:
    """Which file the running world belongs to.

    Attributes:
        file: its path; "" for a world that was never saved.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, history: History,
                 roots: "List[str] | None", tell: Callable[[Issue], None]) -> None:
        self._world = simulator
        self._resolver = resolver
        self._history = history
        self._roots = default_roots() if roots is None else list(roots)
        self._tell = tell
        self._lock = threading.RLock()
        self._ours: Set[str] = set()   # files that were opened or saved here: Save replaces them
        self.file = simulator.world.file

    def save(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`save`: to a path, or to where the world was opened or saved."""
        with self._lock:
            path, overwrite = message.get("path") or "", bool(message.get("overwrite"))
            if not path:
                if self.file not in self._ours:
                    raise Refusal("path-needed", "the world has no file yet; give a file name")
                path, overwrite = self.file, True
            if not os.path.splitext(path)[1]:
                path += EXTENSIONS[0]
            target = allowed_path(path, self._roots)
            if os.path.lexists(target) and not overwrite:
                raise Refusal("exists", f"{target} already exists", "overwrite it, or choose"
                              " another name")
            inline = message.get("format") != "includes"
            self.file = save_world(self._world, target, roots=self._roots, inline=inline,
                                   resolver=self._resolver, overwrite=overwrite)
            self._ours.add(self.file)
            self._history.saved()
            return {"path": self.file}

    def open(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`open`: another world takes the place of the running one."""
        with self._lock:
            self._check_discard(message)
            path = self._readable(message["path"])
            self.load(path)
            self.file = path
            self._ours.add(path)
            return {"file": path}

    def new(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`new`: ground and sun."""
        with self._lock:
            self._check_discard(message)
            self.load(NEW_WORLD)
            self.file = ""
            return {"file": ""}

    def load(self, name: str, dirty: bool = False) -> None:
        """Replace the running world by a file's. Raises InputError, CommandError."""
        world, meshes = load_world(name, self._resolver, self._tell)
        self._world.load_world(world, meshes)
        self._history.clear(dirty)

    def folders(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`folders`: folders and world files below an allowed root."""
        roots = [os.path.realpath(os.path.expanduser(root)) for root in self._roots]
        wanted = message.get("path") or next((root for root in roots if os.path.isdir(root)),
                                             roots[0] if roots else "")
        folder = os.path.realpath(os.path.expanduser(wanted))
        if not any(_is_in(folder, root) for root in roots):
            raise Refusal("not-allowed", f"{folder} is not an allowed folder; allowed: "
                          + ", ".join(roots))
        parent = os.path.dirname(folder)
        folders, files = _listed(folder)
        return {"path": folder, "roots": roots, "folders": folders, "files": files,
                "parent": parent if any(_is_in(parent, root) for root in roots) else None}

    def text(self) -> bytes:
        """The world as SDF, as it is now."""
        world = present_world(self._world)
        return write_world(world, world.state)

    def _check_discard(self, message: Dict[str, Any]) -> None:
        if self._history.dirty and not message.get("discard"):
            raise Refusal("unsaved", "the world has unsaved changes",
                          "save it first, or discard them")

    def _readable(self, name: str) -> str:
        """The real path of a world that may be opened."""
        path = os.path.realpath(os.path.expanduser(name))
        if not os.path.isabs(os.path.expanduser(name)) and self._roots:
            path = os.path.realpath(os.path.join(os.path.expanduser(self._roots[0]), name))
        roots = [*self._roots, *self._resolver.resource_folders()]
        if not any(_is_in(path, os.path.realpath(os.path.expanduser(root))) for root in roots):
            raise Refusal("not-allowed", f"{path} is outside of the allowed folders")
        if not os.path.isfile(path):
            raise Refusal("file-not-found", f"{path} does not exist")
        return path


def _is_in(path: str, root: str) -> bool:
    return path == root or path.startswith(root.rstrip(os.sep) + os.sep)


def _listed(folder: str) -> Tuple[List[Dict[str, Any]], List[Dict[str, Any]]]:
    folders: List[Dict[str, Any]] = []
    files: List[Dict[str, Any]] = []
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name.lower())
    except OSError as fault:
        raise Refusal("folder-unreadable", f"{folder}: {fault.strerror or fault}") from fault
    for entry in entries[:_MOST_LISTED]:
        if entry.name.startswith("."):
            continue
        try:
            if entry.is_dir():
                folders.append({"name": entry.name, "path": entry.path})
            elif os.path.splitext(entry.name)[1].lower() in EXTENSIONS:
                status = entry.stat()
                files.append({"name": entry.name, "path": entry.path, "size": status.st_size,
                              "modified": status.st_mtime})
        except OSError:
            continue  # it went away meanwhile
    return folders, files
