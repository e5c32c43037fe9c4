"""Names of the example environments for `gymnasium.make`."""
from __future__ import annotations

from gymnasium.envs.registration import register, registry

EXAMPLES = {"my_simulations/PushBox-v0": ("push_box:make", 300),
            "my_simulations/StackBoxes-v0": ("stack_boxes:make", 400)}
"""Module and function below this package, and the most steps of an episode."""


def register_environments() -> None:
    """Register the example environments, once; also called by gymnasium's plugin mechanism."""
    for name, (place, steps) in EXAMPLES.items():
        if name not in registry:
            register(id=name, entry_point=f"{__package__}.{place}", max_episode_steps=steps)
