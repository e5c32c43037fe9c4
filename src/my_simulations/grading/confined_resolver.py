"""Which files a world of a submission can name."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Tuple

from ..resources.resolver import Resolver, ResourceNotFoundError
from .box_process import contains


class ConfinedResolver(Resolver):
    """Finds files in given folders and in those of models, resources and packages.

    The judge may be root: a world must not show files that its author cannot read.

    Attributes:
        looked_up: absolute paths of files that were found, and of those that do not exist, in
            the order in which they were searched.
    """

    _allowed: Tuple[str, ...] = ()
    _searched: Tuple[str, ...] = ()

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._looked_up: Dict[str, None] = {}

    @property
    def looked_up(self) -> List[str]:
        return list(self._looked_up)

    def allow(self, *folders: str) -> None:
        """Permit all files below folders."""
        self._allowed += tuple(map(os.path.realpath, folders))

    def resolve(self, uri: str, base_dir: str = "") -> str:
        """As `Resolver.resolve`; a file elsewhere counts as missing."""
        try:
            path = super().resolve(uri, base_dir)
        except ResourceNotFoundError as missing:
            self._looked_up.update(dict.fromkeys(filter(os.path.isabs, missing.tried)))
            raise
        if not (self._is_in(self._allowed, path) or self._is_in(self._list_installed(), path)):
            raise ResourceNotFoundError(uri, reason="it lies outside of the submission and of"
                                                    " all model and resource folders")
        self._looked_up[path] = None
        return path

    def model_file(self, uri: str, base_dir: str = "") -> str:
        """As `Resolver.model_file`."""
        path = super().model_file(uri, base_dir)
        self._looked_up[path] = None
        return path

    def add_unlisted_folder(self, uri: str, base_dir: str) -> str:
        """As `Resolver.add_unlisted_folder`; the added folder does not become permitted."""
        self._list_installed()
        return super().add_unlisted_folder(uri, base_dir)

    def _list_installed(self) -> Tuple[str, ...]:
        """The folders of models, resources and packages before a file has added others."""
        self._searched = self._searched or tuple(map(os.path.realpath, self.all_folders()))
        return self._searched

    @staticmethod
    def _is_in(folders: Tuple[str, ...], path: str) -> bool:
        real = os.path.realpath(path)
        return any(contains(folder, real) for folder in folders)
