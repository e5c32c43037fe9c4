"""`<population>`: copies of one model, placed by a rule.

Source: SDF spec 1.7, population, and Gazebo behaviour: clones are named `<model>_clone_<i>` and
are upright. Random positions depend only on the population's name and the world's seed, so a file
always gives the same world.
"""
from __future__ import annotations

import copy
import math
import random
from typing import Any, Callable, Dict, List

from ...description.model import Model
from ...geometry import Pose, Vec3, add, transform
from ..xml.binding import fill
from ..xml.source import FaultLevel, Source
from .include import read_include
from .model import read_model
from .parsed_model import ParsedModel
from .world_tables import POPULATION, Population

MOST = 10000
"""Models of one population; more are skipped with an error."""

_SAMPLES = 10000
_LATTICE = 0.1
_ROUNDS = 20


def read_population(element: Any, source: Source, seed: int) -> List[Model]:
    """The placed models of a population; none, with an error, if it is incomplete."""
    population = Population()
    fill(population, element, POPULATION, source, [])
    fatal = source.log.fatal
    templates = _templates(element, source)
    if source.log.fatal > fatal:
        return []
    problem = _problem(population) if templates else "there is no <model> and no <include>"
    if problem:
        source.report(FaultLevel.ERROR, "population-unusable", f"population {population.name!r} is"
                      f" skipped: {problem}", element)
        return []
    places = draw_positions(population, random.Random(f"{seed}/{population.name}"))
    return [_clone(templates[0], number, place, population)
            for number, place in enumerate(places)]


def _templates(element: Any, source: Source) -> List[Model]:
    """The first model in the population, `<model>` or `<include>`."""
    for child in element.iterchildren("model", "include"):
        if child.tag == "model":
            return [read_model(child, source).model]
        included = read_include(child, source, read_model)
        if isinstance(included, ParsedModel):
            return [included.model]
    return []


def _clone(template: Model, number: int, place: Vec3, population: Population) -> Model:
    clone = copy.deepcopy(template)
    clone.name = f"{template.name}_clone_{number}"
    clone.pose = Pose(transform(population.pose, place))
    return clone


def _problem(p: Population) -> str:
    count = p.rows * p.cols if p.distribution == "grid" else p.model_count
    if p.model_count < 0 or min(p.rows, p.cols) < 0:
        return ""  # none at all
    if count > MOST:
        return f"it asks for {count} models; {MOST} can be placed"
    if p.distribution not in _RULES:
        return f"its distribution {p.distribution!r} is none of {', '.join(_RULES)}"
    if p.distribution == "grid":
        return ""
    if p.box is None and p.radius is None:
        return "it has neither a <box> nor a <cylinder>"
    if p.box is None and p.distribution.startswith("linear"):
        return f"the distribution {p.distribution} needs a <box>"
    if min(p.box or (p.radius or 0.0, p.length)) < 0:
        return "its region has a negative size"
    return ""


def draw_positions(population: Population, draw: random.Random) -> List[Vec3]:
    """Draw the positions of the models (m) in the frame of the population."""
    if min(population.model_count, population.rows, population.cols) < 0:
        return []
    return _RULES[population.distribution](population, draw)


def _random(p: Population, draw: random.Random) -> List[Vec3]:
    return [_point(p, draw) for _ in range(p.model_count)]


def _point(p: Population, draw: random.Random) -> Vec3:
    """A random point of the region, uniformly distributed."""
    if p.box is not None:
        x, y, z = (size * (draw.random() - 0.5) for size in p.box)
        return (x, y, z)
    radius = (p.radius or 0.0) * math.sqrt(draw.random())
    angle = 2 * math.pi * draw.random()
    return (radius * math.cos(angle), radius * math.sin(angle), p.length * draw.random())


def _uniform(p: Population, draw: random.Random) -> List[Vec3]:
    """Evenly spread points: the centres of clusters of a dense sample of the region."""
    import numpy as np

    if p.model_count == 0:
        return []
    samples = np.array(_lattice(p.box) if p.box is not None
                       else [_point(p, draw) for _ in range(_SAMPLES)])
    chosen = [draw.randrange(len(samples)) for _ in range(p.model_count)]
    if p.model_count <= len(samples):
        chosen = draw.sample(range(len(samples)), p.model_count)
    centres = samples[chosen]
    for _ in range(_ROUNDS):
        nearest = _nearest(samples, centres)
        count = np.bincount(nearest, minlength=len(centres))
        sums = np.stack([np.bincount(nearest, samples[:, axis], len(centres))
                         for axis in range(3)], axis=1)
        moved = np.where(count[:, None] > 0, sums / np.maximum(count, 1)[:, None], centres)
        if np.allclose(moved, centres, atol=1e-6):
            break
        centres = moved
    return [(float(x), float(y), float(z)) for x, y, z in centres]


def _nearest(samples: Any, centres: Any) -> Any:
    """The index of the nearest centre for each sample, with bounded memory."""
    import numpy as np

    step = max(1, 1000000 // len(centres))
    square = (centres ** 2).sum(axis=1)
    return np.concatenate([
        np.argmin(square - 2 * samples[at:at + step] @ centres.T, axis=1)
        for at in range(0, len(samples), step)
    ])


def _lattice(box: Vec3) -> List[Vec3]:
    """Grid points 0.1 m apart, or further in a box that would have too many."""
    step = _LATTICE
    while math.prod(int(size / step) + 1 for size in box) > _SAMPLES:
        step *= 1.25
    counts = [int(size / step) + 1 for size in box]
    axes = [[(i - (n - 1) / 2) * step for i in range(n)] for n in counts]
    return [(x, y, z) for x in axes[0] for y in axes[1] for z in axes[2]]


def _grid(p: Population, draw: random.Random) -> List[Vec3]:
    corner = (-(p.cols - 1) * p.step[0] / 2, -(p.rows - 1) * p.step[1] / 2, 0.0)
    return [add(corner, (column * p.step[0], row * p.step[1], 0.0))
            for row in range(p.rows) for column in range(p.cols)]


def _along(axis: int) -> Callable[[Population, random.Random], List[Vec3]]:
    def place(p: Population, draw: random.Random) -> List[Vec3]:
        length = (p.box or (0.0, 0.0, 0.0))[axis]
        found: List[Vec3] = []
        for i in range(p.model_count):
            at = [0.0, 0.0, 0.0]
            at[axis] = i * length / p.model_count - length / 2
            found.append((at[0], at[1], at[2]))
        return found

    return place


_RULES: Dict[str, Callable[[Population, random.Random], List[Vec3]]] = {
    "random": _random, "uniform": _uniform, "grid": _grid,
    "linear-x": _along(0), "linear-y": _along(1), "linear-z": _along(2),
}
