"""Models of Fuel servers: the caches of Gazebo's tools, and downloads into them.

A model is in `CACHE/HOST/OWNER/models/NAME/VERSION/`. Caches are `~/.ignition/fuel` (or
IGN_FUEL_CACHE_PATH) and `~/.gz/fuel` (GZ_FUEL_CACHE_PATH). Only known servers, and those in
`config.yaml` of a cache, are contacted. Source: Ignition Fuel Tools 4.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Dict, List, Optional, Sequence
from urllib.parse import quote

from ..model_provider import ModelNotProvidedError, Progress
from .fuel_uri import API, KNOWN_HOSTS, FuelUri

if TYPE_CHECKING:
    from email.message import Message

_SERVER = re.compile(r"^\s*(?:-\s*)?url:\s*[\"']?(https?://[^\s\"'/]+)/*[\"']?\s*(?:#.*)?$",
                     re.MULTILINE)
_URI = re.compile(rb"(<(?:uri|filename|\w+_map)>\s*)model://[^/<]+/([^<]*[^<\s])")
_INCLUDE = re.compile(rb"(<include\b.*?</include>)", re.DOTALL)  # may refer to other models
_LARGEST_CONFIG = 1 << 16
_CONFIG = "model.config"


@dataclass(frozen=True)
class CachedModel:
    """The newest version of a model in a cache.

    Attributes:
        uri: its address without a version.
        name: name of its folder.
        folder: path of its folder.
    """

    uri: str
    name: str
    folder: str


class FuelModels:
    """Finds models in the caches, and downloads what no cache holds.

    Args:
        caches: cache folders, in search order; downloads are stored in the first.
        servers: scheme and host of the servers that may be contacted.
        progress: called with the progress of a download.
        seconds: total wall time for all downloads of a world, from the first one on; None for that
            of the model database.
    """

    def __init__(self, caches: Sequence[str], servers: Sequence[str],
                 progress: Optional[Progress] = None, seconds: Optional[float] = None) -> None:
        self.caches = list(caches)
        self._servers = [server.lower() for server in servers]
        self._progress = progress
        self._seconds = seconds
        self._time: Optional[_Downloads] = None

    @classmethod
    def from_environment(cls, progress: Optional[Progress] = None) -> "FuelModels":
        """The user's caches, the known servers, and those of the caches' `config.yaml`."""
        named = [os.environ.get("IGN_FUEL_CACHE_PATH") or "~/.ignition/fuel",
                 os.environ.get("GZ_FUEL_CACHE_PATH") or "~/.gz/fuel"]
        caches = [os.path.expanduser(cache) for cache in dict.fromkeys(named)]
        servers = [f"https://{host}" for host in KNOWN_HOSTS]
        for cache in caches:
            servers += _read_configured_servers(os.path.join(cache, "config.yaml"))
        return cls(caches, servers, progress)

    def begin(self) -> None:
        """Start reading a new document: failed downloads may be tried again."""
        if self._time is not None:
            self._time.begin()

    def set_seconds(self, seconds: float) -> None:
        """Set the total time of downloads (s) from the next `begin` on."""
        self._seconds = seconds
        if self._time is not None:
            self._time.set_seconds(seconds)

    def folders(self) -> List[str]:
        return [cache for cache in self.caches if os.path.isdir(cache)]

    def path(self, uri: FuelUri) -> str:
        """The folder of a model, or a file in it; downloads the model if no cache has it.

        Raises ModelNotProvidedError: the model cannot be downloaded now, or has no such file.
        """
        folder = self.cached(uri) or self._download(uri)
        path = os.path.join(folder, uri.inside) if uri.inside else folder
        if not os.path.exists(path):
            raise ModelNotProvidedError(f"{path} does not exist")
        return path

    def cached(self, uri: FuelUri) -> Optional[str]:
        """The folder of a model in a cache; None if no cache has it (in that version)."""
        hosts = [uri.host, *(host for host in KNOWN_HOSTS if uri.host in KNOWN_HOSTS)]
        for cache in self.caches:
            for host in dict.fromkeys(hosts):
                model = _child(os.path.join(cache, host), uri.owner, "models", uri.name)
                found = _version(model, uri.version) if model else None
                if found:
                    return found
        return None

    def beside(self, base_dir: str, rest: str) -> List[str]:
        """Candidate path of `model://NAME/…` in a file of a cached model: in that model itself.

        Gazebo's tools rewrite such URIs when they unpack a model, whatever the name; caches that
        were filled by other means contain the original ones.
        """
        for cache in self.caches:
            inside = os.path.relpath(base_dir, cache).split(os.sep) if base_dir else []
            if len(inside) >= 5 and inside[0] != os.pardir and inside[2] == "models":
                tail = rest.partition("/")[2]
                return [os.path.join(cache, *inside[:5], tail)] if tail else []
        return []

    def models(self) -> List[CachedModel]:
        """The models in the caches, each once, in its newest version."""
        found: Dict[str, CachedModel] = {}
        for cache in self.caches:
            for host in _folders(cache):
                for owner in _folders(os.path.join(cache, host)):
                    above = os.path.join(cache, host, owner, "models")
                    for name in _folders(above):
                        folder = _version(os.path.join(above, name), 0)
                        uri = FuelUri(self._server(host), owner, name).model
                        if folder and uri not in found:
                            found[uri] = CachedModel(uri, name, folder)
        return list(found.values())

    def _server(self, host: str) -> str:
        """Scheme and host of a cache's folder."""
        return next((one for one in self._servers if one.partition("://")[2] == host),
                    f"https://{host}")

    def _download(self, uri: FuelUri) -> str:
        if uri.server not in self._servers:
            raise ModelNotProvidedError(
                f"not found in the caches {', '.join(self.caches)}, and {uri.server} is not a"
                " configured server (add it to config.yaml of the cache)"
            )
        if self._time is None:
            self._time = _Downloads(self.caches[0], self._progress, self._seconds)
        self._time.download(uri)
        found = self.cached(uri)
        if found is None:
            raise ModelNotProvidedError(
                f"{uri.model} was downloaded, but is not in {self.caches[0]}"
            )
        return found


