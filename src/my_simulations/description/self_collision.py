"""Which links of one model meet each other.

Gazebo's rule (SDF 1.7, link/self_collide; ODE backend): two links of a model collide where one of
them says so, a link without a value of its own says what its model does, and links that a joint
connects never collide.
"""
from __future__ import annotations

from .model import Link, Model


def requests_self_collision(link: Link, model: Model) -> bool:
    """Whether a link is to collide with the others of its model."""
    return model.self_collide if link.self_collide is None else link.self_collide


class SelfCollision:
    """Answers for pairs of links of a flattened model, by their positions in `Model.links`."""

    def __init__(self, model: Model) -> None:
        self._asking = [requests_self_collision(link, model) for link in model.links]
        numbers = {link.name: n for n, link in enumerate(model.links)}
        self._joined = {frozenset((numbers.get(joint.parent), numbers.get(joint.child)))
                        for joint in model.joints}

    def collides(self, one: int, other: int) -> bool:
        """Return whether two different links collide; False for a link with itself."""
        return (one != other and (self._asking[one] or self._asking[other])
                and frozenset((one, other)) not in self._joined)
