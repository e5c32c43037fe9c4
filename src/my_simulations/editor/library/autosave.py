"""Unsaved edits, kept on disk, so that a crash of page, node or machine loses none.

An entry is a world file and a small JSON file about it, each written atomically. An entry whose
process has ended is offered at the next start with the same world. Discarded entries stay for a
week.
"""
from __future__ import annotations

import contextlib
import json
import os
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Tuple

from ...errors import CommandError, Issue, warning
from ...simulator.history import History
from ...simulator.safe_file import write_atomically
from ..transport.error_messages import EditRefusedError
from .world_files import WorldFiles

_DAY_S = 86400.0
DISCARDED_LIFE_S = 7.0 * _DAY_S
"""How long discarded changes can be recovered."""

UNRESTORED_LIFE_S = 60.0 * _DAY_S
"""How long changes are kept that were neither discarded nor restored."""


@dataclass(frozen=True)
class AutosaveEntry:
    """`file`: the world it belongs to, "" for a new one; `saved_at` s since 1970; `launched`: the
    models of it that a launch file had spawned; `discarded_at`: 0 unless it was discarded.
    """

    about: str
    world: str
    file: str
    saved_at: float
    process: str
    launched: Tuple[str, ...] = ()
    discarded_at: float = 0.0

    @property
    def name(self) -> str:
        """Tells entries apart."""
        return os.path.basename(self.about)[:-len(".json")]

    @property
    def age_limit(self) -> float:
        """When it is no longer kept, s since 1970."""
        if self.discarded_at:
            return self.discarded_at + DISCARDED_LIFE_S
        return self.saved_at + UNRESTORED_LIFE_S


