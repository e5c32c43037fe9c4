"""Parameters for plugins without a parameter server of ROS."""
from __future__ import annotations

import copy
import threading
from typing import Any, Dict, List, Mapping


class LocalParameters:
    """A tree of parameters, as ROS's server keeps one; from any thread.

    Args:
        values: by name; names may have slashes, and values may be mappings of names to values.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._root: Dict[str, Any] = {}
        self._lock = threading.Lock()
        self.update(values)

    def update(self, values: Mapping[str, Any], namespace: str = "/") -> None:
        """Set parameters of a namespace; those that `values` does not name stay."""
        with self._lock:
            _merge(self._inner(namespace), values)

    def set(self, name: str, value: Any) -> None:
        """Set a parameter; a mapping replaces the whole namespace of that name."""
        parts = _parts(name)
        if not parts:
            raise ValueError("a parameter must have a name")
        with self._lock:
            inner = self._inner("/".join(parts[:-1]))
            inner.pop(parts[-1], None)
            _merge(inner, {parts[-1]: value})

    def get(self, name: str, default: Any = None) -> Any:
        """A parameter, or a dictionary of all in a namespace; a copy."""
        with self._lock:
            found: Any = self._root
            for part in _parts(name):
                if not isinstance(found, dict) or part not in found:
                    return default
                found = found[part]
            return copy.deepcopy(found)

    def search(self, namespace: str, name: str, default: Any = None) -> Any:
        """A parameter of a namespace, or of the next one above that has it."""
        parts = _parts(namespace)
        missing = object()
        for length in range(len(parts), -1, -1):
            found = self.get("/".join([*parts[:length], name]), missing)
            if found is not missing:
                return found
        return default

    def _inner(self, namespace: str) -> Dict[str, Any]:
        inner = self._root
        for part in _parts(namespace):
            if not isinstance(inner.get(part), dict):
                inner[part] = {}
            inner = inner[part]
        return inner


def _parts(name: str) -> List[str]:
    return [part for part in name.split("/") if part]


def _merge(into: Dict[str, Any], values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        *above, last = _parts(str(name)) or [""]
        inner = into
        for part in above:
            if not isinstance(inner.get(part), dict):
                inner[part] = {}
            inner = inner[part]
        if isinstance(value, Mapping):
            if not isinstance(inner.get(last), dict):
                inner[last] = {}
            _merge(inner[last], value)
        else:
            inner[last] = copy.deepcopy(value)
