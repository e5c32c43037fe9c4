#!/usr/bin/env python3
"""Write the models that tools/generate/content describes into models/.

    python3 tools/generate/make_models.py [FOLDER]

A test compares the committed files with what this writes, so a model is changed in content/.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, Sequence

from content import (
    furniture,
    kitchen,
    obstacles,
    people,
    signs,
    small_vehicles,
    vehicles,
    warehouse,
)
from content.model import Model

KINDS = (
    ("Vehicle", vehicles),
    ("Vehicle", small_vehicles),
    ("Person", people),
    ("Furniture", furniture),
    ("Kitchen", kitchen),
    ("Warehouse", warehouse),
    ("Sign or lamp", signs),
    ("Obstacle", obstacles),
)
MODELS = Path(__file__).resolve().parents[2] / "models"


def models() -> List[Model]:
    """All models, in the order of their categories."""
    return [replace(model, kind=kind) for kind, category in KINDS for model in category.models()]


def files() -> Dict[str, bytes]:
    """Content by path below models/."""
    return {
        f"{model.name}/{path}": content
        for model in models()
        for path, content in model.files().items()
    }


def main(argv: Sequence[str]) -> int:
    """Writes all files."""
    folder = Path(argv[1]) if len(argv) > 1 else MODELS
    for path, content in files().items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
