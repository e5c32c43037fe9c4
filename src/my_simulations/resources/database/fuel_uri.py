"""Fuel URIs of models and their files.

`https://HOST/1.0/OWNER/models/NAME`, with `/VERSION` (a number or `tip`) and, for a file of the
model, `/files/PATH` appended. The API version may be missing; owner and name ignore letter case,
and a space may be written `%20`. Source: Ignition Fuel Tools 4, which Gazebo 11 uses.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import Optional, Tuple
from urllib.parse import quote, unquote

KNOWN_HOSTS: Tuple[str, ...] = ("fuel.gazebosim.org", "fuel.ignitionrobotics.org")
"""Two names of one server, whose caches are equivalent."""

API = "1.0"

_ADDRESS = re.compile(
    r"(https?)://([^/\s]+)/+(?:(\d+\.\d+)/+)?([^/]+)/+models/+([^/]+?)"
    r"(?:/+(\d{1,9}|tip))?(?:/+files(?:/+(.*))?)?/*\Z")
_NAME = re.compile(r"[^\W_][\w .+()'&,-]{0,200}\Z")


@dataclass(frozen=True)
class FuelUri:
    """A model on a Fuel server, or a file of it.

    Attributes:
        server: scheme and host, with the port if given.
        owner: publisher of the model.
        name: name of the model.
        version: version; 0 for the newest.
        inside: path of a file in the model's folder; "" for the model itself.
    """

    server: str
    owner: str
    name: str
    version: int = 0
    inside: str = ""

    @property
    def host(self) -> str:
        """Name of the server's folder in a cache."""
        return self.server.partition("://")[2]

    @property
    def model(self) -> str:
        """The address of the model without a version."""
        return f"{self.server}/{API}/{quote(self.owner)}/models/{quote(self.name)}"

    @property
    def archive(self) -> str:
        """The address of its zip file."""
        return f"{self.model}/{self.version or 'tip'}/{quote(self.name)}.zip"


def is_web_address(uri: str) -> bool:
    return uri.lower().startswith(("http://", "https://"))


def fuel_uri(uri: str) -> Optional[FuelUri]:
    """Parse the URI of a Fuel server; None for other URIs."""
    found = _ADDRESS.match(uri.strip())
    if found is None:
        return None
    scheme, host, _, owner, name, version, inside = found.groups()
    owner, name, inside = unquote(owner), unquote(name), unquote(inside or "")
    parts = [part for part in inside.split("/") if part not in ("", ".")]
    if not _NAME.match(owner) or not _NAME.match(name) or "\0" in inside or ".." in parts:
        return None
    number = int(version) if version and version != "tip" else 0
    return FuelUri(f"{scheme}://{host.lower()}", owner, name, number, os.path.join("", *parts))
