"""Applies a saved state to the world it was saved from.

Source: Gazebo behaviour. Insertions come first, then poses, scales and velocities, then deletions.
Unknown names are skipped.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Dict, List, Optional, Set, Tuple

from ...description.compare import differences
from ...description.flatten import flatten_model
from ...description.joint_positions import joint_position, moved_child_pose
from ...description.light import Light
from ...description.model import WORLD, Joint, Link, Model
from ...description.saved_state import InitialState, ModelState
from ...description.shapes import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Heightmap,
    ImageMap,
    Mesh,
    Plane,
    Polyline,
    Sphere,
)
from ...description.world import World
from ...errors import Issue, warning
from ...geometry import Pose, Twist, Vec3, compose, inverse

_NEAR = 1e-4
"""m, and components of a quaternion: saved poses have few digits."""
_ONE: Vec3 = (1.0, 1.0, 1.0)


def apply_state(world: World) -> World:
    """The world in its saved state; the same world if it has no `<state>`.

    The links of a model without joints are moved. A model with joints is moved by its canonical
    link, and its joints get positions, because a joint is at 0 in the configuration of the
    description. `World.state` of the result is None.
    """
    state = world.state
    if state is None:
        return world
    models = [*world.models, *_new(state.inserted_models, world.models)]
    lights: List[Light] = [*world.lights, *_new(state.inserted_lights, world.lights)]
    initial = dict(world.initial)
    states = {one.name: one for one in state.models}
    models = [_restore_model(model, states[model.name], initial) if model.name in states else model
              for model in models]
    poses = {one.name: one.pose for one in state.lights}
    lights = [replace(light, pose=poses.get(light.name, light.pose)) for light in lights]
    gone = set(state.deletions)
    return replace(
        world, state=None, initial_ns=state.sim_time_ns,
        models=[model for model in models if model.name not in gone],
        lights=[light for light in lights if light.name not in gone],
        initial={name: start for name, start in initial.items() if name not in gone},
    )


def state_issues(world: World) -> List[Issue]:
    """A warning for each unknown name in the state, as in Gazebo."""
    state = world.state
    if state is None:
        return []
    models = {model.name for model in (*world.models, *state.inserted_models)}
    lights = {light.name for light in (*world.lights, *state.inserted_lights)}
    named = [*_unknown("model", [one.name for one in state.models], models),
             *_unknown("light", [one.name for one in state.lights], lights),
             *_unknown("model or light", state.deletions, models | lights)]
    return [warning("state-unknown", f"the saved state names a {kind} {name!r}, which the world"
                    " does not hold", file=world.file) for kind, name in named]


def _unknown(kind: str, names: List[str], known: Set[str]) -> List[Tuple[str, str]]:
    return [(kind, name) for name in names if name not in known]


def _new(inserted: List[Any], present: List[Any]) -> List[Any]:
    names = {one.name for one in present}
    found: List[Any] = []
    for one in inserted:
        if one.name not in names:
            names.add(one.name)
            found.append(one)
    return found


def _restore_model(model: Model, state: ModelState, initial: Dict[str, InitialState]) -> Model:
    model = scale_model(model, state.scale)
    links = {link.name: link for link in state.links}
    twists: Dict[str, Twist] = {name: link.twist for name, link in links.items()
                                if any(link.twist.linear) or any(link.twist.angular)}
    poses = {name: link.pose for name, link in links.items()}
    flat = flatten_model(model)
    if not flat.joints:
        model = _links_moved(replace(model, pose=state.pose or model.pose), poses, Pose())
        positions: Dict[str, float] = {}
    else:
        positions = _positions(flat.joints, flat.links, poses, state)
        held = _world_joint_positions(flat, poses)
        positions.update(held or {})
        if held is None:
            model = replace(model, pose=_base_pose(flat, poses, state) or model.pose)
        model = _links_moved(model, _loose(flat, poses), Pose())
    if twists or positions:
        initial[model.name] = InitialState(twists, positions)
    return model


def _world_joint_positions(flat: Model, poses: Dict[str, Pose]) -> Optional[Dict[str, float]]:
    """Positions of the joints to the world, if these say where their links are; else None.

    A joint's anchor stays where the model was; a model that was moved with its anchors is another.
    """
    at_zero = {WORLD: Pose(), **{link.name: compose(flat.pose, link.pose) for link in flat.links}}
    anchors = [joint for joint in flat.joints if joint.parent == WORLD and joint.child in poses
               and joint.child in at_zero]
    found: Dict[str, float] = {}
    for joint in anchors:
        position = joint_position(joint, at_zero, {WORLD: Pose(), **poses}) or 0.0
        there = moved_child_pose(joint, position, at_zero[joint.child])
        if differences(there, poses[joint.child], _NEAR):
            return None
        if position:
            found[joint.name] = position
    return found if anchors else None


def _loose(flat: Model, poses: Dict[str, Pose]) -> Dict[str, Pose]:
    """World poses, with joints at 0, of the links that no joint connects with the model's frame.

    Links that are connected move with the one on which the others hang.
    """
    at_zero = {link.name: link.pose for link in flat.links}
    children = {joint.child for joint in flat.joints}
    found: Dict[str, Pose] = {}
    for group in _group_connected_links(flat):
        if (flat.frame_link and flat.frame_link.name in group) or WORLD in group:
            continue
        root = next((name for name in group if name not in children), group[0])
        if root in poses:
            way = compose(poses[root], inverse(at_zero[root]))
            found.update((name, compose(way, at_zero[name])) for name in group)
    return found


def _group_connected_links(flat: Model) -> List[List[str]]:
    """The names of links in groups that joints connect, in order; WORLD is in groups on it."""
    groups = {link.name: [link.name] for link in flat.links}
    groups[WORLD] = [WORLD]
    for joint in flat.joints:
        one, other = groups.get(joint.parent), groups.get(joint.child)
        if one is None or other is None or one is other:
            continue
        one += other
        groups.update((name, one) for name in other)
    return list({id(group): group for group in groups.values()}.values())


def _base_pose(flat: Model, poses: Dict[str, Pose], state: ModelState) -> Optional[Pose]:
    """World pose of the model frame, from the pose of its canonical link."""
    link = flat.frame_link
    if link is None or link.name not in poses:
        return state.pose
    return compose(poses[link.name], inverse(link.pose))


def _links_moved(model: Model, poses: Dict[str, Pose], above: Pose, scope: str = "") -> Model:
    base = compose(above, model.pose)
    links = [replace(link, pose=compose(inverse(base), poses[scope + link.name]))
             if scope + link.name in poses else link for link in model.links]
    return replace(model, links=links, models=[
        _links_moved(inner, poses, base, f"{scope}{inner.name}::") for inner in model.models
    ])


def _positions(joints: List[Joint], links: List[Link], poses: Dict[str, Pose],
               state: ModelState) -> Dict[str, float]:
    """Positions of the joints: from the link poses if possible, else from the saved angles."""
    at_zero = {link.name: link.pose for link in links}
    found: Dict[str, float] = {}
    for joint in joints:
        position = joint_position(joint, at_zero, poses)
        if position is None and len(state.joints.get(joint.name, ())) == 1:
            position = state.joints[joint.name][0]
        if position:
            found[joint.name] = position
    return found


def scale_model(model: Model, factor: Vec3) -> Model:
    """Scale the shapes of a model along the axes of their own frames.

    Positions of shapes within their link are scaled, too; poses of links are not, because the state
    holds them. Mass and inertia are unchanged (Gazebo behaviour).
    """
    if factor == _ONE:
        return model

    def resized(item: Any) -> Any:
        return replace(item, geometry=scale_geometry(item.geometry, factor),
                       pose=Pose(_times(item.pose.position, factor), item.pose.orientation))

    links = [replace(link, collisions=[resized(item) for item in link.collisions],
                     visuals=[resized(item) for item in link.visuals]) for link in model.links]
    return replace(model, links=links,
                   models=[scale_model(inner, factor) for inner in model.models])


def _times(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


def scale_geometry(shape: Geometry, factor: Vec3) -> Geometry:
    """Scale a shape; round ones by the larger factor across their axis (Gazebo behaviour)."""
    across = max(abs(factor[0]), abs(factor[1]))
    if isinstance(shape, Box):
        return Box(_times(shape.size, factor))
    if isinstance(shape, Sphere):
        return Sphere(shape.radius * max(across, abs(factor[2])))
    if isinstance(shape, (Cylinder, Capsule, Cone)):
        return replace(shape, radius=shape.radius * across, length=shape.length * abs(factor[2]))
    if isinstance(shape, Ellipsoid):
        return Ellipsoid(_times(shape.radii, factor))
    if isinstance(shape, Mesh):
        return replace(shape, scale=_times(shape.scale, factor))
    if isinstance(shape, Plane):
        return replace(shape, size=(shape.size[0] * factor[0], shape.size[1] * factor[1]))
    if isinstance(shape, Heightmap):
        upwards = abs(factor[2])
        return replace(shape, size=_times(shape.size, factor), blends=[
            replace(blend, min_height=blend.min_height * upwards,
                    fade_dist=blend.fade_dist * upwards) for blend in shape.blends])
    if isinstance(shape, Polyline):
        return Polyline([[(x * factor[0], y * factor[1]) for x, y in loop]
                         for loop in shape.loops], shape.height * abs(factor[2]))
    if isinstance(shape, ImageMap):
        return replace(shape, scale=shape.scale * across, height=shape.height * abs(factor[2]))
    return shape
