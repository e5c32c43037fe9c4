"""Interface between the resolver and providers that download models."""
from __future__ import annotations

from typing import Callable

from ..errors import ResourceError

DATABASE = "GAZEBO_MODEL_DATABASE_URI"
"""Environment variable with the address of a Gazebo model database."""

Progress = Callable[[str, int, int], None]
"""Called with a model's name, the bytes received, and the bytes expected (0 if unknown)."""


class ModelNotProvidedError(ResourceError):
    """A provider of models cannot supply a model; the text says why."""
