"""Gazebo's status messages for unknown names, followed by the simulator's own.

Clients match Gazebo's text at the beginning; the rest names the entity and suggests similar ones.
"""
from __future__ import annotations

from contextlib import contextmanager
from typing import Iterator

from ...errors import CommandError
from ...simulator.registry import NameTakenError, UnknownEntityError, UnknownFrameError


@contextmanager
def gazebo_prefix(entity: str, frame: str = "") -> Iterator[None]:
    """Prefix errors about unknown names with Gazebo's status message.

    Args:
        entity: prefix for an unknown model, link or joint.
        frame: prefix for an unknown reference frame; "" for none.

    Raises:
        CommandError: the prefixed error.
    """
    try:
        yield
    except UnknownEntityError as fault:
        raise CommandError(f"{entity}, {fault}") from fault
    except UnknownFrameError as fault:
        raise CommandError(f"{frame}, {fault}" if frame else str(fault)) from fault


@contextmanager
def name_taken_message(entity: str) -> Iterator[None]:
    """Gazebo's status message where a name is taken; `entity` as "model 'x'".

    Raises CommandError: the error in Gazebo's words.
    """
    try:
        yield
    except NameTakenError as fault:
        raise CommandError(f"Failure - entity already exists. ({entity})") from fault
