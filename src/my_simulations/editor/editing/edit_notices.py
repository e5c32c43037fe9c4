"""Notices to the users of one world about drags and edits of other users."""
from __future__ import annotations

import contextlib
from typing import Iterator, List, Sequence, Tuple

from ...errors import Issue, Severity
from ..transport.hub import Hub
from .drags import Drags
from .history_labels import join_names
from .users import Users

CODE = "shared-edit"


class EditNotices:
    """Sends notices to the users that they concern. Used in the thread of edits.

    Args:
        hub: reaches the pages.
        users: their names.
        drags: who drags what.
    """

    def __init__(self, hub: Hub, people: Users, drags: Drags) -> None:
        self._hub = hub
        self._users = people
        self._drags = drags

    def drag_started(self, client: int, names: List[str]) -> None:
        """Notify users who drag the same entities, after a client has begun a drag."""
        me = self._users.name_of(client)
        for other, shared in self._drags.others(client, names).items():
            they = self._users.name_of(other)
            self._notify([client], f"{they} is dragging {join_names(shared)} too; the last release "
                         "counts")
            self._notify([other],
                         f"{me} is dragging {join_names(shared)} too; the last release counts")
        self.push_drags()

    def drag_ended(self, client: int, names: List[str]) -> None:
        """Notify users who still drag the same entities, after a client has released them."""
        me = self._users.name_of(client)
        for other, shared in self._drags.others(client, names).items():
            self._notify([other],
                         f"{me} released {join_names(shared)}, which you are dragging; "
                         "your release counts")
        self._drags.moved(client, names)
        self.push_drags()

    def push_drags(self, always: bool = False) -> None:
        """Push who drags what, if it has changed."""
        if self._users.set_dragged(self._drags.dragged()) or always:
            self._hub.push_soon(self._users.push())

    @contextlib.contextmanager
    def notify_of_deletions(self, client: int) -> Iterator[None]:
        """Notify users whose dragged models this client deletes in the block, and the client."""
        yield
        me = self._users.name_of(client)
        for other, names in self._drags.remove_deleted().items():
            if other == client:
                continue
            verb = "were" if len(names) > 1 else "was"
            self._notify([other],
                         f"{join_names(names)}, which you were dragging, {verb} deleted by {me}")
            self._notify([client],
                         f"{self._users.name_of(other)} was dragging {join_names(names)}, "
                         "which you deleted")
        self.push_drags()

    def notify_of_undo(self, client: int, verb: str,
                         steps: Sequence[Tuple[str, str]]) -> List[str]:
        """Names of the others whose steps (author, label) a client has undone or redone."""
        mine = self._users.key_of(client)
        me = self._users.name_of(client)
        done = {"undo": "undid", "redo": "redid"}[verb]
        keys = [key for key in dict.fromkeys(key for key, _ in steps) if key and key != mine]
        for key in keys:
            labels = [label for author, label in steps if author == key]
            self._notify(self._users.clients_of(key),
                         f"{me} {done} your edit: {join_names(labels)}")
        return self._users.names(keys)

    def notify_others(self, client: int, what: str) -> None:
        """Notify all other users of what a client has done."""
        me = self._users.name_of(client)
        others = [number for number in self._hub.clients if number != client]
        self._notify(others, f"{me} {what}")

    def _notify(self, clients: Sequence[int], text: str) -> None:
        if clients:
            self._hub.show_issue_to(Issue(Severity.NOTE, CODE, text), clients)
