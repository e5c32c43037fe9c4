"""The socket between the process of a plugin and the node, seen from the process."""
from __future__ import annotations

import os
import pickle
import threading
from collections import deque
from typing import Any, Callable, Deque, Dict, List, Set, Union

from ...engine.message_pipe import Wire
from ..context import PluginError, RequestError
from ..plugin_faults import describe_fault
from .messages import (
    Call,
    Done,
    Function,
    HandleCall,
    Query,
    QueryFailed,
    Raised,
    Readings,
    Reference,
    Value,
)

_LONG_S = 3600.0
_ONE_CALL = frozenset(("once", "scan", "photograph"))


class Connection:
    """Runs the calls of the node, and sends it the requests of the plugin.

    Attributes:
        readings: the state of the world, as of the call that runs.
        methods: functions of the process that the node calls by name.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self.readings = Readings("", 0, 0, {})
        self.methods: Dict[str, Callable[..., Any]] = {}
        self._functions: Dict[int, Callable[..., Any]] = {}
        self._numbers: Dict[Any, int] = {}
        self._single: Set[int] = set()       # functions that are called once at most
        self._answering: Set[Union[int, str]] = set()   # functions whose results are sent
        self._made = 0
        self._handle_calls: List[HandleCall] = []
        self._received: Deque[Any] = deque()
        self._thread = threading.get_ident()
        self._forked = False
        os.register_at_fork(after_in_child=self._leave)

    def _leave(self) -> None:
        """In a process that the plugin has forked: the connection stays with the plugin."""
        self._forked = True
        self._wire.sock.close()

    def receive(self) -> Any:
        """The next message. Raises EOFError when the node has hung up."""
        while not self._received:
            self._received += self._wire.receive(_LONG_S)
        return self._received.popleft()

    def send(self, message: object) -> None:
        """Send a message. Raises OSError when the node has hung up."""
        self._wire.send(message)

    def run(self, call: Call) -> None:
        """Call a function of the plugin, and send its result or its exception."""
        self.readings = call.readings
        try:
            self.send(self._done(call))
        except BaseException as fault:  # whatever it is, the node reports it
            if self._forked:
                os._exit(1)   # the plugin has returned, or raised, in a process that it forked
            kept = fault if isinstance(fault, RequestError) else None
            self.send(Raised(self._pop_handle_calls(), kept, describe_fault(fault)))

    def _done(self, call: Call) -> Done:
        result = self._function(call.function)(*call.arguments)
        return Done(self._pop_handle_calls(), result if call.function in self._answering else None)

    def _function(self, which: Union[int, str]) -> Callable[..., Any]:
        if isinstance(which, str):
            return self.methods[which]
        function = self._functions[which]
        if which in self._single:
            self._single.remove(which)
            del self._functions[which]
        return function

    def call_handle(self, handle: int, name: str, *arguments: Any) -> None:
        """Have the node call a method of a handle, before the next answer or return."""
        self._handle_calls.append(HandleCall(handle, name,
                                       pickle.dumps(arguments, pickle.HIGHEST_PROTOCOL)))

    def _pop_handle_calls(self) -> List[HandleCall]:
        handle_calls, self._handle_calls = self._handle_calls, []
        return handle_calls

    def state(self, handle: int) -> Any:
        """What a handle shows. Raises what reading it raises."""
        if handle not in self.readings.states:
            self.readings = self.query("readings")
        found = self.readings.states.get(handle)
        return self.query("state", handle) if found is None else found

    def query(self, name: str, *arguments: Any, **named: Any) -> Any:
        """The result of a method of the node's context. Raises its exception, or PluginError."""
        if self._forked:
            raise PluginError(f"'{name}' was used in a process that the plugin has forked; only the"
                              " plugin's own process has a context")
        if threading.get_ident() != self._thread:
            raise PluginError(f"'{name}' was used in a thread of the plugin; only functions that"
                              " the simulator calls can use the context")
        self.send(Query(self._pop_handle_calls(), name,
                      tuple(self._pack_argument(name, one) for one in arguments),
                      {key: self._pack_argument(name, one) for key, one in named.items()}))
        while True:
            message = self.receive()
            if isinstance(message, Call):
                self.run(message)
                continue
            if name not in ("readings", "state"):   # it may have changed the world
                self.readings.states.clear()
            if isinstance(message, QueryFailed):
                raise message.fault
            assert isinstance(message, Value)
            return message.value

    def _pack_argument(self, name: str, argument: Any) -> Any:
        if callable(argument):
            return Function(self._number(argument, name))
        number = getattr(argument, "number", None)
        if isinstance(number, int) and type(argument).__name__.startswith("Remote"):
            return Reference(number)
        if isinstance(argument, list):
            return [self._pack_argument(name, one) for one in argument]
        return argument

    def _number(self, function: Callable[..., Any], name: str) -> int:
        single = name in _ONE_CALL
        known = None if single else self._numbers.get(function)
        if known is not None:
            return known
        self._made += 1
        self._functions[self._made] = function
        if single:
            self._single.add(self._made)
        else:
            self._numbers[function] = self._made
        if name == "serve":
            self._answering.add(self._made)
        return self._made
