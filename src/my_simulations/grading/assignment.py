"""An assignment as data: what a submission contains, which checks give which points."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, List, Optional, Tuple, Union

from ..studies.expressions import Expression, Signal
from ..studies.study import PlacedModel

STATIC, DYNAMIC, MODEL, LIGHT, LINK, JOINT, PLUGIN = (
    "static", "dynamic", "model", "light", "link", "joint", "plugin")
COUNTED = (STATIC, DYNAMIC, MODEL, LIGHT, LINK, JOINT, PLUGIN)
"""Kinds of entities that `count` counts; static and dynamic are models."""


@dataclass(frozen=True)
class Check:
    """One line of the mark.

    Attributes:
        points: the most that it gives.
        name: shown to the student.
        line: of the assignment file.
    """

    points: float
    name: str
    line: int


@dataclass(frozen=True)
class ValidFile(Check):
    """The world file has no errors; `strict`: nor what Gazebo tolerates."""

    strict: bool = False


@dataclass(frozen=True)
class EntityCount(Check):
    """The world file contains a number of entities.

    Attributes:
        kind: one of COUNTED.
        excluded: names that do not count.
        shape: only models with a collision or visual of this geometry count; "" for all.
        least, most: the number; `most` None for no limit.
        partial: fewer than `least` give points in proportion.
    """

    kind: str = MODEL
    excluded: Tuple[str, ...] = ()
    shape: str = ""
    least: int = 0
    most: Optional[int] = None
    partial: bool = False


@dataclass(frozen=True)
class Timed(Check):
    """A check of the running world.

    Attributes:
        within: s of sim time after which it is decided.
    """

    within: float = 0.0


@dataclass(frozen=True)
class Place(Timed):
    """A model is at a place after `within`.

    Attributes:
        model: its name.
        at: m, world frame; z None for any height.
        tolerance: m.
        partial: distance at which no points are left, m; 0 for no partial points.
    """

    model: str = ""
    at: Tuple[float, float, Optional[float]] = (0.0, 0.0, None)
    tolerance: float = 0.1
    partial: float = 0.0


@dataclass(frozen=True)
class Requirement(Timed):
    """A condition holds.

    Attributes:
        require: the condition.
        partial: a number from 0 to 1, the share of the points if it does not hold.
        message: texts and measurements that the student reads then; empty for the condition
            itself, with what was measured.
    """

    require: Optional[Expression] = None
    partial: Optional[Expression] = None
    message: Tuple[Union[str, Expression], ...] = ()

    @property
    def expressions(self) -> Tuple[Expression, ...]:
        """All that is measured."""
        return tuple(one for one in (self.require, self.partial, *self.message)
                     if isinstance(one, Expression))


@dataclass(frozen=True)
class NoContact(Timed):
    """Two models never touch."""

    first: str = ""
    second: str = ""


@dataclass(frozen=True)
class TopicRate(Timed):
    """A topic of ROS has messages.

    Attributes:
        topic: its name.
        type_name: such as `geometry_msgs/Twist`; "" for any.
        rate: least messages for each second of sim time.
    """

    topic: str = ""
    type_name: str = ""
    rate: float = 0.0


@dataclass(frozen=True)
class ServiceAnswer(Timed):
    """A service of a type answers a default request."""

    service: str = ""
    type_name: str = ""


@dataclass(frozen=True)
class Launch(Check):
    """A launch file of the submission starts, and its nodes run for a time.

    Attributes:
        file: patterns of its path in the submission.
        arguments: as for roslaunch, `name:=value`.
        seconds: wall s for which the nodes must run.
        nodes: names of nodes that must be there.
        runs_world: whether the simulator must have loaded the world file of the submission.
    """

    file: Tuple[str, ...] = ()
    arguments: Tuple[str, ...] = ()
    seconds: float = 5.0
    nodes: Tuple[str, ...] = ()
    runs_world: bool = False


@dataclass(frozen=True)
class Rostest(Check):
    """A rostest file beside the assignment passes; failed tests take their share of the points."""

    file: str = ""
    arguments: Tuple[str, ...] = ()
    seconds: float = 300.0


@dataclass(frozen=True)
class SubmissionForm:
    """What a submission contains.

    Attributes:
        world: patterns of the world file's path; () if it contains none.
        run: patterns of the program's path; () if it contains none.
        models: patterns of the paths of model files, which must parse for checks of the running
            world to give points.
    """

    world: Tuple[str, ...] = ()
    run: Tuple[str, ...] = ()
    models: Tuple[str, ...] = ()


@dataclass(frozen=True)
class GradeLimits:
    """Limits of one submission.

    Attributes:
        seconds: wall s for everything.
        processor_seconds: of all processes of a program or launch file together, s.
        memory_mb: of all processes of a program or launch file together.
        processes: processes and threads of the submission at a time.
        file_mb: of each file, and of all files together.
        replay_mb: of the replay; a larger one is left out, with a note.
    """

    seconds: float = 600.0
    processor_seconds: float = 120.0
    memory_mb: float = 2000.0
    processes: int = 256
    file_mb: float = 200.0
    replay_mb: float = 50.0


@dataclass(frozen=True)
class Assignment:
    """An assignment.

    Attributes:
        lab: its name.
        file: path of the assignment file.
        form: what a submission contains.
        world: world file of the assignment; "" where the submission brings one.
        models: added to the world before time begins.
        sample: s of sim time between two samples.
        limits: of each submission.
        checks: in the order of the file.
        may_change_world: whether programs can call services of /gazebo that change the world.
        recorded: topics that the replay contains, with a leading slash; a name such as
            `/cmd_vel.linear.x` also has a curve in its plot.
    """

    lab: str
    file: str
    form: SubmissionForm
    world: str
    models: Tuple[PlacedModel, ...]
    sample: float
    limits: GradeLimits
    checks: Tuple[Check, ...] = field(default_factory=tuple)
    may_change_world: bool = True
    recorded: Tuple[str, ...] = ()

    @property
    def files(self) -> Tuple[str, ...]:
        """The assignment file and those that it names."""
        named = (self.file, self.world, *(model.file for model in self.models),
                 *(check.file for check in self.of(Rostest)))
        return tuple(dict.fromkeys(path for path in named if path))

    @property
    def recorded_topics(self) -> Tuple[str, ...]:
        return tuple(dict.fromkeys(name.partition(".")[0] for name in self.recorded))

    @property
    def curves(self) -> Tuple[str, ...]:
        """Numbers of recorded topics that the plot of the replay shows from the start."""
        return tuple(name for name in self.recorded if "." in name)

    @property
    def points(self) -> float:
        return sum(check.points for check in self.checks)

    def of(self, *kinds: type) -> "Tuple[Any, ...]":
        """The checks of these kinds, in order."""
        return tuple(check for check in self.checks if isinstance(check, kinds))


def signals_of(check: Timed) -> List[Signal]:
    """What a check reads from the world."""
    if isinstance(check, Place):
        return [Signal("pose", (check.model,), part) for part in "xyz"]
    if isinstance(check, NoContact):
        return [Signal("contact", (check.first, check.second))]
    if isinstance(check, Requirement):
        return [signal for one in check.expressions for signal in one.signals]
    return []
