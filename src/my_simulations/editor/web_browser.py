"""Prints the URL of the editor, and opens it in a browser if there is a display.

The token of the URL is for this user alone: the browser is started with a local page that holds it,
because all users can read command lines, and a log file that others can read gets none.
"""
from __future__ import annotations

import os
import stat
import sys
from typing import Mapping, TextIO

from .transport import address_file

NO_BROWSER = "MY_SIMULATIONS_NO_BROWSER"
"""Environment variable; if set, no browser is started."""


def has_display(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether a browser window can be opened."""
    if environment.get(NO_BROWSER):
        return False
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def is_private(stream: TextIO) -> bool:
    """False for a file that other users may read; terminals and pipes have one reader."""
    try:
        status = os.fstat(stream.fileno())
    except (OSError, ValueError):  # no file at all
        return True
    return not stat.S_ISREG(status.st_mode) or not status.st_mode & 0o077


def show(url: str, program: str) -> None:
    """Print the URL with its token, and open it if there is a display.

    `url`: of an editor, with or without its token.
    """
    full_url = address_file.with_token(url)
    if is_private(sys.stdout):
        _write(sys.stdout, f"{program}: the world editor is at {full_url}")
    else:
        page = address_file.local_page(full_url)
        hint = f"open {page}, which leads there, or run gzclient, where ROS runs" if page else (
            "run gzclient in a terminal for the address with the token")
        _write(sys.stdout, f"{program}: the world editor is at"
               f" {address_file.without_token(full_url)}; others can read this output, so {hint}")
    if not has_display():
        return
    import webbrowser

    has_token = full_url != address_file.without_token(full_url)
    shown = address_file.local_page(full_url) if has_token else full_url
    try:
        opened = bool(shown) and webbrowser.open(shown)
    except webbrowser.Error:
        opened = False
    if not opened:
        _write(sys.stderr, f"{program}: cannot start a browser; open the URL yourself")


def _write(stream: TextIO, line: str) -> None:
    stream.write(line + "\n")
    stream.flush()
