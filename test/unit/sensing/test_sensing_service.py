"""What the child keeps of changes that no request has looked at."""
from __future__ import annotations

import weakref

from my_simulations.description.model import Link, Model
from my_simulations.sensing.api import AddBody, Body, RemoveBody
from my_simulations.sensing.service import Service


class Wire:
    """Of changes that arrive one after the other; then the parent hangs up."""

    def __init__(self, changes):
        self._changes = changes

    def receive(self, timeout):
        for change in self._changes:
            return [(0, change)]
        raise EOFError

    def send(self, message):
        pass


def test_models_that_have_gone_are_not_kept_for_a_first_request():
    gone = []

    def changes():
        for n in range(3):
            body = Body("box", Model("box", links=[Link("link")]), n)
            gone.append(weakref.ref(body))
            yield AddBody(body)
            del body
            yield RemoveBody("box")
        yield AddBody(Body("last", Model("last", links=[Link("link")]), 0))

    service = Service(Wire(changes()))
    service.run()
    assert len(gone) == 3 and not any(one() for one in gone)
    assert all(list(viewer._world.bodies) == ["last"]
               for viewer in (service._rays, service._camera))
