"""A plugin whose code runs in a process of its own: calls go there, and its requests come back."""
from __future__ import annotations

import pickle
import sys
import time
from typing import Any, Callable, Dict, Optional, Tuple, Union

from ..base import Plugin
from ..call_watch import CallLimits
from ..context import PluginError
from ..plugin_faults import DescribedFaultError, describe_fault
from ..simulated_context import SimulatedContext
from .messages import (
    CALLS_WITHOUT_RESULT,
    CONTEXT,
    HANDLE_CALLS,
    HANDLES,
    METHODS,
    PROPERTIES,
    Call,
    Done,
    Function,
    HandleCall,
    HandleMade,
    Query,
    QueryFailed,
    Raised,
    Readings,
    Reference,
    Start,
    Value,
)
from .plugin_process import PluginProcess


class IsolatedPlugin(Plugin):
    """Stands for the plugin in the thread of the host.

    The host waits for the process in each call, so that the plugin acts at exact steps, as one in
    the node does. What handles show is sent with the call.

    Args:
        context: of the plugin.
        where: the class as `package.module:Class`.
        process: newly started.
        limits: how long a call may take.
        while_waiting: called during the wait for the process, see `PluginProcess.receive`.
    """

    def __init__(self, context: SimulatedContext, where: str, process: PluginProcess,
                 limits: CallLimits, while_waiting: Callable[[float], bool]) -> None:
        super().__init__(context)
        self._simulated, self._process, self._limits = context, process, limits
        self._nested_turns = while_waiting
        self._handles: Dict[int, Tuple[str, Any]] = {CONTEXT: ("context", context)}
        self._shown: Dict[int, Tuple[str, Any]] = {}   # those of the handles that have a state
        self._made = CONTEXT
        process.send(list(sys.path))
        process.receive(limits.doubled(), while_waiting)
        process.send(Start(where, context.spec, context.sensor, context.sensor_link,
                           context.sensor_joint))
        self._call("construct", limits=limits.doubled())

    def load(self) -> None:
        self._call("load", limits=self._limits.doubled())

    def reset(self) -> None:
        self._call("reset")

    def clock_set(self) -> None:
        self._call("clock_set")

    def close(self) -> None:
        """The model is being deleted, or the program ends."""
        self._call("close")

    def _call(self, function: Union[int, str], *arguments: Any,
              limits: Optional[CallLimits] = None) -> Any:
        """Call a function in the process, and do what it asks for until it returns.

        Raises PluginError with what it has raised, or with why the process has ended.
        """
        process, limits = self._process, limits or self._limits
        begun = time.monotonic()
        process.send(Call(function, arguments, self._readings()))
        while True:
            message = process.receive(limits, self._nested_turns)
            for order in message.handle_calls:
                self._carry_out(order)
            if isinstance(message, Done):
                return message.result
            if isinstance(message, Raised):
                raise message.fault or DescribedFaultError(message.text)
            self._nested_turns(time.monotonic() - begun)   # many short requests take long, too
            process.send(self._answer(message))

    def _readings(self) -> Readings:
        context = self._simulated
        return Readings(context.model, context.now_ns, context.step, {
            number: _state(kind, handle) for number, (kind, handle) in self._shown.items()})

    def _carry_out(self, order: HandleCall) -> None:
        kind, handle = self._handles.get(order.handle, ("", None))
        allowed = CALLS_WITHOUT_RESULT if order.handle == CONTEXT else HANDLE_CALLS.get(kind,
                                                                                        frozenset())
        if order.name not in allowed:
            return   # a handle that has ended
        getattr(handle, order.name)(*pickle.loads(order.arguments))
        if order.name in ("close", "end"):
            self._forget(order.handle)

    def _forget(self, number: int) -> None:
        self._handles.pop(number, None)
        self._shown.pop(number, None)

    # -- answers -----------------------------------------------------------------------------------

    def _answer(self, query: Query) -> Union[Value, QueryFailed]:
        try:
            return Value(self._value(query))
        except Exception as fault:  # the plugin receives it, as from a context in its own process
            known = type(fault).__module__.startswith(("builtins", "my_simulations.plugins"))
            return QueryFailed(fault if known else PluginError(describe_fault(fault)))

    def _value(self, query: Query) -> Any:
        """Return what the plugin's process asks of the context in this process."""
        name, context = query.name, self._simulated
        if name == "readings":
            return self._readings()
        if name == "state":
            return _read(*self._handles[query.arguments[0]])
        if name in PROPERTIES:
            return getattr(context, name)
        if name not in METHODS and name not in HANDLES:
            raise AttributeError(f"the context has no '{name}'")
        arguments = [self._unpack_argument(name, one) for one in query.arguments]
        named = {key: self._unpack_argument(name, one) for key, one in query.named.items()}
        if name in METHODS:
            return getattr(context, name)(*arguments, **named)
        return self._handle(HANDLES[name], getattr(context, name)(*arguments, **named))

    def _handle(self, kind: str, handle: Any) -> HandleMade:
        self._made += 1
        self._handles[self._made] = (kind, handle)
        if kind in _SHOWN:
            self._shown[self._made] = (kind, handle)
        facts = {"link": ("name", "inertial"), "joint": ("name", "parent", "child", "spec")}
        return HandleMade(self._made, kind, {
            name: getattr(handle, name) for name in facts.get(kind, ())}, _state(kind, handle))

    def _unpack_argument(self, name: str, argument: Any) -> Any:
        if isinstance(argument, Function):
            return self._function(name, argument.number)
        if isinstance(argument, Reference):
            return self._handles[argument.number][1]
        if isinstance(argument, (list, tuple)) and any(
                isinstance(one, Reference) for one in argument):
            return [self._unpack_argument(name, one) for one in argument]
        return argument

    def _function(self, name: str, number: int) -> Callable[..., None]:
        """A function of the plugin, to be passed to a method of the context."""
        if name == "once":
            handle = self._made + 1   # the one that this call of `once` returns

            def once() -> None:
                self._forget(handle)
                self._call(number)

            return once
        if name != "serve":
            return lambda *arguments: self._call(number, *arguments)

        def serve(request: Any, response: Any) -> None:
            answered = self._call(number, request, response)
            for field in getattr(answered, "__slots__", None) or vars(answered):
                setattr(response, field, getattr(answered, field))

        return serve


_SHOWN = frozenset(("link", "joint", "topic"))


def _read(kind: str, handle: Any) -> Any:
    """What changes of a handle."""
    if kind == "link":
        return handle.pose, handle.twist
    if kind == "joint":
        return handle.position, handle.velocity, handle.set_count
    return handle.wanted if kind == "topic" else True


def _state(kind: str, handle: Any) -> Any:
    """As `_read`; None where that raises a PluginError, which a reader must receive instead."""
    try:
        return _read(kind, handle)
    except PluginError:
        return None
