"""dynamic_reconfigure for plugins: some values that can be seen and changed while they run.

Names of topics and of the service are those of dynamic_reconfigure's server; its tools (`dynparam`,
rqt_reconfigure) find and set what is offered here.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, Sequence

from .context import Context, Handle, RequestError
from .reconfigure_options import Option, OptionError, OptionMessages, Value

__all__ = ["Option", "Reconfigure", "Value"]


class Reconfigure:
    """A server of dynamic_reconfigure.

    Args:
        context: of the plugin.
        name: what `dynparam` lists, below the plugin's namespace.
        options: what can be changed.
        values: what holds now, by name.
        changed: receives all values after some were set; its exceptions answer the request.
    """

    def __init__(self, context: Context, name: str, options: Sequence[Option],
                 values: Mapping[str, Value], changed: Callable[[Dict[str, Value]], None]) -> None:
        self._messages, self._changed = OptionMessages(options, context.message), changed
        self._values = {option.name: values[option.name] for option in options}
        below = f"{name}/" if name else ""
        descriptions = context.publish(f"{below}parameter_descriptions",
                                       "dynamic_reconfigure/ConfigDescription", 10, latch=True)
        self._updates = context.publish(f"{below}parameter_updates", "dynamic_reconfigure/Config",
                                        10, latch=True)
        descriptions.publish(self._messages.description())
        self._updates.publish(self._messages.config(self._values))
        self._handles: List[Handle] = [
            descriptions, self._updates,
            context.serve(f"{below}set_parameters", "dynamic_reconfigure/Reconfigure", self._set)]

    def publish(self, values: Mapping[str, Value]) -> None:
        """Publish values that were changed other than by the service."""
        self._values = {name: values[name] for name in self._values}
        self._updates.publish(self._messages.config(self._values))

    def close(self) -> None:
        """Remove the topics and the service from the graph."""
        for handle in self._handles:
            handle.close()

    def _set(self, request: Any, response: Any) -> None:
        try:
            wanted = {**self._values, **self._messages.read(request.config)}
        except OptionError as fault:
            raise RequestError(str(fault)) from fault
        self._changed(wanted)
        self.publish(wanted)
        response.config = self._messages.config(wanted)
