"""Downloads models from the database in GAZEBO_MODEL_DATABASE_URI into ~/.gazebo/models.

Layout of the database (Gazebo's): `database.config` (older: `manifest.xml`) lists the models; each
has `NAME/model.config` and `NAME/model.tar.gz`, which contains a folder `NAME`. If the variable is
empty or unset, the network is not used. All downloads of a world share one deadline.
"""
from __future__ import annotations

import os
import re
from typing import List, Optional, Set
from urllib.parse import quote

from ..model_provider import DATABASE, ModelNotProvidedError, Progress
from .archive import install, unpack
from .download_time import WORLD_SECONDS, DownloadTime
from .http_download import HttpError, Limits, fetch

LISTS = ("database.config", "manifest.xml")

_NAME = re.compile(r"[A-Za-z0-9_][\w .+()-]*\Z")
_MOST_DEPENDENCIES = 100


class ModelDatabase(DownloadTime):
    """Downloads missing models.

    Args:
        uri: address of the database; "" for none.
        folder: destination, in which each model gets a folder `NAME`.
        progress: hears how far a download is.
        seconds: for all downloads in all, from the first one on (wall time).
        limits: of sizes.
    """

    def __init__(self, uri: str, folder: str, progress: Optional[Progress] = None,
                 seconds: float = WORLD_SECONDS, limits: Optional[Limits] = None) -> None:
        super().__init__(progress, seconds, limits)
        self.uri = uri.strip().rstrip("/")
        self._folder = folder
        self._listed: Optional[Set[str]] = None

    @classmethod
    def from_environment(cls, progress: Optional[Progress] = None) -> Optional["ModelDatabase"]:
        """The database of the variable; None if it is unset or empty."""
        uri = os.environ.get(DATABASE, "").strip()
        if not uri:
            return None
        return cls(uri, os.path.expanduser("~/.gazebo/models"), progress)

    def begin(self) -> None:
        """Start a new world: the deadline starts again, and failed downloads may be tried again."""
        super().begin()
        self._listed = None

    def names(self) -> Set[str]:
        """Names of the models in the database. Raises ModelNotProvidedError."""
        try:
            return set(self._names())
        except (HttpError, OSError) as fault:
            raise ModelNotProvidedError(f"{self.uri}: {fault}") from fault

    def provide(self, name: str) -> str:
        """The folder of a model, which is downloaded with its dependencies if missing.

        If a dependency cannot be downloaded, the model is still usable; the missing model is
        reported where it is used. Raises ModelNotProvidedError: the model cannot be downloaded now.
        """
        path = self._folder_of(name)
        waiting, seen = _dependencies(path), {name}
        while waiting and len(seen) < _MOST_DEPENDENCIES:
            other = waiting.pop(0)
            if other in seen:
                continue
            seen.add(other)
            try:
                waiting += _dependencies(self._folder_of(other))
            except ModelNotProvidedError:
                continue  # kept, to be reported where the model is used
        return path

    def _folder_of(self, name: str) -> str:
        if not _NAME.match(name) or name.strip(" .") != name:
            raise ModelNotProvidedError(f"{name!r} is not a valid model name")
        path = os.path.join(self._folder, name)
        if os.path.isdir(path):
            return path
        self.once(name, self.uri, lambda: self._download(name, path))
        return path

    def _download(self, name: str, path: str) -> None:
        if name not in self._names():
            raise HttpError(f"the database does not contain model {name!r}")

        def make(work: str) -> str:
            archive = os.path.join(work, "model.tar.gz")
            with open(archive, "wb") as stream:
                fetch(f"{self.uri}/{quote(name)}/model.tar.gz", stream, self.limits.archive_bytes,
                      self.until(), self.report(name))
            return unpack("tar", archive, os.path.join(work, "unpacked"), name, self.limits,
                          self.until())

        install(path, make)

    def _names(self) -> Set[str]:
        """Names of the models in the database; requested once."""
        if self._listed is None:
            from io import BytesIO

            fault: Optional[HttpError] = None
            for config in LISTS:
                stream = BytesIO()
                try:
                    fetch(f"{self.uri}/{config}", stream, self.limits.list_bytes, self.until())
                except HttpError as failure:
                    if not failure.missing:
                        raise
                    fault = fault or failure
                    continue
                self._listed = _uris(stream.getvalue())
                break
            if self._listed is None:
                raise fault or HttpError("no list of models found")
        return self._listed


def _uris(text: bytes) -> Set[str]:
    """Names in `<uri>file://NAME</uri>`, of a list or of a model's dependencies."""
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False,
                             huge_tree=False, recover=True)
    try:
        root = etree.fromstring(text, parser)
    except (etree.XMLSyntaxError, ValueError):
        root = None
    if root is None:
        raise HttpError("the list of models is not valid XML")
    found = (re.sub(r"^\w+://", "", (uri.text or "").strip()).strip("/")
             for uri in root.iter("uri"))
    return {name for name in found if name}


def _dependencies(folder: str) -> List[str]:
    """Names in `<depend>` of a model's config; [] if it is unreadable."""
    from lxml import etree

    for config in ("model.config", "manifest.xml"):
        path = os.path.join(folder, config)
        if not os.path.isfile(path):
            continue
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False,
                                 huge_tree=False, recover=True)
        try:
            root = etree.parse(path, parser).getroot()
        except (OSError, etree.XMLSyntaxError):
            return []
        uris = root.iterfind(".//depend//uri") if root is not None else ()
        return [re.sub(r"^\w+://", "", (uri.text or "").strip()).split("/")[0] for uri in uris]
    return []
