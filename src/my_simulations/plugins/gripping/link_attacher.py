"""libgazebo_ros_link_attacher.so: a plugin of a world whose services join links of models.

Services and behaviour are those of gazebo_ros_link_attacher; the types of the services come from
that package. Copies of it have a service `setstatic`, which is offered if its type exists: it takes
gravity and collisions from a model, which then stays where it is. Here a fixed joint holds the
link in the world until a request with `set_static` false, and the model still collides.
"""
from __future__ import annotations

import contextlib
from typing import Any

from ..base import Plugin
from ..context import PluginError

_PACKAGE = "gazebo_ros_link_attacher"


class LinkAttacher(Plugin):
    """`attach`, `detach` and `setstatic` of `/link_attacher_node`."""

    def load(self) -> None:
        for name, call in (("attach", self._attach), ("detach", self._detach)):
            self.context.serve(f"/link_attacher_node/{name}", f"{_PACKAGE}/Attach", call)
        with contextlib.suppress(PluginError):   # the original package lacks this type
            self.context.serve("/link_attacher_node/setstatic", f"{_PACKAGE}/SetStatic",
                               self._set_static)

    def _attach(self, request: Any, response: Any) -> None:
        response.ok = False
        try:
            self.context.attach(_name(request), f"{request.model_name_1}::{request.link_name_1}",
                                f"{request.model_name_2}::{request.link_name_2}")
            response.ok = True
        except PluginError as fault:
            self.context.warn(f"cannot attach: {fault}")

    def _set_static(self, request: Any, response: Any) -> None:
        link = f"{request.model_name}::{request.link_name}"
        response.ok = False
        try:
            if request.set_static:
                self.context.attach(f"{link} and world", "world", link)
            else:
                self.context.detach(f"{link} and world")
            response.ok = True
        except PluginError as fault:
            self.context.warn(f"cannot set static: {fault}")

    def _detach(self, request: Any, response: Any) -> None:
        response.ok = self.context.detach(_name(request))
        if not response.ok:
            self.context.warn(f"cannot detach: {_name(request)} are not attached")


def _name(request: Any) -> str:
    return (f"{request.model_name_1}::{request.link_name_1} and "
            f"{request.model_name_2}::{request.link_name_2}")
