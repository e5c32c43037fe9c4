"""Writes what happens in a world of a Python program to a state log."""
from __future__ import annotations

import contextlib
import os
from typing import Optional

from ...python_api import OpenWorld
from ...resources.resolver import Resolver
from ..scene.scene_changes import Mirror
from ..scene.scene_json import Documents
from ..transport.pose_reader import PoseReader
from .log_channels import ContactChannel
from .state_log import LogWriter


class LogRecord:
    """A state log, which the editor plays.

    Args:
        path: the file; one that is there is replaced.

    Raises:
        CommandError: it cannot be written; also from `record_state` and `close`.
    """

    def __init__(self, path: str) -> None:
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
        self._writer = LogWriter(os.path.abspath(path))
        self._documents = Documents(Resolver.from_environment())
        self._reader: Optional[PoseReader] = None
        self._contacts: Optional[ContactChannel] = None
        self._revision = -1

    def record_state(self, world: OpenWorld) -> None:
        """Add the present state; of one world only."""
        simulator = world.simulator
        self._reader = self._reader or PoseReader(simulator)
        if simulator.models.revision != self._revision:
            message = Mirror(simulator, self._documents).world_push()
            self._writer.document(simulator.clock.sim_ns * 1e-9, message["document"])
            self._revision = message["revision"]
        poses = self._reader.read(self._revision, 0.0)
        if poses is not None:
            self._writer.poses(poses)
            self._contacts = self._contacts or ContactChannel(simulator)
            self._contacts.write(self._writer, poses.sim_time)

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()
