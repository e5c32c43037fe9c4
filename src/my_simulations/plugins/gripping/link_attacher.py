"""libgazebo_ros_link_attacher.so: a plugin of a world whose services join links of models.

Services and behaviour are those of gazebo_ros_link_attacher; the type of the services comes from
that package.
"""
from __future__ import annotations

from typing import Any

from ..base import Plugin
from ..context import PluginError

_KIND = "gazebo_ros_link_attacher/Attach"


class LinkAttacher(Plugin):
    """`/link_attacher_node/attach` and `/link_attacher_node/detach`."""

    def load(self) -> None:
        self.context.serve("/link_attacher_node/attach", _KIND, self._attach)
        self.context.serve("/link_attacher_node/detach", _KIND, self._detach)

    def _attach(self, request: Any, response: Any) -> None:
        response.ok = False
        try:
            self.context.attach(_name(request), f"{request.model_name_1}::{request.link_name_1}",
                                f"{request.model_name_2}::{request.link_name_2}")
            response.ok = True
        except PluginError as fault:
            self.context.warn(f"cannot attach: {fault}")

    def _detach(self, request: Any, response: Any) -> None:
        response.ok = self.context.detach(_name(request))
        if not response.ok:
            self.context.warn(f"cannot detach: {_name(request)} are not attached")


def _name(request: Any) -> str:
    return (f"{request.model_name_1}::{request.link_name_1} and "
            f"{request.model_name_2}::{request.link_name_2}")
