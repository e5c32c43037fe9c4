"""What a server shows and keeps besides ROS: the world editor, and state logs for it."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, List

if TYPE_CHECKING:
    from ..editor.logs.recorder import Recorder
    from ..editor.transport.server import EditorServer
    from ..errors import Issue
    from ..resources.resolver import Resolver
    from ..ros.lifecycle.server_options import Recording
    from ..simulator.simulator import Simulator


class FrontEnds:
    """Starts them; nothing of them is imported before."""

    def __init__(self) -> None:
        self._logs: List[str] = []

    def edit(self, simulator: "Simulator", resolver: "Resolver",
             settings: Dict[str, Any]) -> "EditorServer":
        """Start the world editor, which knows of the log that was begun before.

        Raises CommandError: it cannot listen, or what it needs is not installed.
        """
        from ..errors import CommandError

        try:
            from .. import editor

            options = editor.EditorOptions(**settings, more_logs=tuple(self._logs))
            return editor.start(simulator, resolver, options)
        except ImportError as missing:
            raise CommandError(
                f"{missing}; tools/run installs what the editor needs") from missing

    def record(self, simulator: "Simulator", resolver: "Resolver", wanted: "Recording",
               tell: "Callable[[Issue], None]") -> "Recorder":
        """Begin a state log where it is wanted, or else among the editor's logs.

        Raises CommandError: it cannot be written, or what it needs is not installed.
        """
        from ..errors import CommandError

        try:
            from ..editor import EditorOptions
            from ..editor.logs.recorder import Recorder, path_of

            path = path_of(wanted.path, EditorOptions().data_dir)
            recorder = Recorder(simulator, resolver, path, wanted.period, tell)
        except ImportError as missing:
            raise CommandError(f"{missing}; tools/run installs what a log needs") from missing
        self._logs.append(recorder.path)
        return recorder
