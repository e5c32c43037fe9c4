"""The messages between page and server: `web/protocol.json`, and checks against it."""
from __future__ import annotations

import json
import os
import re
from typing import Any, Callable, Dict, FrozenSet, Iterable, List, Optional, Tuple

from ...errors import CommandError
from ...geometry import is_finite_number
from ...xml_characters import check_tree

OPERATION = "Operation"
"""The type of an operation: an object whose `kind` names an entry of `operations`."""

_LIST = re.compile(r"(.*)\[(\d*)\]\Z", re.DOTALL)
_SOME = "some "
_SUSPICIOUS = re.compile(r"\\u(00[01]|d[89a-f]|fff[ef])|[\ud800-\udfff\ufffe\uffff]", re.IGNORECASE)
"""In JSON text: what may be a character that XML cannot hold. Others need no second look."""
_DEEPEST = 32
_LARGEST_INTEGER = 2 ** 53
"""Larger ones a page cannot tell apart (JavaScript)."""

Test = Callable[[Any], bool]


class ProtocolError(CommandError):
    """A message that does not follow the protocol; the text names the field."""

    code = "protocol"


_PLAIN: Dict[str, Tuple[Test, str]] = {
    "string": (lambda value: isinstance(value, str), "a string"),
    "number": (is_finite_number, "a finite number"),
    "integer": (lambda value: isinstance(value, int) and not isinstance(value, bool)
                and abs(value) <= _LARGEST_INTEGER, "an integer"),
    "boolean": (lambda value: isinstance(value, bool), "true or false"),
    "object": (lambda value: isinstance(value, dict), "an object"),
    "any": (lambda value: True, "anything"),
}


class TypeChecker:
    """Compares JSON values with type expressions; how these are written: `about` in the file.

    Args:
        types: the named types.
        operations: fields of each kind of operation.
        unchecked: named types that are only tested for being objects, because the handler that
            reads them checks them and reports faults of its own.
    """

    def __init__(self, types: Dict[str, Any], operations: Dict[str, Dict[str, str]],
                 unchecked: Iterable[str] = ()) -> None:
        self._types = types
        self._operations = operations
        self._unchecked: FrozenSet[str] = frozenset(unchecked)

    def check(self, value: Any, expected: str, where: str, depth: int = 0) -> None:
        """Raises ProtocolError for a value that is not of a type; `where` names the value."""
        if depth > _DEEPEST:
            raise ProtocolError(f"{where}: nested too deeply")
        several = _LIST.match(expected)
        if expected.endswith("?"):
            if value is not None:
                self.check(value, expected[:-1], where, depth)
        elif several:
            self._list(value, several.group(1), several.group(2), where, depth)
        elif expected.startswith("{"):
            for name, item in self._object(value, where).items():
                self.check(item, expected[1:-1], f"{where}.{name}", depth + 1)
        elif expected.startswith("'") or expected in _PLAIN:
            _check_plain(value, expected, where)
        elif expected.startswith(_SOME):
            fields = self._types[expected[len(_SOME):]]
            self.fields(value, {name: f"{kind.rstrip('?')}?" for name, kind in fields.items()},
                        where, (), depth + 1)
        elif "|" in expected:
            self.check(value, self._alternative(value, expected.split("|")), where, depth)
        else:
            self._check_named(value, expected, where, depth)

    def fields(self, value: Any, fields: Dict[str, str], where: str, more: Tuple[str, ...] = (),
               depth: int = 0) -> None:
        """As `check`, for an object with these fields; `more`: others that are not looked at."""
        for name in self._object(value, where):
            if name not in fields and name not in more:
                raise ProtocolError(f"{where}: unknown field {name!r}; known fields: "
                                    + (", ".join(fields) or "none"))
        for name, expected in fields.items():
            found = value.get(name)
            if found is not None:
                self.check(found, expected, f"{where}.{name}", depth + 1)
            elif not expected.endswith("?") and expected != "any":
                raise ProtocolError(f"{where}: missing field {name!r}")

    def operation(self, op: Any, where: str, depth: int = 0) -> str:
        """The kind of an operation whose fields are right. Raises ProtocolError."""
        if not isinstance(op, dict) or not isinstance(op.get("kind"), str):
            raise ProtocolError(f"{where}: an operation is an object with a string `kind`")
        fields = self._operations.get(op["kind"])
        if fields is None:
            raise ProtocolError(f"{where}: unknown operation {op['kind']!r}")
        self.fields(op, fields, where, ("kind",), depth)
        return str(op["kind"])

    def _check_named(self, value: Any, name: str, where: str, depth: int) -> None:
        if name in self._unchecked:
            self._object(value, where)
        elif name == OPERATION:
            self.operation(value, where, depth + 1)
        elif isinstance(self._types[name], str):
            self.check(value, self._types[name], where, depth + 1)
        else:
            self.fields(value, self._types[name], where, (), depth + 1)

    def _alternative(self, value: Any, names: List[str]) -> str:
        """The type that the value's `type` tells, else the first of those without one."""
        for name in names:
            fields = self._types.get(name)
            literal = fields.get("type", "") if isinstance(fields, dict) else ""
            if literal.startswith("'") and isinstance(value, dict) and (
                    value.get("type") in _literals(literal)):
                return name
        return names[0]

    def _list(self, value: Any, item: str, length: str, where: str, depth: int) -> None:
        if not isinstance(value, (list, tuple)) or (length and len(value) != int(length)):
            raise ProtocolError(f"{where}: expected a list" + (f" of {length}" if length else "")
                                + f", found {value!r:.60}")
        for n, one in enumerate(value):
            self.check(one, item, f"{where}[{n}]", depth + 1)

    @staticmethod
    def _object(value: Any, where: str) -> Dict[str, Any]:
        if not isinstance(value, dict):
            raise ProtocolError(f"{where}: expected an object, found {value!r:.60}")
        return value


