"""The process of one plugin: python3 -m my_simulations.plugins.isolated SOCKET TRACE.

SOCKET and TRACE are file descriptors that the node hands over: the connection, and the file for
the traces of the interpreter.
"""
from __future__ import annotations

import contextlib
import faulthandler
import os
import resource
import socket
import sys
from typing import List, NoReturn

from ...child_process import die_with_parent
from ...engine.message_pipe import Wire
from ..base import Plugin
from ..registry import plugin_class
from .connection import Connection
from .messages import TRACE_SIGNAL, Call, Start
from .remote_context import RemoteContext

_MEMORY_SHARE = 0.5   # of the machine's memory, for one plugin


def main() -> None:
    """Serve the calls of the node until it hangs up."""
    die_with_parent()
    sock, trace = int(sys.argv[1]), int(sys.argv[2])
    faulthandler.enable(trace, all_threads=False)
    faulthandler.register(TRACE_SIGNAL, trace, all_threads=False)
    _trace_exit(trace)
    _limit_memory()
    sys.dont_write_bytecode = True   # a file that is mended within a second has the same time stamp
    connection = Connection(Wire(socket.socket(fileno=sock)))
    with contextlib.suppress(EOFError, OSError):
        sys.path[:] = connection.receive()
        connection.send("ready")
        _prepare(connection, connection.receive())
        while True:
            message = connection.receive()
            assert isinstance(message, Call)
            connection.run(message)


def _prepare(connection: Connection, start: Start) -> None:
    """Offer the functions that every plugin has."""
    context = RemoteContext(connection, start)
    made: List[Plugin] = []

    def load() -> None:
        try:
            made[0].load()
        finally:
            context.declare_parameters()

    def construct() -> None:
        plugin = plugin_class(start.where)(context)   # type: ignore[arg-type]
        made.append(plugin)
        connection.methods.update(load=load, reset=plugin.reset, close=plugin.close,
                                  clock_set=plugin.clock_set)

    connection.methods["construct"] = construct


def _trace_exit(trace: int) -> None:
    """Have `os._exit` of this process write a trace: the node reports where it was called."""
    exit_process, own = os._exit, os.getpid()

    def exit_with_trace(status: int) -> NoReturn:
        if os.getpid() == own:   # a forked child ends alone
            with contextlib.suppress(OSError):   # the plugin may have closed the file
                faulthandler.dump_traceback(trace, all_threads=False)
        exit_process(status)

    os._exit = exit_with_trace


def _limit_memory() -> None:
    """Have allocations fail before the machine's memory is exhausted."""
    size = int(_MEMORY_SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    if hard == resource.RLIM_INFINITY or size < hard:
        resource.setrlimit(resource.RLIMIT_DATA, (size, hard))
    with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w") as stream:
        stream.write("1000")   # the kernel ends this process before the simulator


if __name__ == "__main__":
    main()
