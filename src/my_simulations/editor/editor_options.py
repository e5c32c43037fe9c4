"""What the editor's server is told: where to listen, and which folders are its own."""
from __future__ import annotations

import ipaddress
import os
from dataclasses import dataclass, field
from typing import Callable, List, Optional, Sequence, Tuple

from ..errors import Issue
from ..plugins.plugin_state import PluginState
from ..resources.private_folder import user_folder
from .topic_source import TopicSource

DEFAULT_PORT = 11346
"""Beside Gazebo's master port, 11345."""


TOKEN_VARIABLE = "MY_SIMULATIONS_EDITOR_TOKEN"
"""Environment variable: the token, or `off` for none at addresses of this machine."""


def _ignore(_issue: Issue) -> None:
    """Discard an issue: no listener was given."""


@dataclass(frozen=True)
class EditorOptions:
    """Settings of one server.

    Attributes:
        host: address or name to listen at.
        port: to listen at; 0 takes a free one. If `DEFAULT_PORT` is in use, the next free one is
            taken.
        token: what every request must show; None for what the variable `TOKEN_VARIABLE` says, else
            a random one; "" for none, which holds for addresses of this machine only.
        save_roots: folders below which worlds are opened and saved; None for the usual ones.
        caller: folder in which the simulator's command was typed, among the usual ones; "" for the
            working directory.
        log: hears of issues that belong to no request.
        web: folder of the page; "" for the package's own.
        config_dir: keeps the folders a user added to the library.
        cache_dir: keeps autosaves and thumbnails.
        data_dir: keeps state logs.
        more_logs: state logs that lie elsewhere.
        topics: the ROS topics; None in a world without ROS.
        plugins: returns the states of the plugins of the world.
        read_only: accept no request that edits the world, its time or files.
        check_outgoing: hold what is sent to the protocol too (tests).
    """

    host: str = "127.0.0.1"
    port: int = DEFAULT_PORT
    token: Optional[str] = None
    save_roots: Optional[List[str]] = None
    caller: str = ""
    log: Callable[[Issue], None] = _ignore
    web: str = ""
    config_dir: str = field(default_factory=lambda: user_folder("XDG_CONFIG_HOME", "~/.config"))
    cache_dir: str = field(default_factory=lambda: cache_folder())
    data_dir: str = field(default_factory=lambda: os.path.expanduser("~/.gazebo/log"))
    more_logs: Tuple[str, ...] = ()
    topics: Optional[TopicSource] = None
    plugins: Callable[[], Sequence[PluginState]] = tuple
    read_only: bool = False
    check_outgoing: bool = False


def is_loopback(host: str) -> bool:
    """True for an address that only this machine can reach."""
    if host.strip().lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def cache_folder() -> str:
    """The folder for files of this user's editors that can be made again."""
    return user_folder("XDG_CACHE_HOME", "~/.cache")
