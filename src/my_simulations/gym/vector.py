"""Many environments of one task side by side, each with an engine process of its own."""
from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate


class WorldVectorEnv(VectorEnv[Any, Any, Any]):
    """Environments that step at the same time, each in a thread that waits for its engine.

    Each repeats bit for bit what it does alone. Gymnasium's `AutoresetMode.NEXT_STEP`: an
    environment whose episode has ended is reset by the next `step`, which ignores its action.

    Args:
        makers: make the environments, whose spaces are equal.

    Raises TypeError if it is no list of functions, and ValueError for none.
    """

    def __init__(self, makers: Sequence[Callable[[], "gymnasium.Env[Any, Any]"]]) -> None:
        if callable(makers) or not all(map(callable, makers)):
            raise TypeError("WorldVectorEnv takes a list of functions that make environments, such"
                            f" as [make] * 8, not {makers!r:.80}")
        if not makers:
            raise ValueError("WorldVectorEnv needs one function at least")
        self.envs: List["gymnasium.Env[Any, Any]"] = []
        try:
            for make in makers:
                self.envs.append(make())
        except BaseException:
            for env in self.envs:  # a maker may have reset it, which starts an engine
                env.close()
            raise
        first = self.envs[0]
        self.num_envs = len(self.envs)
        self.metadata = {**first.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self.render_mode = first.render_mode
        self.single_observation_space = first.observation_space
        self.single_action_space = first.action_space
        self.observation_space = batch_space(first.observation_space, self.num_envs)
        self.action_space = batch_space(first.action_space, self.num_envs)
        self._over = np.zeros(self.num_envs, dtype=bool)
        self._threads = ThreadPoolExecutor(self.num_envs, "environment")
        # Handing a single one to a thread takes as long as four physics steps of an arm.
        self._each = map if self.num_envs == 1 else self._threads.map

    def reset(self, *, seed: Optional[Union[int, Sequence[Optional[int]]]] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Any, Dict[str, Any]]:
        """Begin an episode in every environment; a single seed counts up from one to the next.

        Raises ValueError for another number of seeds than of environments.
        """
        if seed is None or isinstance(seed, int):
            seeds: List[Optional[int]] = [None if seed is None else seed + number
                                          for number in range(self.num_envs)]
        else:
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError(f"{self.num_envs} environments need as many seeds, not"
                                 f" {len(seeds)}")
        found = list(self._each(lambda env, one: env.reset(seed=one, options=options),
                                self.envs, seeds))
        self._over[:] = False
        return self._batch([observation for observation, _ in found]), self._infos(
            [info for _, info in found])

    def step(self, actions: Any) -> Tuple[Any, np.ndarray, np.ndarray, np.ndarray, Dict[str, Any]]:
        """Step all environments; see gymnasium.vector.VectorEnv.step.

        Raises ValueError for another number of actions than of environments.
        """
        given = list(iterate(self.action_space, actions))
        if len(given) != self.num_envs:
            raise ValueError(f"{self.num_envs} environments need as many actions, not {len(given)}")
        found = list(self._each(self._step, self.envs, given, list(self._over)))
        rewards = np.array([one[1] for one in found], dtype=np.float64)
        terminated = np.array([one[2] for one in found], dtype=bool)
        truncated = np.array([one[3] for one in found], dtype=bool)
        self._over = terminated | truncated
        return (self._batch([one[0] for one in found]), rewards, terminated, truncated,
                self._infos([one[4] for one in found]))

    def render(self) -> Optional[Tuple[Any, ...]]:
        return tuple(self._each(lambda env: env.render(), self.envs))

    def close_extras(self, **kwargs: Any) -> None:
        list(self._each(lambda env: env.close(), self.envs))
        self._threads.shutdown()

    @staticmethod
    def _step(env: "gymnasium.Env[Any, Any]", action: Any, over: bool) -> Tuple[Any, ...]:
        if over:
            observation, info = env.reset()
            return observation, 0.0, False, False, info
        return env.step(action)

    def _batch(self, observations: Sequence[Any]) -> Any:
        out = create_empty_array(self.single_observation_space, self.num_envs)
        return concatenate(self.single_observation_space, observations, out)

    def _infos(self, infos: Sequence[Dict[str, Any]]) -> Dict[str, Any]:
        together: Dict[str, Any] = {}
        for number, info in enumerate(infos):
            together = self._add_info(together, info, number)
        return together
