"""Runs a command in a box: namespaces and file systems of its own, as far as the system permits.

    python3 -I box.py < SPECIFICATION

SPECIFICATION is JSON:
    parent    process id of the process that started this one; the box ends with it
    seconds   wall s after which everything in the box is killed
    command   command line
    environment
    scratch   existing empty folder; a file system of its own, which the box can write
    bytes     size of that file system
    copy      [[relative path, full path], ...]: files that are copied to SCRATCH/submission
    hidden    files and folders that the box must not see
    descriptors  file descriptors that the command inherits
    namespaces   whether to try; else the command runs in a session of its own only

Run as a file, it imports the standard library alone. In the box, all of the system is read-only;
SCRATCH, /tmp and /dev/shm are empty and belong to the box; there is no network but a loopback
interface; processes outside do not exist. The variable BOX_ISOLATION of the command's environment
names what works, separated by commas.

Exit status: that of the command; 124 after SECONDS; 128 + N if signal N ended it.
"""
from __future__ import annotations

import contextlib
import ctypes
import errno
import fcntl
import json
import os
import shutil
import signal
import socket
import stat
import struct
import subprocess
import sys
import time
from typing import Any, BinaryIO, Dict, List, Optional

TIMED_OUT = 124
_LOOK_S = 0.05
_MOST_FILES = 50000   # in a file system in memory
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_NEWNS, _NEWIPC, _NEWUSER, _NEWPID, _NEWNET = (
    0x00020000, 0x08000000, 0x10000000, 0x20000000, 0x40000000)
MS_NOSUID, MS_NODEV, MS_REC, MS_PRIVATE, MS_BIND = 2, 4, 16384, 1 << 18, 4096
_MOUNT_SETATTR, _AT_FDCWD, _AT_RECURSIVE, _RDONLY = 442, -100, 0x8000, 1
_SIOCGIFFLAGS, _SIOCSIFFLAGS, _IFF_UP = 0x8913, 0x8914, 1

LIBC = ctypes.CDLL(None, use_errno=True)


def main() -> int:
    """Run the specification of the standard input; returns the exit status."""
    spec: Dict[str, Any] = json.load(sys.stdin)
    LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != spec["parent"]:  # it ended before this was asked for
        return 128 + signal.SIGKILL
    sockets = unix_sockets()
    isolated = bool(spec["namespaces"]) and unshare_all()
    if not isolated:
        LIBC.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    ready, told = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(told)
        LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        os.read(ready, 1)     # the parent is there: the death signal is set in time
        os._exit(_inside(spec, isolated, sockets))
    os.close(ready)
    os.write(told, b".")
    return _wait(child, spec["seconds"], isolated)


def _wait(child: int, seconds: float, isolated: bool) -> int:
    """Wait for the first process of the box; when it ends, all others are killed."""
    until = time.monotonic() + seconds
    code: Optional[int] = None
    while code is None:
        pid, status = os.waitpid(child, os.WNOHANG)
        if pid:
            code = status_of(status)
        elif time.monotonic() > until:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            code = TIMED_OUT
        else:
            time.sleep(_LOOK_S)
    if not isolated:
        kill_descendants()
    return code


def status_of(status: int) -> int:
    """The exit status as of a shell."""
    return 128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)


def unshare_all() -> bool:
    """Enter namespaces of our own; False if the system does not permit it."""
    flags = _NEWNS | _NEWIPC | _NEWPID | _NEWNET
    if os.geteuid() == 0 and LIBC.unshare(flags) == 0:
        _use_small_network()
        return True
    user, group = os.geteuid(), os.getegid()
    if LIBC.unshare(flags | _NEWUSER) != 0:
        return False
    try:
        for name, text in (("setgroups", "deny"), ("uid_map", f"0 {user} 1"),
                           ("gid_map", f"0 {group} 1")):
            with open(f"/proc/self/{name}", "w", encoding="ascii") as stream:
                stream.write(text)
    except OSError:
        return False
    _use_small_network()
    return True


def _use_small_network() -> None:
    """Enter a network with a small table of connections (Linux 6.1).

    lockstep.py reads the table after each step; that of the system takes 15 ms to read.
    """
    with contextlib.suppress(OSError):
        with open("/proc/sys/net/ipv4/tcp_child_ehash_entries", "w", encoding="ascii") as stream:
            stream.write("1024")
        LIBC.unshare(_NEWNET)


# -- inside ----------------------------------------------------------------------------------------

def _inside(spec: Dict[str, Any], isolated: bool, sockets: List[str]) -> int:
    """Prepare the box and run the command as its first process; returns the exit status."""
    scratch = spec["scratch"]
    achieved: List[str] = []
    if isolated:
        achieved = ["processes", "network", *_own_files(spec, sockets)]
    submission = os.path.join(scratch, "submission")
    os.makedirs(submission, exist_ok=True)
    if "files" not in achieved:
        _copy(spec["copy"], submission)
    for name in ("tmp", "home", "judge"):
        os.makedirs(os.path.join(scratch, name), exist_ok=True)
    os.chmod(scratch, 0o711)     # the program may have another user
    os.chmod(os.path.join(scratch, "judge"), 0o700)
    environment = {**spec["environment"], "TMPDIR": os.path.join(scratch, "judge"),
                   "BOX_ISOLATION": ",".join(achieved)}
    # Not in a folder of the submission, whose modules Python would import.
    process = subprocess.Popen(spec["command"], env=environment, cwd="/",
                               pass_fds=spec["descriptors"], stdin=subprocess.DEVNULL)
    while True:
        pid, status = os.wait()  # orphans of the box are ours, too
        if pid == process.pid:
            return status_of(status)


