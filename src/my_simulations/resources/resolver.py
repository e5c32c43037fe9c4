"""Resolves `model://`, `package://`, `file://`, Fuel URIs and plain paths to files.

The search order is Gazebo's. Look-up is lazy: the package path is crawled only if the first places
have no result. Only models that are not on this machine are downloaded: from the database in
GAZEBO_MODEL_DATABASE_URI, if set, and from a Fuel server if a file refers to it by its address.
"""
from __future__ import annotations

import copy
import os
import stat
from typing import Callable, Iterator, List, Optional, Protocol, Sequence, Tuple, Type, TypeVar

from ..errors import ResourceError
from .database.fuel_uri import FuelUri, fuel_uri, is_web_address
from .model_config import description_in
from .model_provider import DATABASE, ModelNotProvidedError, Progress
from .package_files import PACKAGE, package_directories
from .ros_packages import ExportedPaths, FindPackage, PackageIndex, package_name
from .suggestions import NO_PACKAGE, same_file_elsewhere, suggestion, unlisted_model_folder

Found = TypeVar("Found", bound="Resolver")

_MEDIA_SUFFIXES = ("", "models", "media/models", "Media/models")
_HOME_MODELS = "/.gazebo/models/"
_MOST_PLACES = 3
"""Most searched places in a message; `ResourceNotFoundError.tried` has all."""


class ResourceNotFoundError(ResourceError):
    """No file for a URI.

    Attributes:
        uri: the URI.
        tried: every place that was searched, in order.
        reason: why nothing was searched; "" otherwise.
    """

    def __init__(self, uri: str, tried: Sequence[str] = (), reason: str = "") -> None:
        self.uri = uri
        self.tried: List[str] = list(tried)
        self.reason = reason
        why = reason or _describe_search(uri, self.tried)
        super().__init__(f"{uri!r} was not found" + (f": {why}" if why else ""))


class MissingModels(Protocol):
    """Provides models that are not on this machine."""

    def begin(self) -> None:
        """Start reading a new document."""

    def provide(self, name: str) -> str:
        """The folder of a model. Raises ModelNotProvidedError."""


class WebModels(Protocol):
    """Models of Fuel servers, from caches or the network (see `database.fuel`)."""

    def begin(self) -> None:
        """Start reading a new document."""

    def path(self, uri: FuelUri) -> str:
        """The folder of a model, or a file in it. Raises ModelNotProvidedError."""

    def beside(self, base_dir: str, rest: str) -> List[str]:
        """Candidate path of `model://` + `rest` for a file in a cache."""

    def folders(self) -> List[str]:
        """The caches."""


