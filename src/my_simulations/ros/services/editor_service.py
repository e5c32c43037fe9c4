"""Service open_editor."""
from __future__ import annotations

from typing import Any, Callable, Optional

from ...errors import CommandError

Open = Callable[[], str]
"""Starts the editor of this server unless it runs, and returns its address."""


class EditorService:
    """Starts the world editor on request and returns its URL."""

    def __init__(self, open_editor: Optional[Open]) -> None:
        self._open = open_editor

    def open(self, _request: Any, response: Any) -> str:
        """Start the editor if needed. Raises CommandError: it is not installed or cannot listen."""
        if self._open is None:
            raise CommandError("this node was started without a world editor")
        response.url = self._open()
        return f"the world editor is at {response.url}; gzclient opens it"
