"""Writes a state log as one HTML file that plays it without a server and without a network."""
from __future__ import annotations

import base64
import gzip
import json
import os
import struct
import tempfile
from typing import Any, Dict, List, Tuple

from ...errors import CommandError
from ...resources.resolver import Resolver
from ...simulator.safe_file import write_whole
from ..scene.content_types import resource_type
from ..transport.page_bundle import FOLDER, sources_of
from ..transport.page_files import PageFiles, node_modules
from ..transport.pose_messages import Poses
from .replay_files import ReplayFiles
from .state_log import LogReader, LogWriter

PROGRAM = "replay.js"
"""The packed program of the page, which the set-up makes beside the packed editor."""

STATES_HZ = 30.0
"""States a second of sim time that a page contains; it interpolates between them."""

_STYLES = ("theme", "layout", "widgets", "panels")
_GRID = 2.0 ** -14
"""m, and of a quaternion's parts: poses are rounded to this, which compresses to a third."""
_SIZE = struct.Struct("<I")


def write_replay(log: str, path: str, resolver: Resolver, name: str = "",
                 states_hz: float = STATES_HZ) -> List[str]:
    """Write the page.

    Args:
        log: the state log.
        path: the HTML file; one that exists is replaced.
        resolver: finds the meshes and pictures of the models.
        name: title of the page; default: the folder of the log, or its file.
        states_hz: most states for each second of sim time.

    Returns:
        Addresses of meshes and pictures that were not found.

    Raises:
        CommandError: the log cannot be read, the page's program is not installed, or the file
            cannot be written.
    """
    files = ReplayFiles(resolver)
    states = _thinned(log, states_hz, files)
    data = _packed(_container(name or _name_of(log), states, files.found))
    page = (_template().replace("/*STYLE*/", _styles()).replace("/*PROGRAM*/", _program())
            .replace("/*DATA*/", data))
    write_whole(os.path.abspath(path), page.encode(), overwrite=True)
    return files.missing


def _name_of(log: str) -> str:
    folder, file = os.path.split(os.path.abspath(log))
    return os.path.basename(folder) if file == "state.log" else file


def _thinned(log: str, states_hz: float, files: ReplayFiles) -> bytes:
    """The log with fewer states and rounded poses; adds the files of its worlds to `files`."""
    import numpy as np

    if not states_hz > 0.0:
        raise CommandError(f"states a second must be above 0, is {states_hz:g}")
    reader = LogReader(log)
    try:
        with tempfile.TemporaryDirectory(prefix="my_simulations_replay_") as folder:
            writer = LogWriter(os.path.join(folder, "state.log"))
            known = -2
            for time in reader.times(1.0 / states_hz):
                number, poses = reader.seek(time)
                if number != known:
                    writer.document(time, _shown(json.loads(reader.text(number)), files))
                    known = number
                values = np.round(poses.values / _GRID) * _GRID
                writer.poses(Poses(poses.ids, values.astype(np.float32), 0, time, time))
            writer.close()
            with open(writer.path, "rb") as stream:
                return stream.read()
    finally:
        reader.close()


def _shown(document: Dict[str, Any], files: ReplayFiles) -> Dict[str, Any]:
    """A world document without what a replay does not show: collisions and folders."""
    for model in document["models"]:
        for link in model["links"]:
            link["collisions"] = []
    files.add_world(document)
    document["file"] = os.path.basename(document.get("file") or "")
    return document


def _container(name: str, log: bytes, files: Dict[str, bytes]) -> bytes:
    """The head in JSON, the log and the files, as `web/js/replay/page_files.js` reads them."""
    at = len(log)
    places: Dict[str, Tuple[int, int, str]] = {}
    for address, content in files.items():
        places[address] = (at, len(content), resource_type(address))
        at += len(content)
    head = json.dumps({"name": name, "log": [0, len(log)], "files": places}).encode()
    return b"".join([_SIZE.pack(len(head)), head, log, *files.values()])


def _packed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def _template() -> str:
    return _text(os.path.join(PageFiles.own_folder(), "replay.html"))


def _styles() -> str:
    folder = os.path.join(PageFiles.own_folder(), "css")
    return "\n".join(_text(os.path.join(folder, f"{name}.css")) for name in _STYLES)


def _program() -> str:
    page = PageFiles.own_folder()
    modules = node_modules(page)
    folder = os.path.join(modules, FOLDER)
    try:
        if modules and _text(os.path.join(folder, "sources")).strip() == sources_of(page, modules):
            return _packed(_text(os.path.join(folder, PROGRAM)).encode())
    except OSError:
        pass  # it was not packed: the message below names the command that does it
    raise CommandError("the program of replay pages is not packed, or of other sources than the"
                       " editor's page: run tools/run --set-up-only")


def _text(path: str) -> str:
    with open(path, encoding="utf-8") as stream:
        return stream.read()