class Autosave:
    """Keeps the running world's edits.

    Args:
        files: gives the world's text and its file.
        history: says what is dirty.
        folder: where entries lie.
        report: receives a warning if edits cannot be saved.
    """

    def __init__(self, files: WorldFiles, history: History, folder: str,
                 report: Callable[[Issue], None]) -> None:
        self._files = files
        self._history = history
        self._folder = folder
        self._report = report
        self._lock = threading.Lock()
        self._saved_state: Optional[int] = None
        self._failure_reported = False
        self._process = process_id(os.getpid())
        self._name = f"{os.getpid()}-{time.time_ns():x}"
        self._purge()
        self.found: Optional[AutosaveEntry] = self._newest_recoverable()

    def push(self) -> Dict[str, Any]:
        found = self.found
        return {"type": "autosave", "found": found is not None,
                "file": found.file if found else "", "time": found.saved_at if found else 0.0,
                "others": sum(not entry.discarded_at for entry in self._recoverable()
                              if entry != found)}

    def entries(self) -> List[Dict[str, Any]]:
        """What can be recovered, the newest first (`Recoverable` of the protocol)."""
        return [{"name": entry.name, "file": entry.file, "time": entry.saved_at,
                 "discarded": bool(entry.discarded_at)}
                for entry in sorted(self._recoverable(), key=lambda one: -one.saved_at)]

    def save(self) -> None:
        """Write the entry again if edits are missing in it; remove it if there are no edits.

        Blocks; call it now and then, from any thread.
        """
        with self._lock:
            state = self._history.state if self._history.dirty else None
            if state == self._saved_state:
                return
            try:
                if state is None:
                    self._remove(self._path(".json"), self._path(".world"))
                else:
                    self._write()
                self._saved_state = state
                self._failure_reported = False
            except (CommandError, OSError) as fault:
                self._report_failure(str(fault))
            except Exception as defect:  # edits to come must still be kept
                self._report_failure(f"internal error: {type(defect).__name__}: {defect}")

    def _report_failure(self, reason: str) -> None:
        if not self._failure_reported:
            self._report(warning("autosave", f"unsaved changes cannot be kept: {reason}"))
        self._failure_reported = True

    def restore(self, name: str = "") -> str:
        """Load an entry, or what was found; returns the file it belongs to.

        Changes of the world that it replaces can be recovered in turn. Raises CommandError.
        """
        found = self._entry(name)
        self.save_as_discarded()
        self._files.restore(found.world, found.file, list(found.launched))
        self.save()
        self._remove(found.about, found.world)
        if self.found is not None and self.found.name == found.name:
            self.found = None
        return found.file

    def discard(self) -> None:
        """Stop offering the found entry; it can be recovered for a while."""
        if self.found is not None:
            self._mark_discarded(self.found.about)
            self.found = None

    def save_as_discarded(self) -> None:
        """The present changes are about to be discarded: keep them to be recovered."""
        with self._lock:
            if not self._history.dirty:
                return
            self._write()
            self._mark_discarded(self._path(".json"))
            self._name = f"{os.getpid()}-{time.time_ns():x}"
            self._saved_state = None

    def _entry(self, name: str) -> AutosaveEntry:
        if not name:
            if self.found is None:
                raise CommandError("no unsaved changes of an earlier session were found")
            return self.found
        for entry in self._recoverable():
            if entry.name == name:
                return entry
        raise EditRefusedError("not-found", "these changes can no longer be recovered")

    @staticmethod
    def _mark_discarded(about: str) -> None:
        """Raises CommandError."""
        try:
            with open(about, encoding="utf-8") as stream:
                data = json.load(stream)
        except FileNotFoundError:
            return  # another editor has recovered it
        except (OSError, ValueError) as fault:
            raise CommandError(f"{about}: {fault}") from fault
        data["discarded"] = time.time()
        write_atomically(about, json.dumps(data).encode(), overwrite=True, private=True)

    def _write(self) -> None:
        world = self._files.world_sdf()
        write_atomically(self._path(".world"), world, overwrite=True, private=True)
        about = {"file": self._files.file, "time": time.time(), "process": self._process,
                 "world": self._name + ".world", "launched": self._files.launched()}
        write_atomically(self._path(".json"), json.dumps(about).encode(), overwrite=True,
                         private=True)

    def _path(self, extension: str) -> str:
        return os.path.join(self._folder, self._name + extension)

    @staticmethod
    def _remove(*paths: str) -> None:
        for path in paths:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(path)

    def _recoverable(self) -> List[AutosaveEntry]:
        """Entries that were discarded, or whose process is gone."""
        entries = [entry for entry in map(self._read, self._list_files()) if entry is not None]
        return [entry for entry in entries
                if entry.discarded_at or not _is_alive(entry.process)]

    def _newest_recoverable(self) -> Optional[AutosaveEntry]:
        """The newest entry of this world's file that was not discarded."""
        mine = [entry for entry in self._recoverable()
                if entry.file == self._files.file and not entry.discarded_at]
        return max(mine, key=lambda entry: entry.saved_at) if mine else None

    def _purge(self) -> None:
        """Remove what has been kept for long enough."""
        for entry in self._recoverable():
            if entry.age_limit < time.time():
                self._remove(entry.about, entry.world)

    def _list_files(self) -> List[str]:
        try:
            return [name for name in os.listdir(self._folder) if name.endswith(".json")]
        except OSError:
            return []

    def _read(self, name: str) -> Optional[AutosaveEntry]:
        path = os.path.join(self._folder, name)
        try:
            with open(path, encoding="utf-8") as stream:
                about = json.load(stream)
            world = os.path.join(self._folder, os.path.basename(str(about["world"])))
            if not os.path.isfile(world):
                return None
            return AutosaveEntry(path, world, str(about["file"]), float(about["time"]),
                         str(about["process"]), tuple(map(str, about.get("launched", ()))),
                         float(about.get("discarded", 0.0)))
        except (OSError, ValueError, KeyError, TypeError):
            return None


def process_id(pid: int) -> str:
    """What no other process has, now or after a restart of the machine; "" for none."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as stream:
            started = stream.read().rpartition(")")[2].split()[19]
        with open("/proc/sys/kernel/random/boot_id", encoding="ascii") as stream:
            return f"{pid}/{started}/{stream.read().strip()}"
    except (OSError, IndexError):
        return ""


def _is_alive(process: str) -> bool:
    pid = process.partition("/")[0]
    return pid.isdigit() and process_id(int(pid)) == process
