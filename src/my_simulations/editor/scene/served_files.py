"""Which files of this machine the page may have, and under which URL.

Only pictures, meshes and materials, and only below a known root: the model and resource folders,
the caches of Fuel models, the folders of ROS packages, the folder of the world. A link that leads
out of its root is refused.
"""
from __future__ import annotations

import hashlib
import os
import re
import threading
from typing import Dict, List, Optional
from urllib.parse import quote

from ...appearance.textures import existing_path, mesh_image_candidates, script_image_candidates
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...resources.ros_packages import package_above
from .content_types import MESHES, PICTURES, extension

SERVED = MESHES | PICTURES

_URI = re.compile(r"(?:^|/)(model|package):/+(.+)\Z")
_ID = re.compile(rb'"/resource/([0-9a-f]+)/')


class ServedFiles:
    """Roots by short id."""

    def __init__(self, resolver: Resolver) -> None:
        self._resolver = resolver
        self._lock = threading.Lock()
        self._roots: Dict[str, str] = {}
        self._more: List[str] = []

    def add_root(self, folder: str) -> None:
        with self._lock:
            if folder and folder not in self._more:
                self._more.append(folder)

    def url(self, path: str) -> Optional[str]:
        """The URL of a file; None for one that must not be served."""
        real = os.path.realpath(path) if path else ""
        if extension(path) not in SERVED or extension(real) not in SERVED:
            return None
        root = self._root_of(real)
        if root is None:
            return None
        return f"/resource/{self._id(root)}/{quote(os.path.relpath(real, root))}"

    def serve_again(self, document: bytes, beside: str = "") -> None:
        """Serve what a JSON document of an earlier session names, as far as it may be served.

        An id cannot be turned back into its root: it is looked for among all that there are now,
        which may take a look at all ROS packages. `beside`: the folder of that session's world,
        which counts where it lies below one of those.
        """
        with self._lock:
            wanted = {known.decode() for known in _ID.findall(document)}.difference(self._roots)
        if not wanted:
            return
        roots = self._resolver.all_folders()
        with self._lock:
            roots += self._more
        if beside and "\0" not in beside:
            inside = os.path.join(os.path.realpath(beside), "any")
            roots += [beside] if self._root_of(inside) is not None else []
        for root in map(os.path.realpath, roots):
            if _id_of(root) in wanted:
                self._id(root)

    def path(self, root_id: str, inside: str) -> Optional[str]:
        """The file of a URL's two parts; None where there is none that may be served.

        A picture that a mesh names and that does not lie beside it is looked for where models keep
        their textures (Gazebo behaviour).
        """
        root = self._roots.get(root_id)
        kind = extension(inside)
        if root is None or "\0" in inside or kind not in SERVED:
            return None
        named = _URI.search(inside)
        if named is not None and kind in PICTURES:
            return self._of_uri(f"{named.group(1)}://{named.group(2)}")
        wanted = os.path.normpath(os.path.join(root, inside))
        if not _is_below(wanted, root):
            return None
        found = self._existing(wanted)
        if found is None and kind in PICTURES:
            places = mesh_image_candidates(wanted, self._resolver.resource_folders())
            found = next((hit for hit in map(self._existing, places) if hit), None)
        return found

    def _of_uri(self, uri: str) -> Optional[str]:
        """A picture that a mesh names by URI; the page has put its own folder before that."""
        try:
            return self._existing(self._resolver.resolve(uri))
        except ResourceNotFoundError:
            return None

    def texture(self, name: str, folders: List[str]) -> Optional[str]:
        """The path of a picture that may be served, looked for in these folders first."""
        places = script_image_candidates(name, folders, self._resolver.resource_folders())
        return next((found for found in map(self._existing, places) if found), None)

    def _existing(self, path: str) -> Optional[str]:
        """The real path of a file that may be served; its name in any letter case.

        A link may have the name of a picture and lead to something else.
        """
        real = existing_path(path)
        served = real is not None and extension(real) in SERVED
        return real if served and self._root_of(real or "") is not None else None

    def _root_of(self, real: str) -> Optional[str]:
        """The root that holds a real path: the longest that fits."""
        with self._lock:
            more = list(self._more)
        folders = [*self._resolver.model_folders(), *self._resolver.resource_folders(),
                   *self._resolver.fuel_folders(), *more]
        fitting = [root for root in map(os.path.realpath, folders) if _is_below(real, root)]
        if fitting:
            return max(fitting, key=len)
        package = package_above(real)
        return package if package and self._resolver.knows_package(package) else None

    def _id(self, root: str) -> str:
        known = _id_of(root)
        with self._lock:
            self._roots[known] = root
        return known


def _id_of(root: str) -> str:
    return hashlib.sha256(root.encode()).hexdigest()[:10]


def _is_below(path: str, root: str) -> bool:
    return root not in ("", os.sep) and path.startswith(root.rstrip(os.sep) + os.sep)
