"""SDF worlds: models, lights, physics, and kept elements."""
from __future__ import annotations

import copy
from typing import Any, Callable, Dict, List, Sequence, Set, Tuple

from ...description.actor import Actor
from ...description.cost_budget import Cost, cost_of, world_excess
from ...description.light import Light
from ...description.model import Link, Model
from ...description.saved_state import LightState, LinkState, ModelState, SavedState
from ...description.validate import link_names
from ...description.world import Physics, World
from ...geometry import is_finite
from ...xml_characters import hidden_character, without_hidden
from ..xml.binding import Found, fill, to_xml
from ..xml.source import FaultLevel, Source
from ..xml.values import BOOL, parse_numbers
from .frame_graph import FrameError, FrameTree
from .include import read_include
from .joint import InterModelJointReader, UnresolvedJoint, is_complete, read_joint
from .light import LightPlacement, read_light
from .link import relative_to
from .model import read_model
from .model_tables import FRAME, PHYSICS, WORLD
from .parsed_model import ParsedModel, add_frames_inside
from .plugin import read_plugin
from .population import read_population
from .state_applied import state_issues
from .world_scene import read_surroundings
from .world_tables import LIGHT_STATE, LINK_STATE, MODEL_STATE, STATE

MOST_UNUSABLE = 2000
"""Most models of a world that are skipped because of faults; each takes 0.2 ms to read."""


def read_world_element(element: Any, source: Source, seed: int = 0, profile: str = "") -> World:
    """A world; models with a fatal fault are skipped. Source: SDF spec 1.7, world.

    `seed` and `profile` as for `reading.read_world`.
    """
    world = World(_shown_name(element, source), file=source.file, seed=seed)
    found = fill(world, element, WORLD, source, world.extra)
    world.plugins = [read_plugin(plugin, source) for plugin in found.get("plugin", ())]
    _read_physics(found.get("physics", ()), world, source, profile)
    read_surroundings(found, world, source)
    _Entities(world, source, found).read(element)
    for state in found.get("state", ())[:1]:
        world.state = read_state(state, source)
        for issue in state_issues(world):
            source.log.add(issue)
    return world


def _shown_name(element: Any, source: Source) -> str:
    """The name of a world, in which characters that are not shown as they are become blanks."""
    name = element.get("name") or "default"
    shown: str = without_hidden(name)
    if shown != name:
        source.tolerate(
            "name-characters", f"the name of the world contains {hidden_character(name)},"
            f" which is not shown; read as {shown!r}", element)
    return shown


class _Entities:
    """The models and lights of a world, in the order of the file."""

    def __init__(self, world: World, source: Source, found: Found) -> None:
        self._world = world
        self._source = source
        self._models: Set[str] = set()
        self._lights: Set[str] = set()
        self._frames = FrameTree("world")
        self._waiting: List[Any] = []  # (model or light, element)
        self._found = found
        self._inner: List[Tuple[ParsedModel, Any]] = []
        self._pending: List[UnresolvedJoint] = []
        self._cost = Cost()
        self._full = False

    def read(self, element: Any) -> None:
        readers: Dict[str, Callable[[Any], Any]] = {
            "model": lambda child: read_model(child, self._source, alone=False),
            "include": lambda child: read_include(child, self._source, read_model, alone=False),
            "light": lambda child: read_light(child, self._source),
            "population": lambda child: read_population(child, self._source, self._world.seed),
        }
        unusable = 0
        for child in element:
            reader = readers.get(child.tag)
            if reader is None or (self._full and child.tag != "light"):
                continue
            before = self._source.log.fatal
            entity = reader(child)
            if (entity is not None and self._source.log.fatal == before
                    and self._add(entity, child)):
                continue
            unusable += 1
            if unusable > MOST_UNUSABLE and not self._full:
                self._full = True
                self._source.report(FaultLevel.ERROR, "world-too-large", f"{unusable} models or"
                                    " lights of the world cannot be used; the following models are"
                                    " skipped", child)
        self._declare_frames()
        self._place()
        self._connect()

    def _add(self, entity: Any, element: Any) -> bool:
        """Add an entity to the world; False if its name is taken or there is no room."""
        if isinstance(entity, list):  # of a population
            return all([self._add(ParsedModel(model), element) for model in entity])
        elif isinstance(entity, Actor):
            entity.include = to_xml(element)
            self._world.actors.append(entity)
        elif isinstance(entity, ParsedModel):
            model = entity.model
            if not (self._is_new(model.name, self._models, "model", element)
                    and self._fits(model, element)):
                return False
            self._world.models.append(model)
            self._frames.add(model.name, model.pose, entity.relative_to, element)
            self._inner.append((entity, element))
            self._pending += [one.moved_out(model.name) for one in entity.unresolved_joints]
            if entity.relative_to:
                self._waiting.append((model, element))
        elif isinstance(entity, LightPlacement):
            light: Light = entity.light
            if not self._is_new(light.name, self._lights, "light", element):
                return False
            self._world.lights.append(light)
            if entity.relative_to:
                self._frames.add(f"(light) {light.name}", light.pose, entity.relative_to,
                                 element)
                self._waiting.append((light, element))
        return True

    def _fits(self, model: Model, element: Any) -> bool:
        """Whether the world has room for the model; otherwise no further one is read."""
        cost = self._cost + cost_of(model)
        excess = world_excess(cost)
        if not excess:
            self._cost = cost
        elif not self._full:
            self._full = True
            self._source.report(FaultLevel.ERROR, "world-too-large", f"{excess}; this model and"
                                " the following ones are skipped", element)
        return not excess

    def _is_new(self, name: str, names: Set[str], kind: str, element: Any) -> bool:
        if name in names:
            self._source.warn("name-repeated", f"there are two {kind}s named {name!r}; the second"
                              " is skipped", element)
            return False
        names.add(name)
        return True

    def _declare_frames(self) -> None:
        """Declare the frames of the world, and those inside models if referred to."""
        for element in self._found.get("frame", ()):
            probe = Link(element.get("name", ""))
            inside = fill(probe, element, FRAME, self._source, [])
            attached = element.get("attached_to") or ""
            self._frames.add(probe.name, probe.pose, relative_to(inside) or attached, element,
                             attached)
        if self._waiting or self._pending or self._found.get("frame") or self._found.get("joint"):
            for placement, element in self._inner:
                add_frames_inside(self._frames, placement, element)

    def _connect(self) -> None:
        """Connect the joints between models; the world keeps those whose links exist."""
        joints = self._found.get("joint", ())  # of SDF 1.10
        if not (self._pending or joints):
            return
        links = {f"{model.name}::{name}" for model in self._world.models
                 for name in link_names(model)}
        between = InterModelJointReader(links, self._frames, self._source)
        for element in joints:
            one = UnresolvedJoint(*read_joint(element, self._source), element)
            if is_complete(one, self._source) and between.connect(one):
                self._world.joints.append(one.joint)
        for one in self._pending:
            if between.connect(one):
                self._world.joints.append(one.joint)

    def _place(self) -> None:
        for entity, element in self._waiting:
            name = entity.name if isinstance(entity, Model) else f"(light) {entity.name}"
            try:
                entity.pose = self._frames.pose(name)
            except FrameError as fault:
                self._source.tolerate("frame-unknown", f"{fault}; the pose of {entity.name!r} is"
                                      " taken in the world", element)


