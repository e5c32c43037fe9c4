"""A ROS graph for plugins that keeps what is published; a test sends what is heard."""
from __future__ import annotations

from my_simulations.plugins.graph import ServiceTakenError
from my_simulations.plugins.testing import Message


class Graph:
    """Records published messages; a test sends messages. `ignored` topics have no subscriber.

    `parameters`: dictionaries in dictionaries, by namespace.
    """

    def __init__(self, parameters=None):
        self.parameters = parameters or {}
        self.sent, self.heard, self.transforms = [], {}, []
        self._calls = {}
        self.ignored, self._listeners = set(), []

    def message(self, kind):
        return Message()

    def stamp(self, ns):
        return ns

    def publish(self, name, kind, queue, latch, changed):
        graph = self
        self._listeners.append(changed)

        class Topic:
            @property
            def wanted(self):
                return name not in graph.ignored

            def send(self, message):
                graph.sent.append((name, message))

            def close(self):
                graph.sent.append((name, None))
        return Topic()

    def subscribe(self, name, kind, call, queue):
        heard, calls = self.heard, self._calls.setdefault(name, [])
        calls.append(call)
        heard[name] = call if len(calls) == 1 else (
            lambda *messages: [one(*messages) for one in list(calls)])

        class Closing:
            def close(self):
                calls.remove(call)
                if not calls:
                    heard.pop(name, None)
        return Closing()

    def serve(self, name, kind, call):
        if name in self.heard:
            raise ServiceTakenError(f"the service {name} is offered already, by another plugin")
        return self.subscribe(name, kind, call, 1)

    def parameter(self, namespace, name, default):
        found = self.parameters
        for part in f"{namespace}/{name}".strip("/").split("/"):
            if not isinstance(found, dict) or part not in found:
                return default
            found = found[part]
        return found

    def search_parameter(self, namespace, name, default):
        return default

    def listen(self, name, wanted=True):
        """Subscribe to a topic, or no longer."""
        (self.ignored.discard if wanted else self.ignored.add)(name)
        for changed in self._listeners:
            changed()

    def offer_transforms(self, changed):
        self._listeners.append(changed)

    @property
    def transforms_wanted(self):
        return "/tf" not in self.ignored

    def send_transforms(self, transforms, ns):
        self.transforms += [(ns, *one) for one in transforms]

    def on(self, name):
        return [message for topic, message in self.sent if topic == name and message is not None]
