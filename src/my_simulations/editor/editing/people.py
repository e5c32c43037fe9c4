"""Who has the world open in a browser, what they hold, and whose edits are whose."""
from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, List

_LONGEST_NAME = 30
_MOST_SELECTED = 50


@dataclass
class Person:
    """A user of a page.

    Attributes:
        key: stays the same when the page is loaded again.
        name: told to the others.
        selected: what they have selected.
        held: what they drag.
    """

    key: str
    name: str
    selected: List[str] = field(default_factory=list)
    held: List[str] = field(default_factory=list)


class People:
    """By number of the client. Safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._here: Dict[int, Person] = {}
        self._names: Dict[str, str] = {}

    def join(self, client: int, key: str, name: str) -> None:
        """A page has greeted; without a name it gets one, or the one it had."""
        with self._lock:
            known = _tidy(name) or self._names.get(key, "")
            number = 1
            while not known or self._is_taken(known, key):
                known = f"Guest {number}"
                number += 1
            self._names[key] = known
            self._here[client] = Person(key, known)

    def leave(self, client: int) -> None:
        """A page has gone."""
        with self._lock:
            self._here.pop(client, None)

    def rename(self, client: int, name: str) -> None:
        """Rename a user; an invalid name, or that of another user, changes nothing."""
        with self._lock:
            person = self._here.get(client)
            name = _tidy(name)
            if person is None or not name or self._is_taken(name, person.key):
                return
            self._names[person.key] = name
            for one in self._here.values():
                if one.key == person.key:
                    one.name = name

    def select(self, client: int, names: List[str]) -> None:
        """Store the selection of a user."""
        with self._lock:
            if client in self._here:
                self._here[client].selected = names[:_MOST_SELECTED]

    def hold(self, held: Dict[int, List[str]]) -> bool:
        """Who drags what now, by number of the client; returns whether that is news."""
        with self._lock:
            changed = False
            for client, person in self._here.items():
                now = held.get(client, [])
                changed = changed or now != person.held
                person.held = now
            return changed

    def key_of(self, client: int) -> str:
        """The key under which this client's edits are recorded; "" for an unknown client."""
        with self._lock:
            return self._here[client].key if client in self._here else ""

    def name_of(self, client: int) -> str:
        """What the others call this client."""
        with self._lock:
            return self._here[client].name if client in self._here else "Somebody"

    def names(self, keys: Iterable[str]) -> List[str]:
        """Names of the authors of edits; "" for what no page did."""
        with self._lock:
            return [self._names.get(key, "") for key in keys]

    def clients_of(self, key: str) -> List[int]:
        """The clients of one author."""
        with self._lock:
            return [client for client, person in self._here.items() if person.key == key]

    def push(self) -> Dict[str, Any]:
        """The push `people`."""
        with self._lock:
            return {"type": "people", "people": [
                {"number": client, "name": person.name, "selected": person.selected,
                 "held": person.held} for client, person in sorted(self._here.items())]}

    def _is_taken(self, name: str, key: str) -> bool:
        return any(person.name == name and person.key != key for person in self._here.values()
                   ) or any(known == name and other != key for other, known in self._names.items())


def _tidy(name: str) -> str:
    """A name in one line, of a length that fits."""
    return " ".join(name.split())[:_LONGEST_NAME].strip()
