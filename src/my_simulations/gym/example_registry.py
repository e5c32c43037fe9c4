"""Names of the example environments for `gymnasium.make`."""
from __future__ import annotations

import gymnasium

EXAMPLES = {"my_simulations/PushBox-v0": ("push_box:make", 300),
            "my_simulations/StackBoxes-v0": ("stack_boxes:make", 400),
            "my_simulations/Navigate-v0": ("navigation:make", 600),
            "my_simulations/Reach-v0": ("reach:make", 200),
            "my_simulations/PickAndPlace-v0": ("pick_place:make", 400)}
"""Module and function below this package, and the most steps of an episode."""


def register_environments() -> None:
    """Register the example environments, once."""
    for name, (place, steps) in EXAMPLES.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=f"{__package__}.{place}",
                               max_episode_steps=steps)
