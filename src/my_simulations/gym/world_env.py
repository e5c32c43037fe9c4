"""A world as an environment of gymnasium: the base class of all tasks."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Optional, Protocol, Sequence, Tuple

import gymnasium
import numpy as np

from ..errors import EngineLostError
from ..python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice
from .viewer import Viewer


@dataclass(frozen=True)
class View:
    """The camera of `render`: position and the point it looks at in m, world frame; pixels."""

    position: Tuple[float, float, float] = (1.5, -1.5, 1.2)
    target: Tuple[float, float, float] = (0.0, 0.0, 0.2)
    width: int = 480
    height: int = 360


@dataclass(frozen=True)
class Evaluation:
    """The reward of a step, and whether it ended the episode.

    Attributes:
        reward: of the step.
        terminated: whether the episode ends, by success or failure.
        info: the dictionary that `step` returns. The tasks of this package set "is_success".

    Raises TypeError if `info` is not a dictionary.
    """

    reward: float
    terminated: bool = False
    info: Dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.info, dict):
            raise TypeError("the info of an Evaluation is a dictionary, such as "
                            f"{{'is_success': True}}, not {self.info!r:.80}")


class Task(Protocol):
    """The attributes and methods that `WorldEnv` requires of a task.

    Attributes:
        choice: the world.
        period: s of sim time between two actions.
        action_space: of gymnasium.
        observation_space: of gymnasium.
        view: the camera of pictures.
    """

    choice: WorldChoice
    period: float
    action_space: "gymnasium.Space[Any]"
    observation_space: "gymnasium.Space[Any]"
    view: View

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Arrange the world, which has just been reset, for an episode."""

    def act(self, world: OpenWorld, action: Any) -> None:
        """Apply an action; the world makes its steps afterwards."""

    def observe(self, world: OpenWorld) -> Any:
        """Return the observation, a member of the space; called after `begin` and each step."""

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        """Evaluate the step; called after `observe`, so it can use values that `observe` stored."""


class WorldEnv(gymnasium.Env[Any, Any]):
    """An environment with a world of its own, in an engine process of its own.

    Episodes with equal seeds and actions repeat bit for bit. If the engine dies, the episode is
    truncated with the reason under "fault" of the info, and the next `reset` opens the world again.

    Args:
        task: world, actions, observations and rewards.
        render_mode: "rgb_array", "human", or None. "human" shows the world in a page of the editor,
            which cannot change it, and makes the steps in real time.
        robots: which plugins of the world's robots run.
        randomisation: properties drawn for each episode, from the seed of `reset`.

    Raises TypeError and ValueError for arguments of other types.

    Attributes:
        viewer: the page of `render_mode` "human"; else None.
    """

    metadata: Dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 10}

    def __init__(self, task: Task, render_mode: Optional[str] = None,
                 robots: RobotOptions = RobotOptions(),  # noqa: B008
                 randomisation: Optional[Randomisation] = None) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError("render_mode is 'human', 'rgb_array' or None, not"
                             f" '{render_mode}'")
        _check_task(task)
        if not isinstance(robots, RobotOptions):
            raise TypeError(f"robots are RobotOptions, not {robots!r:.80}")
        if not isinstance(randomisation, (Randomisation, type(None))):
            raise TypeError(f"randomisation is a Randomisation, not {randomisation!r:.80}")
        self.task = task
        self.render_mode = render_mode
        self._robots, self._randomisation = robots, randomisation
        self.action_space = task.action_space
        self.observation_space = task.observation_space
        self.metadata = {**self.metadata, "render_fps": round(1.0 / task.period)}
        self._world: Optional[OpenWorld] = None
        self._last: Any = None
        self.viewer = Viewer() if render_mode == "human" else None

    @property
    def world(self) -> OpenWorld:
        """The open world. Raises gymnasium.error.ResetNeeded before the first reset."""
        if self._world is None:
            raise gymnasium.error.ResetNeeded("call reset before step and render")
        return self._world

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
              ) -> Tuple[Any, Dict[str, Any]]:
        """Begin an episode; see gymnasium.Env.reset. `options` goes to the task."""
        super().reset(seed=seed)
        choice = self.task.choice
        if self._randomisation is not None:
            choice = self._randomisation.apply(choice, self.np_random)
        if self._world is None:
            self._world = OpenWorld(choice, robots=self._robots)
        elif self._randomisation is not None:
            self._world.open(choice)
        else:
            self._world.reset()
        if self.viewer is not None:
            self.viewer.show(self._world)
        self.task.begin(self._world, self.np_random, options or {})
        self._last = self.task.observe(self._world)
        return self._last, {}

    def step(self, action: Any) -> Tuple[Any, float, bool, bool, Dict[str, Any]]:
        """Apply an action and make the steps of a period; see gymnasium.Env.step."""
        world = self.world
        try:
            self.task.act(world, action)
            world.step(max(1, round(self.task.period / world.step_size)))
            if self.viewer is not None:
                self.viewer.wait_for_real_time(self.task.period)
            self._last = self.task.observe(world)
            judged = self.task.evaluate(world, action)
            if not isinstance(judged, Evaluation):
                raise TypeError(f"evaluate of {type(self.task).__name__} returns an Evaluation, not"
                                f" {judged!r:.80}")
        except EngineLostError as fault:
            return self._last, 0.0, False, True, {"fault": str(fault)}
        return self._last, float(judged.reward), bool(judged.terminated), False, judged.info

    def render(self) -> Optional[np.ndarray]:
        """A picture, uint8 (height, width, 3); None if render_mode is not "rgb_array"."""
        if self.render_mode != "rgb_array":
            return None
        view = self.task.view
        return self.world.render(view.position, look_at=view.target, width=view.width,
                                 height=view.height).rgb

    def close(self) -> None:
        """End the engine and the page's server."""
        if self.viewer is not None:
            self.viewer.close()
        if self._world is not None:
            self._world.close()
            self._world = None


def _check_task(task: Task) -> None:
    """Raise TypeError or ValueError if the object is not a task."""
    if isinstance(task, type):
        raise TypeError(f"the task is an object, not a class: {task.__name__}()")
    missing = [name for name in (*Task.__annotations__, "begin", "act", "observe", "evaluate")
               if not hasattr(task, name)]
    if missing:
        raise TypeError(f"the task {type(task).__name__} has no {', '.join(missing)}")
    if not isinstance(task.choice, WorldChoice):
        raise TypeError(f"the choice of a task is a WorldChoice, not {task.choice!r:.80}")
    if not isinstance(task.period, (int, float)) or not task.period > 0.0:
        raise ValueError(f"the period of a task is a number of s above 0, not {task.period!r}")


def symmetric_box(bounds: Sequence[float]) -> gymnasium.spaces.Box:
    """A space of float32 numbers between plus and minus each of the bounds."""
    high = np.asarray(bounds, dtype=np.float32)
    return gymnasium.spaces.Box(-high, high, dtype=np.float32)


def clipped_action(action: Any) -> np.ndarray:
    """An action, cut to numbers between -1 and 1."""
    # np.clip takes three times as long for so few numbers.
    return np.minimum(np.maximum(action, -1.0), 1.0)


def clipped_observation(space: gymnasium.spaces.Box, values: Sequence[float]) -> np.ndarray:
    """An observation of `symmetric_box`, cut to its bounds."""
    return np.minimum(np.maximum(np.asarray(values, dtype=np.float32), space.low), space.high)
