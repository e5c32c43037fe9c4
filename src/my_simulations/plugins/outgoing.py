"""Sends what plugins have published since the last time."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple

from .graph import Graph, Topic, TransformOf
from .message_maker import MessageMaker, PendingMessage
from .running import RunningPlugin
from .simulated_context import SimulatedContext


class Outgoing:
    """Messages leave in order; those that take long to make, from another thread.

    Args:
        graph: how they reach ROS.
        sent: called, in another thread, when a message that took long has left.
    """

    def __init__(self, graph: Graph, sent: Callable[[], None] = lambda: None) -> None:
        self._graph, self._maker = graph, MessageMaker(sent)

    def stop(self) -> None:
        self._maker.stop()

    def send(self, plugins: Mapping[SimulatedContext, RunningPlugin], guarded: Callable[..., bool],
             failing: Callable[[RunningPlugin], Callable[[Exception], None]]) -> None:
        """Send the transforms of some plugins, then their messages, which may need them.

        Args:
            plugins: by their contexts.
            guarded: calls a function for a plugin, which is switched off if that fails.
            failing: makes the function that receives a plugin's fault in another thread.
        """
        transforms: Dict[int, List[TransformOf]] = {}
        for context in plugins:
            for ns, transform in context.transforms:
                transforms.setdefault(ns, []).append(transform)
            context.transforms = []
        for ns in sorted(transforms):
            self._graph.send_transforms(transforms[ns], ns)
        for context, running in plugins.items():
            if context.outbox:
                outbox, context.outbox = context.outbox, []
                guarded(running, self._send, outbox, failing(running))

    def _send(self, messages: Sequence[Tuple[Topic, Any]],
              fail: Callable[[Exception], None]) -> None:
        for topic, message in messages:
            if isinstance(message, PendingMessage):
                self._maker.put(topic, message, fail)
            else:
                topic.send(message)
