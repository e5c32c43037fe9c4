"""Who has the world open in a browser, what they hold, and whose edits are whose."""
from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, List

_LONGEST_NAME = 30
_MOST_SELECTED = 50


@dataclass
class User:
    """A user of a page.

    Attributes:
        key: stays the same when the page is loaded again.
        name: shown to other users.
        selected: what they have selected.
        dragged: what they drag.
    """

    key: str
    name: str
    selected: List[str] = field(default_factory=list)
    dragged: List[str] = field(default_factory=list)


class Users:
    """The connected users, by number of the client. Safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._connected: Dict[int, User] = {}
        self._names: Dict[str, str] = {}

    def join(self, client: int, key: str, name: str) -> None:
        """A page has greeted; without a name it gets one, or the one it had."""
        with self._lock:
            known = _clean_name(name) or self._names.get(key, "")
            number = 1
            while not known or self._is_taken(known, key):
                known = f"Guest {number}"
                number += 1
            self._names[key] = known
            self._connected[client] = User(key, known)

    def leave(self, client: int) -> None:
        with self._lock:
            self._connected.pop(client, None)

    def rename(self, client: int, name: str) -> None:
        """Rename a user; an invalid name, or that of another user, changes nothing."""
        with self._lock:
            person = self._connected.get(client)
            name = _clean_name(name)
            if person is None or not name or self._is_taken(name, person.key):
                return
            self._names[person.key] = name
            for one in self._connected.values():
                if one.key == person.key:
                    one.name = name

    def select(self, client: int, names: List[str]) -> None:
        """Store the selection of a user."""
        with self._lock:
            if client in self._connected:
                self._connected[client].selected = names[:_MOST_SELECTED]

    def set_dragged(self, dragged: Dict[int, List[str]]) -> bool:
        """Store who drags what, by number of the client; returns whether it has changed."""
        with self._lock:
            changed = False
            for client, person in self._connected.items():
                now = dragged.get(client, [])
                changed = changed or now != person.dragged
                person.dragged = now
            return changed

    def key_of(self, client: int) -> str:
        """The key under which this client's edits are recorded; "" for an unknown client."""
        with self._lock:
            return self._connected[client].key if client in self._connected else ""

    def name_of(self, client: int) -> str:
        """What the others call this client."""
        with self._lock:
            return self._connected[client].name if client in self._connected else "Another user"

    def names(self, keys: Iterable[str]) -> List[str]:
        """Names of the authors of edits; "" for what no page did."""
        with self._lock:
            return [self._names.get(key, "") for key in keys]

    def clients_of(self, key: str) -> List[int]:
        with self._lock:
            return [client for client, person in self._connected.items() if person.key == key]

    def push(self) -> Dict[str, Any]:
        with self._lock:
            return {"type": "people", "people": [
                {"number": client, "name": person.name, "selected": person.selected,
                 "held": person.dragged} for client, person in sorted(self._connected.items())]}

    def _is_taken(self, name: str, key: str) -> bool:
        return any(person.name == name and person.key != key for person in self._connected.values()
                   ) or any(known == name and other != key for other, known in self._names.items())


def _clean_name(name: str) -> str:
    """A name in one line, of a length that fits."""
    return " ".join(name.split())[:_LONGEST_NAME].strip()
