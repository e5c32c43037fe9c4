"""The description of a world: plain dataclasses, filled by the readers."""
