"""Which files a world of a submission can name."""
from __future__ import annotations

import os
from typing import Tuple

from ..resources.resolver import Resolver, ResourceNotFoundError
from .box_process import contains


class ConfinedResolver(Resolver):
    """Finds files in given folders and in those of models, resources and packages.

    The judge may be root: a world must not show files that its author cannot read.
    """

    _allowed: Tuple[str, ...] = ()
    _searched: Tuple[str, ...] = ()

    def allow(self, *folders: str) -> None:
        """Permit all files below folders."""
        self._allowed += tuple(map(os.path.realpath, folders))

    def resolve(self, uri: str, base_dir: str = "") -> str:
        """As `Resolver.resolve`; a file elsewhere counts as missing."""
        path = super().resolve(uri, base_dir)
        real = os.path.realpath(path)
        if not any(contains(folder, real) for folder in self._allowed):
            self._searched = self._searched or tuple(map(os.path.realpath, self.all_folders()))
            if not any(contains(folder, real) for folder in self._searched):
                raise ResourceNotFoundError(uri, reason="it lies outside of the submission and of"
                                                        " all model and resource folders")
        return path
