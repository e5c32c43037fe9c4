"""The model library: models in folders and Fuel caches of this machine, and in the database."""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import threading
from dataclasses import dataclass
from html import unescape
from typing import Any, Callable, Dict, List, Optional, Tuple

from ...errors import CommandError
from ...resources.database.fuel import FuelModels
from ...resources.database.fuel_uri import fuel_uri, is_web_address
from ...resources.database.model_database import ModelDatabase
from ...resources.model_provider import ModelNotProvidedError
from ...resources.package_files import own_directory
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...simulator.safe_file import write_atomically
from ..scene.served_files import ServedFiles

_DOWNLOAD_S = 300.0
_CONFIGS = ("model.config", "manifest.xml")
_DESCRIPTIONS = ("model.sdf", "model.urdf")
_LARGEST_CONFIG = 1 << 16
_FORBIDDEN = ("/proc", "/sys", "/dev", "/etc", "/boot")
_REMOTE = "remote"
_FUEL = "fuel"
_LOOK = 2  # of the pictures that the page draws: a new number makes it draw them again

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class _Place:
    known: str
    title: str
    kind: str
    path: str


class Library:
    """Locations and their models. Safe from any thread.

    Args:
        resolver: learns of added folders.
        served: serves the models' own pictures.
        config_dir: keeps which folders were added.
        progress: hears of downloads: name, bytes that have come, bytes expected (0: unknown).
    """

    def __init__(self, resolver: Resolver, served: ServedFiles, config_dir: str,
                 progress: Optional[Progress] = None) -> None:
        self._resolver = resolver
        self._served = served
        self._file = os.path.join(config_dir, "library.json")
        self._lock = threading.RLock()
        self._fetching = threading.Lock()
        self._models: Dict[Tuple[str, float], Dict[str, Any]] = {}
        self._added = self._read_added()
        self._database = ModelDatabase.from_environment(progress)
        if self._database is not None:
            self._database.set_seconds(_DOWNLOAD_S)
        self._fuel = FuelModels.from_environment(progress)
        self._fuel.set_seconds(_DOWNLOAD_S)
        self._remote: Optional[List[str]] = None
        self._remote_problem = "the list of the database is being fetched"
        for folder in self._added:
            resolver.add_model_folder(folder)

    # -- what there is ---------------------------------------------------------------------------

    def locations(self) -> List[Dict[str, Any]]:
        """All locations with their models, as the protocol's `Location`s."""
        found = [{"id": place.known, "title": place.title, "kind": place.kind,
                  "path": place.path, "models": self._list_models(place.path), "problem": None}
                 for place in self._places()]
        found += self._fuel_locations()
        if self._database is not None:
            found.append(self._remote_location(self._database.uri))
        return found

    def signature(self) -> Any:
        """Something that differs when `locations` would; cheap."""
        with self._lock:
            remote = (self._remote is not None, self._remote_problem)
        return (remote, [(place.path, _entries(place.path)) for place in self._places()],
                [(model.folder, _read_change_time(model.folder)) for model in self._fuel.models()])

    def fetch_list(self) -> None:
        """Ask the remote database, if there is one, for its list. Blocks."""
        database = self._database
        if database is None or not self._fetching.acquire(blocking=False):
            return
        try:
            database.begin()
            names: Optional[List[str]] = sorted(database.names(), key=str.lower)
            problem = ""
        except ModelNotProvidedError as fault:
            names, problem = None, str(fault)
        finally:
            self._fetching.release()
        with self._lock:
            self._remote, self._remote_problem = names, problem

    def provide(self, uri: str) -> None:
        """Download a model that the database or Fuel has and this machine has not. Blocks.

        Raises CommandError.
        """
        if is_web_address(uri):
            self._provide_fuel(uri)
            return
        name = uri[len("model://"):].split("/")[0] if uri.startswith("model://") else ""
        if self._database is None or not name or self._is_here(name):
            return
        try:
            self._database.begin()
            self._database.provide(name)
        except ModelNotProvidedError as fault:
            raise CommandError(str(fault)) from fault

    def _provide_fuel(self, uri: str) -> None:
        known = fuel_uri(uri)
        if known is None:
            raise CommandError(f"{uri!r} is no address of a model on a Fuel server")
        try:
            self._fuel.begin()
            self._fuel.path(known)
        except ModelNotProvidedError as fault:
            raise CommandError(str(fault)) from fault

    @property
    def added(self) -> List[str]:
        with self._lock:
            return list(self._added)

    # -- folders ---------------------------------------------------------------------------------

    def add(self, path: str) -> None:
        """One more folder of models, kept for later sessions. Raises CommandError."""
        wanted = os.path.expanduser(path.strip())
        folder = os.path.realpath(wanted.replace("\0", ""))
        if "\0" in path or not os.path.isabs(wanted) or not os.path.isdir(folder):
            raise CommandError(f"folder {path!r} does not exist")
        if folder == os.sep or any(folder == one or folder.startswith(one + os.sep)
                                   for one in _FORBIDDEN):
            raise CommandError(f"{folder} contains no models")
        with self._lock:
            if folder not in self._added:
                self._added.append(folder)
                self._write_added()
        self._resolver.add_model_folder(folder)

    def remove(self, path: str) -> None:
        """Forget an added folder; models already found there stay known till the end."""
        with self._lock:
            if path not in self._added:
                raise CommandError(f"{path!r} is not an added path")
            self._added.remove(path)
            self._write_added()

    def _read_added(self) -> List[str]:
        try:
            with open(self._file, encoding="utf-8") as stream:
                found = json.load(stream)["folders"]
            return [folder for folder in found if isinstance(folder, str) and os.path.isabs(folder)]
        except (OSError, ValueError, KeyError, TypeError):
            return []

    def _write_added(self) -> None:
        data = json.dumps({"folders": self._added}, indent=1).encode()
        write_atomically(self._file, data, overwrite=True)

    def _places(self) -> List[_Place]:
        own = own_directory()
        home = os.path.expanduser("~/.gazebo/models")
        named = [("built-in", "Built-in", os.path.join(own, "models") if own else ""),
                 ("home", "~/.gazebo/models", home)]
        variable = os.environ.get("GAZEBO_MODEL_PATH", "").split(os.pathsep)
        named += [("environment", entry, entry) for entry in variable if entry]
        with self._lock:
            named += [("added", entry, entry) for entry in self._added]
        found: List[_Place] = []
        seen = set()
        for kind, title, path in named:
            real = os.path.realpath(path) if path else ""
            if real and real not in seen and (os.path.isdir(real) or kind == "home"):
                seen.add(real)
                known = hashlib.sha256(real.encode()).hexdigest()[:10]
                found.append(_Place(known, title, kind, path))
        return found

    # -- models ----------------------------------------------------------------------------------

    def _list_models(self, folder: str) -> List[Dict[str, Any]]:
        models = [self._model_entry(folder, name, changed) for name, changed in _entries(folder)]
        return sorted(models, key=lambda model: str(model["title"]).lower())

    def _fuel_locations(self) -> List[Dict[str, Any]]:
        """The Fuel caches as one location, which is there where they hold a model."""
        models = [self._model_entry(model.folder, "", _read_change_time(model.folder), model.uri)
                  for model in self._fuel.models()]
        if not models:
            return []
        return [{"id": _FUEL, "title": "Fuel", "kind": _FUEL, "path": self._fuel.caches[0],
                 "models": sorted(models, key=lambda model: str(model["title"]).lower()),
                 "problem": None}]

    def _model_entry(self, folder: str, name: str, changed: float, uri: str = "") -> Dict[str, Any]:
        path = os.path.join(folder, name) if name else folder
        with self._lock:
            known = self._models.get((path, changed))
        if known is None:
            known = self._read_model(path, name or uri.rpartition("/")[2], changed, uri)
            with self._lock:
                self._models[(path, changed)] = known
        return known

    def _read_model(self, path: str, name: str, changed: float, uri: str) -> Dict[str, Any]:
        text = ""
        for file in (os.path.join(path, config) for config in _CONFIGS):
            if os.path.isfile(file):   # a named pipe may have no writer
                with contextlib.suppress(OSError), open(file, encoding="utf-8",
                                                        errors="replace") as stream:
                    text = stream.read(_LARGEST_CONFIG)
                    break
        uri = uri or self._uri(path, name)
        return {"uri": uri, "name": name, "title": _element(text, "name") or name,
                "description": _element(text, "description"),
                "thumb": self._thumb(path, uri, changed)}

    def _uri(self, path: str, name: str) -> str:
        try:
            if os.path.realpath(self._resolver.resolve(f"model://{name}")) == os.path.realpath(
                    path):
                return f"model://{name}"
        except ResourceNotFoundError:
            pass  # the path will do
        return "file://" + path  # another folder may have a model of that name

    def _thumb(self, path: str, uri: str, changed: float) -> str:
        folder = os.path.join(path, "thumbnails")
        try:
            pictures = sorted(name for name in os.listdir(folder)
                              if name.lower().endswith((".png", ".jpg", ".jpeg")))
        except OSError:
            pictures = []
        url = self._served.url(os.path.join(folder, pictures[0])) if pictures else None
        known = hashlib.sha256(f"{_LOOK}|{uri}|{path}|{changed}".encode()).hexdigest()[:32]
        return url or f"/thumb/{known}.png"

    def _remote_location(self, uri: str) -> Dict[str, Any]:
        with self._lock:
            names, problem = self._remote, self._remote_problem
        models = [{"uri": f"model://{name}", "name": name, "title": name.replace("_", " "),
                   "description": "",
                   "thumb": f"/thumb/{hashlib.sha256((uri + name).encode()).hexdigest()[:32]}.png"}
                  for name in names or ()]
        return {"id": _REMOTE, "title": uri, "kind": _REMOTE, "path": uri, "models": models,
                "problem": problem or None}

    def _is_here(self, name: str) -> bool:
        return any(os.path.isdir(os.path.join(folder, name))
                   for folder in self._resolver.model_folders())


def _entries(folder: str) -> List[Tuple[str, float]]:
    """Names of the models in a folder, and when their config changed."""
    found: List[Tuple[str, float]] = []
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    for name in names:
        if name.startswith("."):
            continue
        changed = _read_change_time(os.path.join(folder, name))
        if changed:
            found.append((name, changed))
    return found


def _read_change_time(folder: str) -> float:
    """When the config of a model changed; 0 where the folder holds no model."""
    for config in (*_CONFIGS, *_DESCRIPTIONS):
        try:
            return os.stat(os.path.join(folder, config)).st_mtime
        except OSError:
            continue
    return 0.0


def _element(text: str, tag: str) -> str:
    """The text of the first element of that name, blanks made one."""
    match = re.search(rf"<{tag}\b[^>]*>(.*?)</{tag}>", text, re.DOTALL)
    if match is None:
        return ""
    inside = re.sub(r"<!\[CDATA\[(.*?)\]\]>", r"\1", match.group(1), flags=re.DOTALL)
    return " ".join(unescape(re.sub(r"<[^>]+>", "", inside)).split())[:500]