class _Downloads:
    """Downloads models; its modules are imported with the first download."""

    def __init__(self, cache: str, progress: Optional[Progress], seconds: Optional[float]) -> None:
        from .download_time import WORLD_SECONDS, DownloadTime

        self._cache = cache
        self._time = DownloadTime(progress, WORLD_SECONDS if seconds is None else seconds)
        self.begin, self.set_seconds = self._time.begin, self._time.set_seconds

    def download(self, uri: FuelUri) -> None:
        """Download a model into the cache. Raises ModelNotProvidedError."""
        self._time.once(uri.archive, uri.server, lambda: self._fetch(uri))

    def _fetch(self, uri: FuelUri) -> None:
        import tempfile

        from .archive import install, unpack
        from .http_download import fetch

        limits, until = self._time.limits, self._time.until()
        above = os.path.join(self._cache, uri.host, uri.owner.lower(), "models", uri.name.lower())
        os.makedirs(above, exist_ok=True)
        # Named by chance: threads may download one model at the same time.
        with tempfile.NamedTemporaryFile(dir=above, prefix=".", suffix=".zip") as stream:
            headers = fetch(uri.archive, stream, limits.archive_bytes, until,
                            self._time.report(uri.name))
            stream.flush()
            exact = replace(uri, version=uri.version or _version_of(headers))

            def make(work: str) -> str:
                return _with_own_addresses(
                    unpack("zip", stream.name, os.path.join(work, "unpacked"), "", limits, until),
                    exact)

            install(os.path.join(above, str(exact.version)), make)


def _version_of(headers: "Message[str, str]") -> int:
    """The version in the response headers; 1 if there is none (Gazebo behaviour)."""
    for name in ("X-Ign-Resource-Version", "X-Gz-Resource-Version"):
        text = headers.get(name) or ""
        if text.isdigit() and 0 < int(text) < 10 ** 9:
            return int(text)
    return 1


def _with_own_addresses(folder: str, uri: FuelUri) -> str:
    """Rewrite references to the model's own files as Fuel URIs, as Gazebo's tools do."""
    files = (f"{uri.server}/{API}/{quote(uri.owner)}/models/{quote(uri.name)}/{uri.version}"
             "/files/")

    def own(match: "re.Match[bytes]") -> bytes:
        inside = match.group(2).decode("utf-8", "replace")
        is_own = os.path.exists(os.path.join(folder, inside))
        return match.group(1) + (files + inside).encode() if is_own else match.group(0)

    for name in os.listdir(folder):
        path = os.path.join(folder, name)
        if not name.lower().endswith(".sdf") or not os.path.isfile(path):
            continue
        with open(path, "rb") as stream:
            pieces = _INCLUDE.split(stream.read())
        with open(path, "wb") as out:
            out.write(b"".join(piece if piece.startswith(b"<include") else _URI.sub(own, piece)
                               for piece in pieces))
    return folder


def _read_configured_servers(path: str) -> List[str]:
    """Scheme and host of the servers in a `config.yaml`."""
    try:
        with open(path, encoding="utf-8", errors="replace") as stream:
            return _SERVER.findall(stream.read(_LARGEST_CONFIG))
    except OSError:
        return []


def _child(folder: str, *names: str) -> Optional[str]:
    """A subfolder, ignoring the letter case of names; None if there is none."""
    for name in names:
        exact = os.path.join(folder, name.lower())
        if not os.path.isdir(exact):
            same = [one for one in _folders(folder) if one.lower() == name.lower()]
            if not same:
                return None
            exact = os.path.join(folder, same[0])
        folder = exact
    return folder


def _version(model: str, version: int) -> Optional[str]:
    """The folder of a version (0: the newest) with a model's config; None if there is none."""
    numbers = [int(name) for name in _folders(model) if name.isdigit()]
    for number in sorted(numbers, reverse=True):
        folder = os.path.join(model, str(number))
        if version in (0, number) and os.path.isfile(os.path.join(folder, _CONFIG)):
            return folder
    return None


def _folders(folder: str) -> List[str]:
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    return [name for name in names
            if not name.startswith(".") and os.path.isdir(os.path.join(folder, name))]
