"""What may travel between page and server: `web/protocol.json`, and a check against it."""
from __future__ import annotations

import json
import math
import os
import re
from typing import Any, Callable, Dict, List, Optional, Tuple

from ...errors import CommandError

_LIST = re.compile(r"(.*)\[(\d*)\]\Z", re.DOTALL)
_DEEPEST = 32

Test = Callable[[Any], bool]


class ProtocolError(CommandError):
    """A message that the protocol does not know; the text says where it differs."""

    code = "protocol"


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


_PLAIN: Dict[str, Tuple[Test, str]] = {
    "string": (lambda value: isinstance(value, str), "a text"),
    "number": (_is_number, "a finite number"),
    "integer": (lambda value: isinstance(value, int) and not isinstance(value, bool),
                "a whole number"),
    "boolean": (lambda value: isinstance(value, bool), "true or false"),
    "object": (lambda value: isinstance(value, dict), "an object"),
    "any": (lambda value: True, "anything"),
}


class Protocol:
    """The messages of one protocol file."""

    def __init__(self, text: str) -> None:
        self._data = json.loads(text)
        self.version: int = self._data["version"]
        self.limits: Dict[str, int] = self._data["limits"]
        self._types: Dict[str, Any] = self._data["types"]

    @classmethod
    def from_folder(cls, web: str) -> "Protocol":
        """The protocol that lies with the page. Raises CommandError when there is none."""
        path = os.path.join(web, "protocol.json")
        try:
            with open(path, encoding="utf-8") as stream:
                return cls(stream.read())
        except (OSError, ValueError, KeyError) as fault:
            raise CommandError(f"the editor's page is not usable: {path}: {fault}") from fault

    @property
    def requests(self) -> List[str]:
        """All types of requests."""
        return list(self._data["requests"])

    @property
    def operations(self) -> List[str]:
        """All kinds of operations."""
        return list(self._data["operations"])

    @staticmethod
    def parse(text: str) -> Dict[str, Any]:
        """A client's text frame as an object with a `type`. Raises ProtocolFault."""
        try:
            message = json.loads(text, parse_constant=_refuse_constant)
        except (ValueError, RecursionError) as fault:
            raise ProtocolError(f"the message is not JSON: {fault}") from None
        if not isinstance(message, dict) or not isinstance(message.get("type"), str):
            raise ProtocolError("a message is an object with a text `type`")
        return message

    def check_message(self, message: Dict[str, Any]) -> None:
        """Raises ProtocolFault for a message of a client that the protocol does not know."""
        kind = message["type"]
        if kind in self._data["notices"]:
            self._fields(message, self._data["notices"][kind], kind, ("type", "id"))
        elif kind in self._data["requests"]:
            if not _is_number(message.get("id")):
                raise ProtocolError(f"{kind}: a request needs a number `id`")
            self._fields(message, self._data["requests"][kind]["fields"], kind, ("type", "id"))
        else:
            raise ProtocolError(f"there is no request {kind!r}")

    def check_operation(self, op: Any) -> str:
        """The kind of an operation whose fields are right. Raises ProtocolFault."""
        if not isinstance(op, dict) or not isinstance(op.get("kind"), str):
            raise ProtocolError("an operation is an object with a text `kind`")
        fields = self._data["operations"].get(op["kind"])
        if fields is None:
            raise ProtocolError(f"there is no operation {op['kind']!r}")
        self._fields(op, fields, op["kind"], ("kind",))
        return str(op["kind"])

    def check_reply(self, kind: str, value: Any) -> None:
        """Raises ProtocolFault for an answer that the protocol does not promise."""
        expected = self._data["requests"][kind]["reply"]
        if isinstance(expected, dict):
            self._fields(value, expected, f"reply to {kind}", ())
        else:
            self._check(value, expected, f"reply to {kind}", 0)

    def check_push(self, message: Dict[str, Any]) -> None:
        """Raises ProtocolFault for a server's message that the protocol does not know."""
        fields = self._data["pushes"].get(message.get("type", ""))
        if fields is None:
            raise ProtocolError(f"there is no push {message.get('type')!r}")
        self._fields(message, fields, str(message["type"]), ("type",))

    def _fields(self, value: Any, fields: Dict[str, str], where: str, more: Tuple[str, ...],
                depth: int = 0) -> None:
        if not isinstance(value, dict):
            raise ProtocolError(f"{where}: expected an object")
        for name in value:
            if name not in fields and name not in more:
                raise ProtocolError(f"{where}: there is no field {name!r}; there are "
                                    + (", ".join(fields) or "none"))
        for name, expected in fields.items():
            found = value.get(name)
            if found is None:
                if not expected.endswith("?") and expected != "any":
                    raise ProtocolError(f"{where}: the field {name!r} is missing")
                continue
            self._check(found, expected, f"{where}.{name}", depth + 1)

    def _check(self, value: Any, expected: str, where: str, depth: int) -> None:
        if depth > _DEEPEST:
            raise ProtocolError(f"{where}: nested too deeply")
        if expected.endswith("?"):
            if value is not None:
                self._check(value, expected[:-1], where, depth)
            return
        several = _LIST.match(expected)
        if several:
            self._list(value, several.group(1), several.group(2), where, depth)
        elif expected.startswith("{"):
            if not isinstance(value, dict):
                raise ProtocolError(f"{where}: expected an object")
            for name, item in value.items():
                self._check(item, expected[1:-1], f"{where}.{name}", depth + 1)
        elif expected.startswith("'"):
            if value not in expected.replace("'", "").split("|"):
                raise ProtocolError(f"{where}: expected {expected}, found {value!r:.60}")
        elif expected in _PLAIN:
            test, words = _PLAIN[expected]
            if not test(value):
                raise ProtocolError(f"{where}: expected {words}, found {value!r:.60}")
        else:
            self._named(value, expected, where, depth)

    def _named(self, value: Any, name: str, where: str, depth: int) -> None:
        meaning = self._types[name]
        if isinstance(meaning, str):
            self._check(value, meaning, where, depth + 1)
        else:
            self._fields(value, meaning, where, (), depth + 1)

    def _list(self, value: Any, item: str, length: str, where: str, depth: int) -> None:
        if not isinstance(value, (list, tuple)) or (length and len(value) != int(length)):
            raise ProtocolError(f"{where}: expected a list" + (f" of {length}" if length else "")
                                + f", found {value!r:.60}")
        for n, one in enumerate(value):
            self._check(one, item, f"{where}[{n}]", depth + 1)


def _refuse_constant(name: str) -> Optional[float]:
    raise ValueError(f"{name} is no number")
