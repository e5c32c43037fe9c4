"""Runs the program of a submission in a cell within its box, with limits.

    python3 -I cell.py SPECIFICATION

SPECIFICATION is JSON:
    parent    process id of the process that started this one
    command, environment, cwd
    user      user id that the program gets where the system permits it
    private   folders that the program must not see
    needed    files and folders that it must reach, also below folders of other users
    bytes, memory_bytes, processor_seconds   limits of each process of the program
    processes  limit of processes and threads of its user

Run as a file, it imports the standard library alone, and box.py beside it. Processes outside of
the cell do not exist for the program; it has no capabilities and cannot gain any. When the first
process ends, all others of the cell are killed. Exit status: as of box.py.
"""
from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import json
import os
import resource
import signal
import subprocess
import sys
from typing import Any, Dict, List

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER, _PR_SET_NO_NEW_PRIVS, _PR_CAPBSET_DROP = 1, 36, 38, 24
_LAST_CAPABILITY = 63
_NEWNS, _NEWIPC, _NEWPID = 0x00020000, 0x08000000, 0x20000000
_CAPABILITY_VERSION_3 = 0x20080522
_MOST_OPEN_FILES = 4096


def _box() -> Any:
    """The module box.py, without importing the package."""
    place = os.path.join(os.path.dirname(os.path.abspath(__file__)), "box.py")
    spec = importlib.util.spec_from_file_location("box", place)
    if spec is None or spec.loader is None:
        raise ImportError(place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main(words: List[str]) -> int:
    """Run a specification; returns the exit status."""
    spec: Dict[str, Any] = json.loads(words[1])
    box = _box()
    box.LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != spec["parent"]:
        return 128 + signal.SIGKILL
    isolated = box.LIBC.unshare(_NEWNS | _NEWPID | _NEWIPC) == 0
    if not isolated:
        box.LIBC.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    ready, told = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(told)
        box.LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        os.read(ready, 1)
        os._exit(_inside(spec, isolated, box))
    os.close(ready)
    os.write(told, b".")
    code: int = box.status_of(os.waitpid(child, 0)[1])
    if not isolated:
        box.kill_descendants()
    return code


def _inside(spec: Dict[str, Any], isolated: bool, box: Any) -> int:
    if isolated:
        hide_folders(spec["private"], spec["needed"], box)
    limit_resources(spec)
    limit_open_files()
    with contextlib.suppress(OSError):
        os.setgroups([])
    with contextlib.suppress(OSError):
        os.setgid(spec["user"])
        os.setuid(spec["user"])
    drop_capabilities(box.LIBC)
    # Another user clears it (prctl(2)).
    box.LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    process = subprocess.Popen(spec["command"], env=spec["environment"], cwd=spec["cwd"],
                               stdin=subprocess.DEVNULL, start_new_session=True)
    while True:
        pid, status = os.wait()
        if pid == process.pid:
            code: int = box.status_of(status)
            return code


def hide_folders(folders: List[str], needed: List[str], box: Any) -> None:
    """Hide folders and the processes outside; `needed` stays within reach."""
    box.mount("none", "/", "", box.MS_REC | box.MS_PRIVATE)
    if _changes_user():
        _open_ways(needed, box)
    for folder in folders:
        box.hide(folder)
    with contextlib.suppress(OSError):
        box.tmpfs("/dev/shm", 64 << 20)
    with contextlib.suppress(OSError):
        box.mount("proc", "/proc", "proc", box.MS_NOSUID | box.MS_NODEV)


def _changes_user() -> bool:
    """Whether the program gets another user: root may do so, not the root of a namespace."""
    with open("/proc/self/uid_map", encoding="ascii") as table:
        return os.getuid() == 0 and int(table.read().split()[2]) > 1


def _open_ways(needed: List[str], box: Any) -> None:
    """Let another user reach paths below folders that only their owner enters, such as /root.

    An empty folder takes the place of the closed one, and holds the needed paths only.
    """
    closed: Dict[str, Dict[str, int]] = {}
    for path in sorted({os.path.realpath(path) for path in needed if os.path.exists(path)}):
        gate = _closed_folder(path)
        inside = closed.setdefault(gate, {}) if gate else {}
        if gate and not any(path.startswith(f"{other}/") for other in inside):
            inside[path] = os.open(path, os.O_PATH)
    for gate, paths in closed.items():
        box.tmpfs(gate, 1 << 20)
        show_held(paths, box)


def show_held(held: Dict[str, int], box: Any) -> None:
    """Show files and folders at their paths again, which a mount hides.

    Args:
        held: descriptors by path, opened before the mount; they are closed.
        box: the module of that name.
    """
    for path, descriptor in held.items():
        source = f"/proc/self/fd/{descriptor}"
        if os.path.isdir(source):
            os.makedirs(path, exist_ok=True)
        else:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb"):
                pass
        box.mount(source, path, "", box.MS_BIND | box.MS_REC)
        os.close(descriptor)


def _closed_folder(path: str) -> str:
    """The first folder on the way to a path that other users must not enter; "" for none."""
    parts = path.split("/")
    for count in range(2, len(parts)):
        folder = "/".join(parts[:count])
        if not os.stat(folder).st_mode & 0o001:
            return folder
    return ""


def limit_resources(spec: Dict[str, Any]) -> None:
    """Set the limits of this process and those that it starts; None stands for no limit."""
    for kind, most in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_FSIZE, spec["bytes"]),
                       (resource.RLIMIT_AS, spec["memory_bytes"]),
                       (resource.RLIMIT_CPU, spec["processor_seconds"]),
                       (resource.RLIMIT_NPROC, spec["processes"])):
        if most is not None:
            # The first processor limit sends SIGXCPU, which tells it from other reasons to end.
            resource.setrlimit(kind, (most, most + 1) if kind == resource.RLIMIT_CPU
                               else (most, most))


def limit_open_files() -> None:
    """Limit open files of each process: many processes could exhaust the memory of the kernel."""
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    if hard == resource.RLIM_INFINITY or hard > _MOST_OPEN_FILES:
        resource.setrlimit(resource.RLIMIT_NOFILE, (_MOST_OPEN_FILES, _MOST_OPEN_FILES))


def drop_capabilities(libc: Any) -> None:
    """Give up all capabilities for good: a namespace's root has them, too."""
    for number in range(_LAST_CAPABILITY + 1):
        libc.prctl(_PR_CAPBSET_DROP, number, 0, 0, 0)
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    libc.capset(header, (ctypes.c_uint32 * 6)())
    libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv))
