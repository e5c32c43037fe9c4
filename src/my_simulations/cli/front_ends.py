"""Front ends besides ROS: the world editor and state logs."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional

if TYPE_CHECKING:
    from ..editor.loading_server import LoadingServer
    from ..editor.logs.recorder import Recorder
    from ..editor.server import EditorServer
    from ..errors import Issue
    from ..resources.resolver import Resolver
    from ..ros.lifecycle.server_options import Recording
    from ..simulator.simulator import Simulator

_MISSING = "{}; install it by tools/run, or by pip install 'my_simulations[editor]'"


class FrontEnds:
    """Starts editor and recorder; imports them on first use."""

    def __init__(self) -> None:
        self._logs: List[str] = []

    def await_world(self, settings: Dict[str, Any]) -> "LoadingServer":
        """Serve the editor's page while the world is being loaded.

        Raises CommandError: the port is in use, or a dependency is not installed.
        """
        from ..errors import CommandError

        try:
            from .. import editor

            return editor.start_loading(editor.EditorOptions(**settings))
        except ImportError as missing:
            raise CommandError(_MISSING.format(missing)) from missing

    def edit(self, simulator: "Simulator", resolver: "Resolver", settings: Dict[str, Any],
             loading: "Optional[LoadingServer]" = None) -> "EditorServer":
        """Start the world editor, with the page that was served meanwhile; it lists earlier logs.

        Raises CommandError: the port is in use, or a dependency is not installed.
        """
        from ..errors import CommandError

        try:
            from .. import editor

            options = editor.EditorOptions(**settings, more_logs=tuple(self._logs))
            return editor.start(simulator, resolver, options, loading)
        except ImportError as missing:
            raise CommandError(_MISSING.format(missing)) from missing

    def record(self, simulator: "Simulator", resolver: "Resolver", wanted: "Recording",
               tell: "Callable[[Issue], None]", topics: Any = None) -> "Recorder":
        """Start a state log in the given folder, else in the editor's log folder.

        `topics` is the `TopicGraph` of the node; None if no topics are recorded.

        Raises CommandError: it cannot be written, or a dependency is not installed.
        """
        from ..errors import CommandError

        try:
            from ..editor import EditorOptions
            from ..editor.logs.recorder import Recorder, path_of

            path = path_of(wanted.path, EditorOptions().data_dir)
            recorder = Recorder(simulator, resolver, path, wanted.period, tell, topics,
                                wanted.topics)
        except ImportError as missing:
            raise CommandError(_MISSING.format(missing)) from missing
        self._logs.append(recorder.path)
        return recorder
