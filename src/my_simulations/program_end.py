"""How command-line programs end whose output cannot be written, or that are interrupted."""
from __future__ import annotations

import argparse
import errno
import functools
import os
import sys
from typing import Any, Callable, TypeVar, cast

Main = TypeVar("Main", bound=Callable[..., int])

INTERRUPTED, READER_GONE = 130, 141
"""128 and the number of the signal, as of programs that SIGINT or SIGPIPE ends."""

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def exit_cleanly(main: Main) -> Main:
    """Decorate the main function of a program so that it ends without a traceback.

    Its exit code is 141 if the reader of its output has gone (`study status | head -1`), 74 (with
    a message) if the output could not be written, and 130 after a Ctrl-C that it does not handle.
    A program that was started without standard output or error (`>&-`) runs without them.
    """
    @functools.wraps(main)
    def guarded(*arguments: Any, **named: Any) -> int:
        for stream in ("stdout", "stderr"):
            if getattr(sys, stream) is None:
                setattr(sys, stream, open(os.devnull, "w", encoding="utf-8"))
        try:
            try:
                return main(*arguments, **named)
            finally:
                _flush()
        except BrokenPipeError:
            return READER_GONE
        except OSError as fault:
            if not is_disk_full(fault) or fault.filename is not None:
                raise
            name = os.path.basename(sys.argv[0])
            sys.stderr.write(f"{name}: cannot write the output: {fault.strerror}\n")
            return os.EX_IOERR
        except KeyboardInterrupt:
            return INTERRUPTED

    return cast(Main, guarded)


def is_disk_full(fault: OSError) -> bool:
    """Whether data could not be written because of the disk: no space, a quota, a fault of it."""
    return fault.errno in _NO_ROOM


class ArgumentParser(argparse.ArgumentParser):
    """An argument parser that raises OSError if its help cannot be written, with each Python.

    From Python 3.12 on argparse ignores that, and the program ends with status 0.
    """

    def _print_message(self, message: str, file: Any = None) -> None:
        if message:
            (file or sys.stderr).write(message)


def _flush() -> None:
    """Write what was printed so far. Raises OSError."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())  # else the interpreter tries again, and complains
        os.close(nowhere)
        raise
