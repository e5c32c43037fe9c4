"""World files: opened, saved, created; and the entries of a file dialog."""
from __future__ import annotations

import os
import threading
from dataclasses import replace
from typing import Any, Callable, Dict, List, Set, Tuple

from ...description.world import World
from ...errors import Issue, Severity
from ...formats.sdf.writer.entities import write_world
from ...resources.resolver import Resolver
from ...resources.world_lookup import folder_of_users, is_shipped
from ...simulator.history import History
from ...simulator.saving import (
    EXTENSIONS,
    check_save_path,
    default_roots,
    present_world,
    refuse_shipped,
    save_world,
)
from ...simulator.simulator import Simulator
from ...simulator.world_loading import load_world
from ...xml_characters import check_file_name
from ..editor_options import EditorOptions
from ..transport.error_messages import EditRefusedError

NEW_WORLD = "worlds/empty.world"
_MOST_LISTED = 5000


class WorldFiles:
    """Which file the running world belongs to.

    Attributes:
        file: its path; "" for a world that was never saved.
        opening: name of the world that is being read and loaded; "" for none.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, history: History,
                 options: EditorOptions, report: Callable[[Issue], None]) -> None:
        self._world = simulator
        self._resolver = resolver
        self._history = history
        self._options = options
        self._chosen: Dict[str, bool] = {"state": False, "launched": False}
        self._report = report
        self._lock = threading.RLock()
        self._ours: Set[str] = set()   # files that were opened or saved here: Save replaces them
        self.file = simulator.world.file
        self.opening = ""

    def roots(self) -> List[str]:
        """Folders below which worlds are opened and saved; relative paths start in the first."""
        if self._options.save_roots is not None:
            return list(self._options.save_roots)
        return default_roots(self.file, self._options.caller)

    def _start(self, roots: List[str]) -> str:
        """The folder in which a file dialog starts.

        The folder of the user's world, else the folder in which the command was typed; the first
        root if neither is an allowed folder that can be written.

        Args:
            roots: the allowed folders, with symbolic links resolved.
        """
        typed = os.path.realpath(self._options.caller or os.getcwd())
        for folder in (folder_of_users(self.file), typed):
            if folder and os.access(folder, os.W_OK) and _is_below(folder, roots):
                return folder
        return roots[0] if roots else ""

    def save(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`save`: to a path, or to where the world was opened or saved.

        Choices made with a path also apply to later saves without one. A `copy` leaves the file
        and the choices of this world as they are: it is the world as it is now, with its state.
        """
        with self._lock:
            if message.get("copy"):
                return self._save_copy(message)
            path, overwrite = message.get("path") or "", bool(message.get("overwrite"))
            if not path:
                if self.file not in self._ours or is_shipped(self.file):
                    raise EditRefusedError(
                        "path-needed", "not everything in the file could be loaded; choose another "
                        "file name" if self._world.models.losses
                        else "the world has no file yet; give a file name")
                path, overwrite = self.file, True
            target = self._target(path, overwrite)
            inline = message.get("format") != "includes"
            for choice in self._chosen:
                if message.get(choice) is not None or message.get("path"):
                    self._chosen[choice] = bool(message.get(choice))
            left_out = [] if self._chosen["launched"] else self._world.models.launched()
            self.file = save_world(self._world, target, roots=self.roots(), inline=inline,
                                   resolver=self._resolver, overwrite=overwrite,
                                   despite_losses=True,  # the user confirmed it
                                   **self._chosen)
            self._ours.add(self.file)
            self._history.mark_saved()
            return {"path": self.file, "left_out": left_out}

    def _save_copy(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """Save the running world with its state to another file; the world keeps its own file."""
        overwrite = bool(message.get("overwrite"))
        target = self._target(message.get("path") or "", overwrite)
        path = save_world(self._world, target, roots=self.roots(), resolver=self._resolver,
                          overwrite=overwrite, despite_losses=True, state=True, launched=True)
        return {"path": path, "left_out": []}

    def _target(self, path: str, overwrite: bool) -> str:
        """The file to write. Raises CommandError, EditRefusedError."""
        if not os.path.splitext(path)[1]:
            path += EXTENSIONS[0]
        target = check_save_path(path, self.roots())
        refuse_shipped(target)
        if os.path.lexists(target) and not overwrite:
            raise EditRefusedError("exists", f"{target} already exists" + self._would_lose(target),
                                   "overwrite it, or choose another name")
        return target

    def _would_lose(self, target: str) -> str:
        losses = self._world.models.losses
        if not losses or os.path.realpath(self._world.world.file) != target:
            return ""
        more = f" (and {len(losses) - 1} more)" if len(losses) > 1 else ""
        return f", and what could not be loaded of it would be lost: {losses[0]}{more}"

    def open(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`open`: another world takes the place of the running one."""
        with self._lock:
            self._check_discard(message)
            path = self._readable(message["path"])
            self.load(path)
            self.file = path
            if not self._world.models.losses:  # else Save asks before it replaces the file by less
                self._ours.add(path)
            return {"file": path}

    def new(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`new`: ground and sun."""
        with self._lock:
            self._check_discard(message)
            self.load(NEW_WORLD)
            self.file = ""
            return {"file": ""}

    def load(self, name: str) -> None:
        """Replace the running world by a file's. Raises InputError, CommandError."""
        self._load(name, lambda world: world)
        self._history.clear()

    def restore(self, kept: str, file: str, launched: List[str]) -> None:
        """Replace the running world by edits of it that were kept.

        Args:
            kept: file that holds them.
            file: the world file that they belong to; "" for none.
            launched: which of the models a launch file had spawned.

        Raises InputError, CommandError.
        """
        with self._lock:
            self._load(kept, lambda world: replace(world, file=file))
            self._world.models.set_launched(launched)
            self._history.clear(dirty=True)
            self.file = file

    def _load(self, name: str, changed: Callable[[World], World]) -> None:
        self.opening = os.path.basename(name)
        try:
            loaded = load_world(name, self._resolver, self._report)
            world = loaded.world
            self._options.log(Issue(Severity.NOTE, "world-file",
                                    f"the world file is {world.file}"))
            self._world.load_world(changed(world), loaded.meshes)
        finally:
            self.opening = ""

    def folders(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`folders`: folders and world files below an allowed root."""
        roots = self._real_roots()
        folder = _allowed_folder(message.get("path") or self._start(roots), roots)
        parent = os.path.dirname(folder)
        folders, files = _list_folder(folder)
        return {"path": folder, "roots": roots, "folders": folders, "files": files,
                "parent": parent if _is_below(parent, roots) else None,
                "launched": self._world.models.launched(), "chosen": dict(self._chosen)}

    def new_folder(self, message: Dict[str, Any]) -> Dict[str, Any]:
        """`new_folder`: creates one folder in an allowed folder."""
        parent = _allowed_folder(message["parent"], self._real_roots())
        name = message["name"].strip()
        if not name or name.startswith(".") or "/" in name or "\0" in name:
            raise EditRefusedError("folder-name", f"invalid folder name {name!r}",
                                   "enter a name without '/' that does not start with '.'")
        check_file_name(name)
        path = os.path.join(parent, name)
        try:
            os.makedirs(parent, exist_ok=True)  # the users' folder need not exist yet
            os.mkdir(path)
        except FileExistsError as fault:
            raise EditRefusedError("exists", f"{path} already exists",
                                   "choose another name") from fault
        except OSError as fault:
            raise EditRefusedError("folder-not-created",
                                   f"{path}: {fault.strerror or fault}") from fault
        return {"path": path}

    def _real_roots(self) -> List[str]:
        return list(dict.fromkeys(os.path.realpath(os.path.expanduser(root))
                                  for root in self.roots()))

    def launched(self) -> List[str]:
        """The models that the launch file spawned."""
        return self._world.models.launched()

    def world_sdf(self) -> bytes:
        """Return the SDF of the running world with its state."""
        world = present_world(self._world)
        return write_world(world, world.state)

    def check_no_world_opens(self) -> None:
        """Raises EditRefusedError while another world is read and loaded."""
        if self.opening:
            raise EditRefusedError("opening", f"the world {self.opening} is being opened",
                                   "wait until it is open")

    def _check_discard(self, message: Dict[str, Any]) -> None:
        if self._history.dirty and not message.get("discard"):
            raise EditRefusedError("unsaved", "the world has unsaved changes",
                          "save it first, or discard them")

    def _readable(self, name: str) -> str:
        """The real path of a world that may be opened."""
        path = os.path.realpath(os.path.expanduser(name))
        places = self.roots()
        if not os.path.isabs(os.path.expanduser(name)) and places:
            path = os.path.realpath(os.path.join(os.path.expanduser(places[0]), name))
        roots = [*places, *self._resolver.resource_folders()]
        if not any(_is_in(path, os.path.realpath(os.path.expanduser(root))) for root in roots):
            raise EditRefusedError("not-allowed", f"{path} is outside of the allowed folders")
        if not os.path.isfile(path):
            raise EditRefusedError("file-not-found", f"{path} does not exist")
        return path


def _is_in(path: str, root: str) -> bool:
    return path == root or path.startswith(root.rstrip(os.sep) + os.sep)


def _is_below(path: str, roots: List[str]) -> bool:
    return any(_is_in(path, root) for root in roots)


def _allowed_folder(path: str, roots: List[str]) -> str:
    """The folder with symbolic links resolved. Raises EditRefusedError outside of the roots."""
    folder = os.path.realpath(os.path.expanduser(path))
    if not _is_below(folder, roots):
        raise EditRefusedError("not-allowed", f"{folder} is not an allowed folder; allowed: "
                               + ", ".join(roots))
    return folder


def _list_folder(folder: str) -> Tuple[List[Dict[str, Any]], List[Dict[str, Any]]]:
    folders: List[Dict[str, Any]] = []
    files: List[Dict[str, Any]] = []
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name.lower())
    except FileNotFoundError:
        return [], []  # the first world that is saved makes it
    except OSError as fault:
        raise EditRefusedError(
            "folder-unreadable", f"{folder}: {fault.strerror or fault}"
        ) from fault
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
