"""Materials as the page gets them."""
from __future__ import annotations

from typing import Any, Dict, List, Optional

from ...appearance import materials
from ...appearance.looks import Look
from ...description.shapes import Color, Material, Visual
from ...resources.resolver import Resolver
from .served_files import ServedFiles


class Materials:
    """Documents of materials, with URLs for pictures. Safe from any thread."""

    def __init__(self, resolver: Resolver, served: ServedFiles) -> None:
        self._looks = materials.Materials(resolver, served)
        self._served = served

    def document(self, material: Optional[Material]) -> Optional[Dict[str, Any]]:
        """A material as the protocol's `Material`; None for none."""
        look = self._looks.resolve(material)
        if look is None:
            return None
        return {"ambient": _plain(look.ambient), "diffuse": _plain(look.diffuse),
                "specular": _plain(look.specular), "emissive": _plain(look.emissive),
                "name": look.name, "texture": self._texture(look),
                "transparency": look.transparency, "lighting": look.lit,
                "alpha_test": look.alpha_test, "blended": look.blended}

    def layers(self, visual: Visual) -> List[Dict[str, Any]]:
        """The protocol's `TerrainLayer`s of a visual; none for what is no terrain."""
        look = self._looks.of_visual(visual)
        return [{"url": self._url(one.texture), "pattern": one.pattern or None,
                 "normal_url": self._url(one.normal), "size": one.size,
                 "min_height": one.min_height, "fade_dist": one.fade_dist}
                for one in (look.layers if look else ())]

    def _url(self, path: str) -> Optional[str]:
        return self._served.url(path) if path else None

    def _texture(self, look: Look) -> Optional[Dict[str, Any]]:
        url = self._url(look.texture)
        if url is None and not look.pattern:
            return None
        return {"url": url, "pattern": look.pattern or None, "scale": list(look.scale)}


def _plain(color: Optional[Color]) -> Any:
    return None if color is None else list(color)