def _read_physics(elements: Sequence[Any], world: World, source: Source, profile: str) -> None:
    """Read the preset `profile`, else the default one, else the first; keep the others."""
    chosen = next((e for e in elements if _is_default(e)), elements[0] if elements else None)
    if profile:
        named = {e.get("name"): e for e in reversed(elements) if e.get("name")}
        if profile not in named:
            source.warn("physics-profile", f"the world has no physics preset {profile!r}",
                        elements[0].getparent() if elements else None,
                        hint=f"it has: {', '.join(sorted(named)) or 'none with a name'}")
        chosen = named.get(profile, chosen)
    for element in elements:
        if element is not chosen:
            # Exactly one is the default, so that a saved world selects the same preset.
            world.extra.append(to_xml(_without_default(element)))
    if chosen is None:
        return
    kept: List[str] = []
    physics = Physics()
    fill(physics, chosen, PHYSICS, source, kept)
    world.extra += [f"<physics>{xml}</physics>" for xml in kept]
    _check_physics(physics, chosen, source)
    world.physics = physics


def _without_default(element: Any) -> Any:
    spare = copy.deepcopy(element)
    spare.attrib.pop("default", None)
    return spare


def _is_default(element: Any) -> bool:
    try:
        return BOOL.parse(element.get("default") or "false")
    except ValueError:
        return False


def _check_physics(physics: Physics, element: Any, source: Source) -> None:
    usual = Physics()
    instead: List[str] = []
    if not is_finite(physics.max_step_size) or physics.max_step_size <= 0:
        physics.max_step_size = usual.max_step_size
        instead.append(f"max_step_size is out of range; {usual.max_step_size:g} s is used")
    if physics.real_time_update_rate < 0:
        physics.real_time_update_rate = 0.0
        instead.append("real_time_update_rate is negative; the simulation runs as fast as possible")
    if physics.ode.iters < 1:
        physics.ode.iters = usual.ode.iters
        instead.append(f"ode/solver/iters is out of range; {usual.ode.iters} is used")
    for message in instead:
        source.tolerate("physics-range", message, element)


def read_state(element: Any, source: Source) -> SavedState:
    """The state as written; `state_applied.apply_state` applies it to the world."""
    state = SavedState()
    found = fill(state, element, STATE, source, [])
    for child in found.get("model", ()):
        state.models.append(_model(child, source))
    for child in found.get("light", ()):
        light = LightState(child.get("name", ""))
        fill(light, child, LIGHT_STATE, source, [])
        state.lights.append(light)
    for child in found.get("insertions", ()):
        _insertions(child, state, source)
    return state


def _model(element: Any, source: Source) -> ModelState:
    state = ModelState(element.get("name", ""))
    _into(state, element, "", source)
    return state


def _into(state: ModelState, element: Any, scope: str, source: Source) -> None:
    """Add links and joints of a model and of its nested models, by scoped names."""
    own = state if not scope else ModelState("")
    found = fill(own, element, MODEL_STATE, source, [])
    for child in found.get("link", ()):
        link = LinkState(scope + child.get("name", ""))
        fill(link, child, LINK_STATE, source, [])
        if child.find("pose") is not None:
            state.links.append(link)
    for child in found.get("joint", ()):
        state.joints[scope + child.get("name", "")] = _angles(child, source)
    for child in found.get("model", ()):
        _into(state, child, f"{scope}{child.get('name', '')}::", source)


def _angles(element: Any, source: Source) -> List[float]:
    angles: List[float] = []
    for angle in element.iterfind("angle"):
        try:
            angles.append(parse_numbers(angle.text or "", 1)[0])
        except ValueError as fault:
            source.report(FaultLevel.WARNING, "bad-value", f"<angle>: {fault}", angle)
    return angles


def _insertions(element: Any, state: SavedState, source: Source) -> None:
    for child in element:
        before = source.log.fatal
        if child.tag == "model":
            placement = read_model(child, source)
            if source.log.fatal == before:
                state.inserted_models.append(placement.model)
        elif child.tag == "light":
            light = read_light(child, source).light
            if source.log.fatal == before:
                state.inserted_lights.append(light)