class Protocol:
    """The messages of one protocol file.

    Attributes:
        version: grows when page and server of different versions no longer understand each other.
        limits: sizes in bytes, rates in Hz.
        types: checks everything; messages of clients are checked without the types that handlers
            read by themselves.
    """

    def __init__(self, text: str) -> None:
        self._data = json.loads(text)
        self.version: int = self._data["version"]
        self.limits: Dict[str, int] = self._data["limits"]
        named, operations = self._data["types"], self._data["operations"]
        self.types = TypeChecker(named, operations)
        self._incoming = TypeChecker(named, operations, self._data["checked_by_handler"])

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
        return list(self._data["requests"])

    @property
    def notices(self) -> List[str]:
        return list(self._data["notices"])

    @property
    def operations(self) -> List[str]:
        return list(self._data["operations"])

    @staticmethod
    def parse(text: str) -> Dict[str, Any]:
        """A client's text frame as an object with a `type`. Raises ProtocolError."""
        try:
            message = json.loads(text, parse_constant=_refuse_constant)
        except (ValueError, RecursionError) as fault:
            raise ProtocolError(f"the message is not JSON: {fault}") from None
        if not isinstance(message, dict) or not isinstance(message.get("type"), str):
            raise ProtocolError("a message is an object with a string `type`")
        return message

    @staticmethod
    def check_texts(message: Dict[str, Any], text: str) -> None:
        """Raises ProtocolError where a message holds what no world file could, wherever it stands.

        `text` is the frame that `message` was parsed from.
        """
        if not _SUSPICIOUS.search(text):
            return
        kind = message["type"]
        try:
            check_tree(message, kind if kind.isidentifier() else "the message")
        except CommandError as fault:
            raise ProtocolError(str(fault)) from None

    def check_message(self, message: Dict[str, Any]) -> None:
        """Raises ProtocolError for a message of a client that does not follow the protocol."""
        kind = message["type"]
        fields = self._data["notices"].get(kind)
        if fields is None:
            if kind not in self._data["requests"]:
                raise ProtocolError(f"unknown request {kind!r}")
            if not is_finite_number(message.get("id")):
                raise ProtocolError(f"{kind}: a request needs a number `id`")
            fields = self._data["requests"][kind]["fields"]
        self._incoming.fields(message, fields, kind, ("type", "id"))

    def check_operation(self, op: Any) -> str:
        """The kind of an operation whose fields are right. Raises ProtocolError.

        The operations of a group are checked one by one, when it is their turn.
        """
        kind = op.get("kind") if isinstance(op, dict) else None
        return self._incoming.operation(op, kind if isinstance(kind, str) else "operation")

    def check_reply(self, kind: str, value: Any) -> None:
        """Raises ProtocolError for an answer that the protocol does not promise."""
        if kind in self._data["notices"]:
            return  # one with a number is answered, with nothing
        expected = self._data["requests"][kind]["reply"]
        if isinstance(expected, dict):
            self.types.fields(value, expected, f"reply to {kind}")
        else:
            self.types.check(value, expected, f"reply to {kind}")

    def check_push(self, message: Dict[str, Any]) -> None:
        """Raises ProtocolError for a message of the server that does not follow the protocol."""
        fields = self._data["pushes"].get(message.get("type", ""))
        if fields is None:
            raise ProtocolError(f"unknown push {message.get('type')!r}")
        self.types.fields(message, fields, str(message["type"]), ("type",))


def _check_plain(value: Any, expected: str, where: str) -> None:
    if expected in _PLAIN:
        test, words = _PLAIN[expected]
        fits = test(value)
    else:
        words, fits = expected, value in _literals(expected)
    if not fits:
        raise ProtocolError(f"{where}: expected {words}, found {value!r:.60}")


def _literals(expected: str) -> List[str]:
    return expected.replace("'", "").split("|")


def _refuse_constant(name: str) -> Optional[float]:
    raise ValueError(f"{name} is not a number that JSON knows")
