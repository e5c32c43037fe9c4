"""Materials as the page gets them."""
from __future__ import annotations

from typing import Any, Dict, Optional

from ...appearance import materials
from ...appearance.looks import Look
from ...description.shapes import Color, Material
from ...resources.resolver import Resolver
from .served_files import ServedFiles


class Materials:
    """Documents of materials, with URLs for pictures. Safe from any thread."""

    def __init__(self, resolver: Resolver, served: ServedFiles) -> None:
        self._looks = materials.Materials(resolver, served)
        self._served = served

    def document(self, material: Optional[Material]) -> Optional[Dict[str, Any]]:
        """A material as the protocol's `Material`; None for none."""
        look = self._looks.look(material)
        if look is None:
            return None
        return {"ambient": _plain(look.ambient), "diffuse": _plain(look.diffuse),
                "specular": _plain(look.specular), "emissive": _plain(look.emissive),
                "name": look.name, "texture": self._texture(look),
                "transparency": look.transparency, "lighting": look.lit,
                "alpha_test": look.alpha_test, "blended": look.blended}

    def _texture(self, look: Look) -> Optional[Dict[str, Any]]:
        url = self._served.url(look.texture) if look.texture else None
        if url is None and not look.pattern:
            return None
        return {"url": url, "pattern": look.pattern or None, "scale": list(look.scale)}


def _plain(color: Optional[Color]) -> Any:
    return None if color is None else list(color)
