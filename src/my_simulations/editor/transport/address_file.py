"""Where an editor keeps its address with the token, for its user alone.

ROS parameters, topics and log files, and the command lines of processes, can be read by every user
of a machine. So these have the address without the token. The whole one is in a file that only the
user can read, and beside it a page that leads there, for browsers: they are started with its path.
"""
from __future__ import annotations

import contextlib
import html
import json
import os
import re
from typing import List

from .private_file import private_folder, write_private


def without_token(address: str) -> str:
    """The address as everybody may know it."""
    return address.partition("?")[0]


def write(address: str, cache_dir: str = "") -> List[str]:
    """Keep an address for `with_token` and `local_page`; returns the files, for `remove_files`.

    Raises OSError.
    """
    shown = html.escape(address, quote=True)
    texts = {
        _path(address, ".json", cache_dir): json.dumps({"address": address}),
        _path(address, ".html", cache_dir): (
            '<!DOCTYPE html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
            f'<meta http-equiv="refresh" content="0;url={shown}"><title>World editor</title>'
            f'<a href="{shown}">World editor</a>\n'),
    }
    for path, text in texts.items():
        write_private(path, text.encode())
    return list(texts)


def remove_files(paths: List[str]) -> None:
    for path in paths:
        with contextlib.suppress(OSError):  # it is gone, or the disk cannot be written any more
            os.unlink(path)


def with_token(address: str, cache_dir: str = "") -> str:
    """The address with its token, where this user runs that editor; else the address as given."""
    try:
        with open(_path(address, ".json", cache_dir), encoding="utf-8") as stream:
            found = json.load(stream)["address"]
    except (OSError, ValueError, KeyError, TypeError):
        return address
    if not isinstance(found, str) or without_token(found) != without_token(address):
        return address
    return found


def local_page(address: str, cache_dir: str = "") -> str:
    """Return the URL of the local page that redirects to the address with token; "" without one."""
    path = _path(address, ".html", cache_dir)
    return f"file://{path}" if os.path.isfile(path) else ""


def _path(address: str, ending: str, cache_dir: str) -> str:
    name = re.sub(r"[^A-Za-z0-9.-]", "_", without_token(address).partition("//")[2].rstrip("/"))
    return os.path.join(private_folder(cache_dir), name + ending)
