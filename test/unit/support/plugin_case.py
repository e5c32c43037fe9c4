"""A world with plugins: a simulator that is stepped by a test, a host, and a graph that keeps."""
from __future__ import annotations

from plugin_graph import Graph
from running_simulator import started
from waiting import until

from my_simulations.plugins.call_watch import CALL_LIMITS
from my_simulations.plugins.host import PluginHost
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.plugins.testing import Message


class PluginCase:
    """Begins paused, with the plugins of the world's models loaded; `backend` moves it.

    `extra`: classes of plugins by library; `parameters`: of the graph, by namespace; `isolate`: run
    plugins in processes of their own.
    """

    def __init__(self, world, backend, extra=None, limits=CALL_LIMITS, parameters=None,
                 isolate=False):
        self.issues, self.graph = [], Graph(parameters)
        self.sim = started(world, backend, log=self.issues.append)
        self.host = PluginHost(self.sim, self.graph, PluginRegistry(extra), self.issues.append,
                               limits, isolate)
        self.host.start()

    def deliver(self, topic, **fields):
        """Send a message; returns when the plugin has heard it."""
        self.graph.heard[topic](Message(**fields))
        until(lambda: not self.host.has_pending_input)

    def ask(self, service, **fields):
        response = Message()
        self.graph.heard[service](Message(**fields), response)
        return response

    def last(self, topic, ns):
        """The message of a topic that is stamped with a sim time."""
        def found():
            return [one for one in self.graph.on(topic) if one.header.stamp == ns]
        until(found)
        return found()[-1]

    def now(self):
        """Sim time, ns, of a world whose steps are a millisecond."""
        return self.sim.clock.step * 10 ** 6

    def close(self):
        """End plugins and world."""
        self.host.stop()
        self.sim.close()


def kept(make):
    """For a fixture: a function that makes cases, all closed at the end."""
    made = []

    def one(*arguments, **options):
        made.append(make(*arguments, **options))
        return made[-1]

    try:
        yield one
    finally:
        for case in made:
            case.close()