def _own_files(spec: Dict[str, Any], sockets: List[str]) -> List[str]:
    """Make all file systems read-only, then those that the box can write; what has worked."""
    scratch = spec["scratch"]
    try:
        mount("none", "/", "", MS_REC | MS_PRIVATE)
        attributes = struct.pack("<QQQQ", _RDONLY, 0, 0, 0)
        if LIBC.syscall(_MOUNT_SETATTR, _AT_FDCWD, b"/", _AT_RECURSIVE, attributes,
                        len(attributes)) != 0:
            return switch_loopback_on()
        tmpfs(scratch, spec["bytes"])
    except OSError:
        return switch_loopback_on()
    submission, judge = (os.path.join(scratch, name) for name in ("submission", "judge"))
    os.makedirs(submission)
    os.makedirs(judge)
    tmpfs(judge, spec["bytes"])   # its own: a submission that fills the other one cannot harm it
    _copy(spec["copy"], submission)
    hide_sockets(sockets)
    for path in spec["hidden"]:
        hide(path)
    needed = [scratch, *spec["kept"]]
    for folder in ("/tmp", "/dev/shm"):
        if os.path.isdir(folder) and not any(_is_below(path, folder) for path in needed):
            with contextlib.suppress(OSError):
                tmpfs(folder, spec["bytes"])
    with contextlib.suppress(OSError):
        mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV)
    return ["files", *switch_loopback_on()]


def switch_loopback_on() -> List[str]:
    """Switch the loopback interface of a new network on; ["loopback"] if it works."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            request = struct.pack("16sh14x", b"lo", 0)
            flags = struct.unpack("16sh14x", fcntl.ioctl(probe, _SIOCGIFFLAGS, request))[1]
            fcntl.ioctl(probe, _SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", flags | _IFF_UP))
    except OSError:
        return []
    return ["loopback"]


def _copy(files: List[List[str]], folder: str) -> None:
    for relative, full in files:
        target = os.path.join(folder, relative)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open_regular(full) as source, open(target, "wb") as out:
            shutil.copyfileobj(source, out)
            runs = os.fstat(source.fileno()).st_mode & 0o111
        os.chmod(target, 0o755 if runs else 0o644)


def open_regular(path: str) -> BinaryIO:
    """Open a regular file that may have been replaced by a link or a pipe since it was listed.

    Raises OSError: it cannot be opened, or is not a regular file.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "is not a regular file", path)
    return os.fdopen(descriptor, "rb")


def hide(path: str) -> None:
    """Put an empty folder, or an empty file, over a path."""
    with contextlib.suppress(OSError):
        if os.path.isdir(path):
            mount("none", path, "tmpfs", MS_NOSUID | MS_NODEV | 1, "size=4k,mode=000")
        elif os.path.exists(path):
            mount("/dev/null", path, "", MS_BIND)


def unix_sockets() -> List[str]:
    """Paths of the sockets of this system, for `hide_sockets`; read before a new network."""
    with open("/proc/net/unix", encoding="utf-8", errors="surrogateescape") as table:
        columns = [line.rstrip("\n").split(None, 7) for line in table]
    return sorted({one[7] for one in columns if len(one) == 8 and one[7].startswith("/")})


def hide_sockets(paths: List[str]) -> None:
    """Hide sockets of processes outside, such as an SSH agent: no namespace separates them.

    /run is hidden with all that may come to it later.
    """
    hide("/run")
    for path in paths:
        hide(path)


def _is_below(path: str, folder: str) -> bool:
    return os.path.realpath(path).startswith(os.path.realpath(folder).rstrip("/") + "/")


def tmpfs(path: str, size: int) -> None:
    # Without a number, empty files may fill half of the kernel's memory.
    mount("none", path, "tmpfs", MS_NOSUID | MS_NODEV,
          f"size={size},nr_inodes={_MOST_FILES},mode=1777")


def mount(source: str, target: str, kind: str, flags: int, data: str = "") -> None:
    """Mount a file system. Raises OSError."""
    if LIBC.mount(os.fsencode(source), os.fsencode(target), kind.encode(), ctypes.c_ulong(flags),
                  data.encode()) != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), target)


# -- without namespaces ----------------------------------------------------------------------------

def kill_descendants() -> None:
    """Kill all processes below this one, also those that start meanwhile."""
    while True:
        found = descendants(os.getpid())
        if not found:
            return
        for pid in found:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass


def descendants(root: int) -> List[int]:
    """All living processes below one (proc(5), stat)."""
    children: Dict[int, List[int]] = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            with contextlib.suppress(OSError, IndexError):
                with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as stream:
                    rest = stream.read().rpartition(")")[2].split()
                if rest[0] not in "ZX":
                    children.setdefault(int(rest[1]), []).append(int(name))
    found: List[int] = []
    waiting = [root]
    while waiting:
        below = children.get(waiting.pop(), [])
        found += below
        waiting += below
    return found


if __name__ == "__main__":
    sys.exit(main())
