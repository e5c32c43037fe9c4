"""open_editor: where the world editor is."""
from __future__ import annotations

from typing import Any, Callable, Optional

from ...errors import CommandError

Open = Callable[[], str]
"""Starts the editor of this server unless it runs, and returns its address."""


class EditorService:
    """Tells clients where to look; the editor itself is another face."""

    def __init__(self, open_editor: Optional[Open]) -> None:
        self._open = open_editor

    def open(self, _request: Any, response: Any) -> str:
        """The editor's address."""
        if self._open is None:
            raise CommandError("this server has no editor")
        response.url = self._open()
        return f"the editor is at {response.url}"
