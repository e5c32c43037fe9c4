"""What several people at one world are told of each other's hands and edits."""
from __future__ import annotations

import contextlib
from typing import Iterator, List, Sequence, Tuple

from ...errors import Issue, Severity
from ..transport.hub import Hub
from .drags import Drags
from .history_labels import listed
from .people import People

CODE = "shared-edit"


class Company:
    """Sends notices to the users that they concern. Used in the thread of edits.

    Args:
        hub: reaches the pages.
        people: who they are.
        drags: who holds what.
    """

    def __init__(self, hub: Hub, people: People, drags: Drags) -> None:
        self._hub = hub
        self._people = people
        self._drags = drags

    def grasped(self, client: int, names: List[str]) -> None:
        """A client has taken hold of these; others may hold them already."""
        me = self._people.name_of(client)
        for other, shared in self._drags.others(client, names).items():
            they = self._people.name_of(other)
            self._tell([client], f"{they} is dragging {listed(shared)} too; the last release "
                                 "counts")
            self._tell([other], f"{me} is dragging {listed(shared)} too; the last release counts")
        self.tell_holds()

    def released(self, client: int, names: List[str]) -> None:
        """A client has released these; who still holds them hears of it."""
        me = self._people.name_of(client)
        for other, shared in self._drags.others(client, names).items():
            self._tell([other], f"{me} released {listed(shared)}, which you are dragging; your "
                                "release counts")
        self._drags.moved(client, names)
        self.tell_holds()

    def tell_holds(self, always: bool = False) -> None:
        """Who holds what, if it has changed."""
        if self._people.hold(self._drags.held()) or always:
            self._hub.push_soon(self._people.push())

    @contextlib.contextmanager
    def watching(self, client: int) -> Iterator[None]:
        """Notify users who drag a model that this client deletes, and the client itself."""
        yield
        me = self._people.name_of(client)
        for other, names in self._drags.gone().items():
            if other == client:
                continue
            verb = "were" if len(names) > 1 else "was"
            self._tell([other], f"{listed(names)}, which you were dragging, {verb} deleted by "
                                f"{me}")
            self._tell([client], f"{self._people.name_of(other)} was dragging {listed(names)}, "
                                 "which you deleted")
        self.tell_holds()

    def moved_in_history(self, client: int, verb: str,
                         steps: Sequence[Tuple[str, str]]) -> List[str]:
        """Names of the others whose steps (author, label) a client has undone or redone."""
        mine = self._people.key_of(client)
        me = self._people.name_of(client)
        done = {"undo": "undid", "redo": "redid"}[verb]
        keys = [key for key in dict.fromkeys(key for key, _ in steps) if key and key != mine]
        for key in keys:
            labels = [label for author, label in steps if author == key]
            self._tell(self._people.clients_of(key), f"{me} {done} your edit: {listed(labels)}")
        return self._people.names(keys)

    def tell_others(self, client: int, what: str) -> None:
        """All others hear what a client has done."""
        me = self._people.name_of(client)
        others = [number for number in self._hub.clients if number != client]
        self._tell(others, f"{me} {what}")

    def _tell(self, clients: Sequence[int], text: str) -> None:
        if clients:
            self._hub.tell_some(Issue(Severity.NOTE, CODE, text), clients)