class Resolver:
    """Finds files by URI.

    Args:
        model_paths: folders whose children are models (`model://child/...`), in search order.
        resource_paths: folders from which plain relative paths and `file://` start.
        find_package: returns the folder of a ROS package; called for `package://` only.
        exported: returns more of both lists; called once, if the first ones have no result.
        missing: provides models that are not on this machine; None for no downloads.
        packages: returns the folders of all ROS packages.
        fuel: models of Fuel servers; None for none.
        own: folders of the package my_simulations, in search order, if there are several.
    """

    def __init__(
        self,
        model_paths: Sequence[str] = (),
        resource_paths: Sequence[str] = (),
        find_package: FindPackage = lambda name: None,
        exported: Callable[[], ExportedPaths] = ExportedPaths,
        missing: Optional[MissingModels] = None,
        packages: Callable[[], List[str]] = list,
        fuel: Optional[WebModels] = None,
        own: Sequence[str] = (),
    ) -> None:
        self._model_paths = list(model_paths)
        self._resource_paths = list(resource_paths)
        self._find_package = find_package
        self._exported = exported
        self._missing = missing
        self._packages = packages
        self._fuel = fuel
        self._own = list(own)
        self._late: Optional[ExportedPaths] = None

    @classmethod
    def from_environment(cls: Type[Found], progress: Optional[Progress] = None) -> Found:
        """A resolver with Gazebo's variables, ~/.gazebo/models, our own models and ROS packages.

        Saved buildings are models, too (Gazebo behaviour). `progress` is called during downloads.
        """
        own = package_directories()
        models = [os.path.expanduser("~/.gazebo/models"), *_read_path_variable("GAZEBO_MODEL_PATH")]
        resources = _read_path_variable("GAZEBO_RESOURCE_PATH")
        for folder in own:
            models.append(os.path.join(folder, "models"))
            # `worlds/empty.world` and `empty.world` both name the world in our `world/` folder.
            resources += [os.path.join(folder, "world"), folder]
        buildings = os.path.expanduser("~/building_editor_models")
        if os.path.isdir(buildings):
            models.append(buildings)
        packages = PackageIndex()

        def find(name: str) -> Optional[str]:
            return own[0] if name == PACKAGE and own else packages.find(name)

        missing: Optional[MissingModels] = None
        if os.environ.get(DATABASE, "").strip():
            from .database.model_database import ModelDatabase

            missing = ModelDatabase.from_environment(progress)
        from .database.fuel import FuelModels

        return cls(models, resources, find, packages.exported, missing,
                   lambda: packages.folders() + own, FuelModels.from_environment(progress), own)

    def model_folders(self) -> List[str]:
        """Folders whose children are models, in search order, as far as searched until now."""
        return self._model_paths + (self._late.models if self._late else [])

    def resource_folders(self) -> List[str]:
        """Folders from which relative paths start, as far as searched until now."""
        return self._resource_paths + (self._late.media if self._late else [])

    def media_folders(self) -> List[str]:
        """All resource folders, those that ROS packages export included."""
        return list(self._all("media"))

    def fuel_folders(self) -> List[str]:
        """The existing caches of Fuel models."""
        return self._fuel.folders() if self._fuel is not None else []

    def all_folders(self) -> List[str]:
        """All model and resource folders, and the folders of ROS packages."""
        return [*self._all("models"), *self._all("media"), *self._packages(),
                *self.fuel_folders()]

    def explain(self, missing: ResourceNotFoundError, otherwise: str) -> Tuple[str, str]:
        """Text and hint of an issue about a missing URI.

        An existing, similar URI comes first in the hint; the text then names no places. The text
        about an unknown package or model has no URI: it is the same for all of its files, so that
        the log has one line for them.

        Args:
            missing: the fault.
            otherwise: what to do if no similar URI exists.
        """
        found = (suggestion(missing.uri, missing.tried, self._packages)
                 or same_file_elsewhere(missing.uri, self.model_folders(), self._own,
                                        self._packages))
        unknown = _unknown_package(missing.uri, missing.tried)
        if not found and unknown:
            return f"is in the ROS package {unknown!r}, which was not found", otherwise
        model = "" if found else _unknown_model(missing.uri, missing.tried)
        if model:
            return f"is in the model {model!r}, which was not found", otherwise
        if not found:
            return str(missing), otherwise
        return f"{missing.uri!r} was not found", f"did you mean {found}? Otherwise {otherwise}"

    def add_model_folder(self, folder: str) -> None:
        """Add a model folder, searched after the others."""
        if folder not in self._model_paths:
            self._model_paths.append(folder)

    def with_first_folder(self, folder: str) -> "Resolver":
        """A resolver that searches this model folder before the others; this one stays."""
        other = copy.copy(self)
        other._model_paths = [folder, *self._model_paths]
        return other

    def knows_package(self, folder: str) -> bool:
        """Whether a folder with a package.xml is the one that `package://` resolves to."""
        name = package_name(folder)
        found = self._find_package(name) if name else None
        return found is not None and os.path.realpath(found) == os.path.realpath(folder)

    def begin(self) -> None:
        """Start reading a new document: failed downloads may be tried again."""
        for source in (self._missing, self._fuel):
            if source is not None:
                source.begin()

    def resolve(self, uri: str, base_dir: str = "") -> str:
        """The absolute path of the file or folder of a URI.

        Args:
            uri: `model://`, `package://`, `file://`, an address of Fuel, or a path.
            base_dir: folder of the file that contains the URI; "" for none.

        Raises:
            ResourceNotFoundError: the file does not exist, or is a device or a named pipe, whose
                reader might wait forever.
        """
        uri = uri.strip()
        if not uri or uri == "__default__":
            raise ResourceNotFoundError(uri, reason="the URI is empty")
        if is_web_address(uri):
            return self._from_fuel(uri)
        tried: List[str] = []
        for candidate in self._candidates(uri, base_dir):
            if _is_file_or_folder(candidate):
                return os.path.abspath(candidate)
            if candidate not in tried:
                tried.append(candidate)
        return self._download_model(uri, tried)

    def _from_fuel(self, uri: str) -> str:
        known = fuel_uri(uri)
        if known is None or self._fuel is None:
            raise ResourceNotFoundError(
                uri, reason="of web addresses only those of models on a Fuel server are"
                " read, https://HOST/1.0/OWNER/models/NAME, or model://, package://,"
                " file:// and paths",
            )
        try:
            return os.path.abspath(self._fuel.path(known))
        except ModelNotProvidedError as fault:
            raise ResourceNotFoundError(uri, reason=str(fault)) from None

    def _download_model(self, uri: str, tried: List[str]) -> str:
        """The path of a downloaded model. Raises ResourceNotFoundError."""
        name, inside = _split_package(uri.partition("://")[2])
        if self._missing is not None and uri.startswith("model://") and name:
            try:
                path = os.path.join(self._missing.provide(name), inside)
            except ModelNotProvidedError as fault:
                raise ResourceNotFoundError(uri, [*tried, str(fault)]) from None
            if _is_file_or_folder(path):
                return os.path.abspath(path)
            tried.append(path)
        here = self.replaced_home(uri)
        if here:
            return self.resolve(here)
        special = next(filter(os.path.exists, tried), "")
        raise ResourceNotFoundError(uri, tried, f"{special} is neither a file nor a folder"
                                    if special else "")

    def replaced_home(self, uri: str) -> str:
        """`model://NAME/…` for a path `…/.gazebo/models/NAME/…` that does not exist.

        Many files name the home folder of the machine that they were written on; `resolve` then
        takes the model of that name. "" for other URIs, and if there is no such model here.
        """
        path = uri.strip()
        path = path[len("file://"):] if path.startswith("file://") else path
        before, found, inside = path.rpartition(_HOME_MODELS)
        if not (found and inside and os.path.isabs(before or path)) or os.path.exists(path):
            return ""
        there = (os.path.join(folder, inside) for folder in self._all("models"))
        return f"model://{inside}" if any(map(os.path.exists, there)) else ""

    def add_unlisted_folder(self, uri: str, base_dir: str) -> str:
        """Add the folder of a missing model that is near the file or in a package; "" for none.

        See `suggestions.unlisted_model_folder`. Returns the folder.
        """
        folder = unlisted_model_folder(uri, os.path.abspath(base_dir) if base_dir else "",
                                       self._packages)
        if folder:
            self.add_model_folder(folder)
        return folder

    def model_file(self, uri: str, base_dir: str = "") -> str:
        """The description file of a URI: the file itself, or that of a model folder.

        Raises ResourceNotFoundError: not found, or the folder has no description.
        """
        path = self.resolve(uri, base_dir)
        if not os.path.isdir(path):
            return path
        found = description_in(path)
        if found is None:
            raise ResourceNotFoundError(
                uri,
                [os.path.join(path, "model.config"), os.path.join(path, "manifest.xml"),
                 os.path.join(path, "model.sdf")],
            )
        return found

    def _candidates(self, uri: str, base_dir: str) -> Iterator[str]:
        scheme, separator, rest = uri.partition("://")
        if not separator:
            yield from self._for_path(uri, base_dir)
        elif scheme == "file":
            yield from self._for_path(rest, base_dir)
            if "%" in rest:
                from urllib.parse import unquote

                yield from self._for_path(unquote(rest), base_dir)
        elif scheme == "model":
            rest = rest.lstrip("/")  # `model:///name` is accepted, too (Gazebo behaviour)
            if self._fuel is not None:
                yield from self._fuel.beside(base_dir, rest)
            yield from self._for_model(rest)
            yield from self._for_package(uri, rest)
        elif scheme == "package":
            rest = rest.lstrip("/")
            yield from self._for_package(uri, rest)
            yield from self._for_model(rest)
        else:
            known = "model://, package://, file:// or a path"
            raise ResourceNotFoundError(uri, reason=f"{scheme}:// is not supported; use {known}")

    def _for_model(self, rest: str) -> Iterator[str]:
        for folder in self._all("models"):
            yield os.path.join(folder, rest)

    def _for_package(self, uri: str, rest: str) -> Iterator[str]:
        name, inside = _split_package(rest)
        if not name:
            raise ResourceNotFoundError(uri, reason="the name after :// is missing")
        folder = self._find_package(name)
        yield os.path.join(folder, inside) if folder else f"{NO_PACKAGE}{name}"
        for behind in self._own[1:] if name == PACKAGE else ():
            yield os.path.join(behind, inside)

    def _for_path(self, path: str, base_dir: str) -> Iterator[str]:
        if os.path.isabs(path):
            yield path
            for folder in self._all("models"):
                yield os.path.join(folder, path.lstrip("/"))
            return
        if base_dir:
            yield os.path.join(base_dir, path)
        yield os.path.abspath(path)
        # Gazebo has worlds in `worlds/` of a resource path, this package in `world/`.
        inside = path[len("worlds/"):] if path.startswith("worlds/") else ""
        for folder in self._all("media"):
            for suffix in _MEDIA_SUFFIXES:
                yield os.path.join(folder, suffix, path)
            if inside:
                yield os.path.join(folder, "world", inside)

    def _all(self, kind: str) -> Iterator[str]:
        first = self._model_paths if kind == "models" else self._resource_paths
        yield from first
        if self._late is None:
            self._late = self._exported()
        yield from self._late.models if kind == "models" else self._late.media


