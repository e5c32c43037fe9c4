"""Counts what Python does, to see how work grows: unlike time it is the same on any machine."""
from __future__ import annotations

import sys
import threading
from types import FrameType
from typing import Any, Callable


def bytecodes(call: Callable[[], object]) -> int:
    """How many bytecodes this thread runs during a call, in all functions below it."""
    # Since Python 3.12 a trace function that asks for each bytecode misses some.
    return _monitored(call) if sys.version_info >= (3, 12) else _traced(call)


def _monitored(call: Callable[[], object]) -> int:
    count, here = 0, threading.get_ident()

    def ran(_code: Any, _offset: int) -> None:
        nonlocal count
        count += threading.get_ident() == here

    monitoring: Any = sys.monitoring  # type: ignore[attr-defined]
    tool, event = monitoring.PROFILER_ID, monitoring.events.INSTRUCTION
    monitoring.use_tool_id(tool, "bytecodes")
    monitoring.register_callback(tool, event, ran)
    monitoring.set_events(tool, event)
    try:
        call()
    finally:
        monitoring.set_events(tool, 0)
        monitoring.free_tool_id(tool)
    return count


def _traced(call: Callable[[], object]) -> int:
    count = 0

    def trace(frame: FrameType, event: str, _argument: Any) -> Any:
        nonlocal count
        if event == "call":
            frame.f_trace_lines, frame.f_trace_opcodes = False, True
        elif event == "opcode":
            count += 1
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        call()
    finally:
        sys.settrace(before)
    return count
