"""Writes a state log as one HTML file that plays it without a server and without a network."""
from __future__ import annotations

import base64
import gzip
import json
import math
import os
import struct
import tempfile
from typing import Any, Dict, Iterable, List, Sequence, Tuple

from ...errors import CommandError
from ...resources.resolver import Resolver
from ...simulator.safe_file import write_atomically
from ..scene.content_types import resource_type
from ..topics.topic_frame import decode_frame, encode_frame
from ..transport.page_bundle import FOLDER, sources_of
from ..transport.page_files import PageFiles, node_modules
from ..transport.pose_messages import Poses
from .replay_files import ReplayFiles
from .state_log import CONTACTS, MESSAGE, TOPICS, LogReader, LogWriter

PROGRAM = "replay.js"
"""The packed program of the page, which the set-up makes beside the packed editor."""

STATES_HZ = 30.0
"""States a second of sim time that a page contains; it interpolates between them."""

_MESSAGES_S = 0.1
"""Least sim time between two messages of a topic that a page contains."""

_STYLES = ("theme", "layout", "widgets", "panels")
_GRID = 2.0 ** -14
"""m, and of a quaternion's parts: poses are rounded to this, which compresses to a third."""
_SIZE = struct.Struct("<I")


def write_replay(log: str, path: str, resolver: Resolver, name: str = "",
                 states_hz: float = STATES_HZ, last: float = math.inf,
                 curves: Sequence[str] = ()) -> List[str]:
    """Write the page.

    Args:
        log: the state log.
        path: the HTML file; one that exists is replaced.
        resolver: finds the meshes and pictures of the models.
        name: title of the page; default: the folder of the log, or its file.
        states_hz: most states for each second of sim time.
        last: only so many s of sim time at the end of the log.
        curves: numbers of recorded topics that the plot shows from the start, such as
            `/cmd_vel.linear.x`.

    Returns:
        Addresses of meshes and pictures that were not found.

    Raises:
        CommandError: the log cannot be read, the page's program is not installed, or the file
            cannot be written.
    """
    files = ReplayFiles(resolver)
    states = _thin_log(log, states_hz, last, files)
    data = _compress_text(_container(name or _name_of(log), states, files.found, curves))
    page = (_template().replace("/*STYLE*/", _styles()).replace("/*PROGRAM*/", _program())
            .replace("/*DATA*/", data))
    write_atomically(os.path.abspath(path), page.encode(), overwrite=True)
    return files.missing


def _name_of(log: str) -> str:
    folder, file = os.path.split(os.path.abspath(log))
    return os.path.basename(folder) if file == "state.log" else file


def _thin_log(log: str, states_hz: float, last: float, files: ReplayFiles) -> bytes:
    """The log with fewer states and rounded poses; adds the files of its worlds to `files`."""
    import numpy as np

    if not states_hz > 0.0:
        raise CommandError(f"states a second must be above 0, is {states_hz:g}")
    if not last > 0.0:
        raise CommandError(f"the recorded time must be above 0, is {last:g} s")
    reader = LogReader(log)
    try:
        with tempfile.TemporaryDirectory(prefix="my_simulations_replay_") as folder:
            writer = LogWriter(os.path.join(folder, "state.log"))
            known, noted = -2, -1
            notes = _ThinRecords(writer)
            for time in reader.times(1.0 / states_hz):
                if time < reader.end - last:
                    continue
                number, poses = reader.seek(time)
                if number != known:
                    writer.document(time, _strip_document(json.loads(reader.text(number)), files))
                    known = number
                values = np.round(poses.values / _GRID) * _GRID
                writer.poses(Poses(poses.ids, values.astype(np.float32), 0, time, time))
                notes.add(time, reader.records(noted, poses.step))
                noted = poses.step
            writer.close()
            with open(writer.path, "rb") as stream:
                return stream.read()
    finally:
        reader.close()


class _ThinRecords:
    """Writes the newest contacts and messages, and rounds what compresses badly."""

    def __init__(self, writer: LogWriter) -> None:
        self._writer = writer
        self._waiting: Dict[str, bytes] = {}
        self._due: Dict[str, float] = {}

    def add(self, time: float, notes: Iterable[Tuple[int, bytes]]) -> None:
        """Take the notes since the last state, and write what is due at this one."""
        contacts = b""
        for kind, data in notes:
            if kind == CONTACTS:
                contacts = data
            elif kind == TOPICS:
                self._writer.add_record(TOPICS, time, data)
            else:
                self._waiting[decode_frame(data)[0]["topic"]] = data
        if contacts:
            self._writer.add_record(CONTACTS, time, contacts)
        for topic in list(self._waiting):
            if time >= self._due.get(topic, time) - 1e-9:
                self._due[topic] = time + _MESSAGES_S
                self._writer.add_record(MESSAGE, time, _round_frame(self._waiting.pop(topic)))


def _round_frame(frame: bytes) -> bytes:
    """A frame whose ranges are multiples of 1 mm (exactly: 2^-10 m); others as they are."""
    import numpy as np

    head, payload = decode_frame(frame)
    if head["view"]["type"] != "scan":
        return frame
    ranges = np.frombuffer(payload, dtype="<f4")
    return encode_frame(head, (np.round(ranges * 1024.0) / 1024.0).astype("<f4").tobytes())


def _strip_document(document: Dict[str, Any], files: ReplayFiles) -> Dict[str, Any]:
    """A world document without what a replay does not show: collisions and folders."""
    for model in document["models"]:
        for link in model["links"]:
            link["collisions"] = []
    files.add_world(document)
    document["file"] = os.path.basename(document.get("file") or "")
    return document


def _container(name: str, log: bytes, files: Dict[str, bytes], curves: Sequence[str]) -> bytes:
    """The head in JSON, the log and the files, as `web/js/replay/page_files.ts` reads them."""
    at = len(log)
    places: Dict[str, Tuple[int, int, str]] = {}
    for address, content in files.items():
        places[address] = (at, len(content), resource_type(address))
        at += len(content)
    head = json.dumps({"name": name, "log": [0, len(log)], "files": places,
                       "curves": list(curves)}).encode()
    return b"".join([_SIZE.pack(len(head)), head, log, *files.values()])


def _compress_text(data: bytes) -> str:
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
            return _compress_text(_text(os.path.join(folder, PROGRAM)).encode())
    except OSError:
        pass  # it was not packed: the message below names the command that does it
    raise CommandError("the program of replay pages is not packed, or of other sources than the"
                       " editor's page: run tools/run --set-up-only")


def _text(path: str) -> str:
    with open(path, encoding="utf-8") as stream:
        return stream.read()
