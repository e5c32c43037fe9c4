"""Gazebo's words for names that are not in the world, with the simulator's reason behind them.

Clients match the beginnings; the rest says which name it was and which ones are near.
"""
from __future__ import annotations

from contextlib import contextmanager
from typing import Iterator

from ...errors import CommandError
from ...simulator.registry import UnknownEntityError, UnknownFrameError


@contextmanager
def in_gazebos_words(entity: str, frame: str = "") -> Iterator[None]:
    """Put `entity` or `frame` before the text of an unknown name.

    Raises:
        CommandError: with the words in front.
    """
    try:
        yield
    except UnknownEntityError as fault:
        raise CommandError(f"{entity}, {fault}") from fault
    except UnknownFrameError as fault:
        raise CommandError(f"{frame}, {fault}" if frame else str(fault)) from fault