def _is_file_or_folder(path: str) -> bool:
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):   # ValueError: a null character
        return False
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)


def _describe_search(uri: str, tried: Sequence[str]) -> str:
    """Where a URI was searched, for its message; "" for an absolute path, which says it itself."""
    if not tried:
        return "no search path is set"
    path = uri[len("file://"):] if uri.startswith("file://") else uri
    if os.path.isabs(path):
        return ""
    unknown = _unknown_package(uri, tried)
    if unknown:
        return f"there is no ROS package {unknown!r}"
    places = [place for place in tried if os.path.isabs(place)]
    downloads = [place for place in tried if not os.path.isabs(place)
                 and not place.startswith(NO_PACKAGE)]
    more = len(places) - _MOST_PLACES
    counted = [f"{more} more places"] if more > 0 else []
    return "searched " + ", ".join([*places[:_MOST_PLACES], *counted, *downloads])


def _unknown_package(uri: str, tried: Sequence[str]) -> str:
    """The unknown package that a `package://` URI names; "" for other URIs."""
    if not uri.startswith("package://"):
        return ""
    return next((place[len(NO_PACKAGE):] for place in tried if place.startswith(NO_PACKAGE)), "")


def _unknown_model(uri: str, tried: Sequence[str]) -> str:
    """The model of a `model://` URI of a file if no searched folder has that model, else ""."""
    scheme, _, rest = uri.partition("://")
    name, _, inside = rest.strip("/").partition("/")
    places = [place for place in tried if not place.startswith(NO_PACKAGE)]
    if scheme != "model" or not inside or not all(map(os.path.isabs, places)):
        return ""  # a place that is no path says why a download failed
    folders = [place[:-len(inside)] for place in places if place.endswith(inside)]
    return "" if any(map(os.path.isdir, folders)) else name


def _read_path_variable(variable: str) -> List[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _split_package(rest: str) -> Tuple[str, str]:
    name, _, inside = rest.partition("/")
    return name, inside
