"""Reads URDF robots as models. Source: the URDF specification and Gazebo's converter."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Union

from ...description.cost_budget import MODEL_BUDGET, budget_faults, cost_of
from ...description.model import WORLD, Joint, JointAxis, Link, Model
from ...description.validate import closest_name_hint, find_faults
from ...errors import Issue, Severity
from ...geometry import IDENTITY, Pose, compose
from ..include_overrides import IncludeOverrides
from ..inertia import usable_inertia
from ..sdf.sensor_parameters import kept_sensors
from ..xml.binding import fill
from ..xml.source import FaultLevel, Source
from .fixed_joint_lumping import Renamed, lump, lumped_into, rename
from .gazebo_extensions import Extensions, move_to_lumped_link
from .gazebo_sdf import add_sdf_links, read_sdf_joint
from .joint import read_connection, turned_to
from .kinematic_tree import LUMP, Body, Connection, parents_first
from .link import read_body, read_origin, read_palette
from .transmission import read_transmission
from .urdf_tables import ROBOT

MOST_LINKS = 5 * MODEL_BUDGET.links
"""Most links of a file; those that fixed joints lump do not count in the budget of a model."""


def read_robot(element: Any, source: Source, changes: Optional[IncludeOverrides] = None) -> Model:
    """A robot; faults that make it unusable are counted as fatal in the source's log.

    Links are in depth-first order, siblings by joint name; the first is the canonical link. Fixed
    joints are lumped; links without mass are dropped with all links below them. Link poses are in
    the model frame, joint axes in the joint frame, which is the child's link frame.
    """
    return _RobotReader(element, source, changes or IncludeOverrides()).read()


class _RobotReader:
    def __init__(self, element: Any, source: Source, changes: IncludeOverrides) -> None:
        self._element = element
        self._source = source
        self._changes = changes
        self._model = Model(element.get("name", ""))
        self._bodies: Dict[str, Body] = {}
        self._connections: List[Connection] = []
        self._elements: Dict[int, Any] = {}
        self._renamed = Renamed()

    def read(self) -> Model:
        source, model, changes = self._source, self._model, self._changes
        # Values of the model are all in `<gazebo>`; a `static` attribute has no effect.
        found = fill(model, self._element, ROBOT, source, [])
        extensions = Extensions(found.get("gazebo", ()), source)
        extensions.to_model(model)
        model.pose = read_origin(found.get("origin", ()), source)
        if changes.name is not None:
            model.name = changes.name
        if changes.pose is not None:
            model.pose = changes.pose
        if changes.static is not None:
            model.static = changes.static
        model.plugins += changes.plugins
        self._elements[id(model)] = self._element
        if self._has_too_many(found.get("link", ())):
            return model
        self._read_bodies(found.get("link", ()), read_palette(found.get("material", ()), source))
        self._read_connections(found.get("joint", ()))
        for body in self._bodies.values():
            extensions.to_link(body)
        for connection in self._connections:
            extensions.to_connection(connection)
        extensions.report_unused()
        model.transmissions = [read_transmission(child, source)
                               for child in found.get("transmission", ())]
        root = self._root()
        if root is not None:
            poses = self._build(root)
            rename(model, self._renamed)
            self._read_sensors()
            self._elements.update(add_sdf_links(extensions.links, source, model, self._bodies,
                                                poses))
            for child in extensions.joints:
                joint = read_sdf_joint(child, source, self._bodies, poses, model.name)
                if joint is not None:
                    self._elements[id(joint)] = child
                    model.joints.append(joint)
        self._check()
        return model

    def _has_too_many(self, links: Sequence[Any]) -> bool:
        """Whether the robot has so many links that it is refused before they are read."""
        if len(links) <= MOST_LINKS:
            return False
        self._fatal("model-too-large", f"model {self._model.name!r} has {len(links)} links;"
                    f" {MOST_LINKS} are possible before fixed joints are lumped", links[MOST_LINKS])
        return True

    def _read_sensors(self) -> None:
        """Read sensors from the kept XML of links and joints, after lumping has changed it."""
        lines = {element.get("name", ""): element.sourceline
                 for element in self._element.iter("sensor")}
        holders: List[Union[Link, Joint]] = [*self._model.links, *self._model.joints]
        for holder in holders:
            holder.sensors = kept_sensors(holder.extra, self._source, lines)

    def _read_bodies(self, elements: Any, palette: Any) -> None:
        for element in elements:
            body = read_body(element, self._source, self._model.static, palette)
            name = body.link.name
            if not name:
                self._fatal("name-empty", "a link has no name", element)
            elif name in self._bodies:
                self._fatal("name-repeated", f"there are two links named {name!r}", element)
            else:
                self._bodies[name] = body

    def _read_connections(self, elements: Any) -> None:
        names = set()
        for element in elements:
            name = element.get("name", "")
            if not name:
                self._fatal("name-empty", "a joint has no name", element)
            elif name in names:
                self._fatal("name-repeated", f"there are two joints named {name!r}", element)
            names.add(name)
            connection = read_connection(element, self._source, self._bodies)
            if connection is None:
                continue
            if not self._keep_last_parent(connection):
                continue
            self._connections.append(connection)
            connection.child.up = connection
            connection.parent.down.append(connection)
        for body in self._bodies.values():
            body.down.sort(key=lambda c: c.joint.name)

    def _keep_last_parent(self, connection: Connection) -> bool:
        """Keep the last joint by name of those with one child (urdfdom), and report the other.

        Returns whether `connection` is used; a joint that it replaces is removed.
        """
        other = connection.child.up
        if other is None:
            return True
        first, last = sorted((other, connection), key=lambda one: one.joint.name)
        self._source.tolerate("link-two-parents", f"link {connection.joint.child!r} is the child of"
                              f" joint {other.joint.name!r} and of joint {connection.joint.name!r};"
                              f" {first.joint.name!r} is skipped", connection.element,
                              "links and joints of a robot form a tree")
        if first is connection:
            return False
        self._connections.remove(other)
        other.parent.down.remove(other)
        return last is connection

    def _root(self) -> Optional[Body]:
        roots = [body for body in self._bodies.values() if body.up is None]
        if not self._bodies:
            self._fatal("link-missing", "the robot has no link", self._element)
        elif not roots:
            self._fatal("root-missing", "every link of the robot is the child of a joint: there is"
                        " no root", self._element)
        elif len(roots) > 1:
            names = ", ".join(repr(body.link.name) for body in roots)
            self._fatal("root-many", f"the robot has {len(roots)} root links: {names}",
                        roots[1].element, "connect them with joints")
        elif sum(1 for _ in parents_first(roots[0])) < len(self._bodies):
            self._fatal("joint-cycle", "some joints of the robot form a cycle", self._element)
        else:
            return roots[0]
        return None

    def _build(self, root: Body) -> Dict[str, Pose]:
        """Assemble links and joints; returns the model-frame poses of all links of the file."""
        model = self._model
        frames = lump(root)
        dropped = self._find_unsimulated_bodies(root)
        poses: Dict[str, Pose] = {}
        for body in parents_first(root):
            up = body.up
            above = poses[up.parent.link.name] if up is not None else IDENTITY
            poses[body.link.name] = compose(above, up.origin) if up is not None else IDENTITY
            if body is root and body.link.name == WORLD:
                self._warn_about_world(body)
            elif body.into is None and id(body) not in dropped:
                body.link.pose = poses[body.link.name]
                self._finish(body)
                if up is not None:
                    if up.joint.axis is not None:
                        turned_to(up.joint.axis, poses[body.link.name].orientation)
                    self._joint(up)
            elif body.into is not None:
                self._move_settings(body)
                self._renamed.links[body.link.name] = body
        model.extra += frames
        if not model.links and root.link.name != WORLD:
            self._source.tolerate("link-missing", f"no link of the robot has a mass: its root"
                                  f" {root.link.name!r} is skipped with all below it, and the"
                                  " model is empty", root.element,
                                  "give it an <inertial>, or make the model static")
        return poses

    def _find_unsimulated_bodies(self, root: Body) -> Dict[int, Body]:
        """Bodies that cannot be simulated: those without mass, and those below them.

        A static model keeps them.
        """
        dropped: Dict[int, Body] = {}
        if self._model.static:
            return dropped
        for body in parents_first(root):
            stands = lumped_into(body)
            up = stands.up
            below = up is not None and id(lumped_into(up.parent)) in dropped
            massless = stands.inertial is None or stands.inertial.mass <= 0
            is_world = stands is root and root.link.name == WORLD
            if below or (massless and not is_world):
                dropped[id(body)] = body
                if body is stands and not below:
                    self._source.warn(
                        "link-massless", f"link {body.link.name!r} has no mass; it is skipped with"
                        f" {len(list(parents_first(body))) - 1} links below it", body.element,
                        "a link that can move needs an <inertial> with a mass above 0",
                    )
        return dropped

    def _finish(self, body: Body) -> None:
        """Add the collected collisions and visuals to the link."""
        link = body.link
        if body.inertial is not None:
            link.inertial = body.inertial
        link.collisions = [self._name_shape(c, stem, "collision", n, body)
                           for n, (stem, c) in enumerate(body.collisions)]
        link.visuals = [self._name_shape(v, stem, "visual", n, body)
                        for n, (stem, v) in enumerate(body.visuals)]
        if not self._model.static:
            self._complete_inertia(body)
        for thing in (link, link.inertial, *link.collisions, *link.visuals):
            self._elements[id(thing)] = body.element
        self._model.links.append(link)

    def _complete_inertia(self, body: Body) -> None:
        body.link.inertial = usable_inertia(body.link, self._source, body.element)

    def _name_shape(self, item: Any, stem: str, kind: str, number: int, body: Body) -> Any:
        """Give a shape its name as sdformat 9 does (CreateCollision, CreateVisual of
        parser_urdf.cc): lumped or not, it has the link's name in front.
        """
        own = stem[len(LUMP):] if stem.startswith(LUMP) else stem
        prefix = "" if own.startswith(body.link.name) else body.link.name + LUMP
        item.name = f"{prefix}{own}_{kind}" + (f"_{number}" if number else "")
        if kind == "collision" and (prefix or stem.startswith(LUMP)):
            before = sum(1 for other, _ in body.collisions[:number] if other == stem)
            self._renamed.collisions[f"{own}_{kind}" + (f"_{before}" if before else "")] = item.name
        return item

    def _joint(self, connection: Connection) -> None:
        joint = connection.joint
        if joint.type in ("floating", "planar"):
            self._source.warn("joint-unsupported", f"joint {joint.name!r} of type {joint.type} is"
                              " not simulated, as in Gazebo: its links are not connected",
                              connection.element)
            return
        joint.parent = lumped_into(connection.parent).link.name
        if joint.type == "fixed" and connection.keep == "revolute":
            joint.type, joint.axis = "revolute", JointAxis(lower=0.0, upper=0.0)
        self._elements[id(joint)] = connection.element
        self._model.joints.append(joint)

    def _move_settings(self, body: Body) -> None:
        """Move other settings of a lumped link to its new link.

        Where both set one, the later link counts for turnGravityOff and selfCollide, and the
        earlier one for dampingFactor (sdformat 9, parser_urdf.cc: InsertSDFExtensionLink).
        """
        link, whole = body.link, lumped_into(body)
        to = whole.link
        to.extra += [move_to_lumped_link(xml, body.offset) for xml in link.extra]
        if to.self_collide is None or "selfCollide" in body.set_tags:
            to.self_collide = link.self_collide if link.self_collide is not None \
                else to.self_collide
        had_gravity = to.gravity
        if "turnGravityOff" in body.set_tags:
            to.gravity = link.gravity
        else:
            to.gravity = to.gravity and link.gravity
        if had_gravity and not to.gravity and to.name != WORLD:
            self._source.warn("lumped-gravity", f"link {link.name!r} has no gravity, so {to.name!r}"
                              " has none either: a fixed joint connects them, as in Gazebo",
                              body.element)
        to.kinematic = to.kinematic or link.kinematic
        if "dampingFactor" not in whole.set_tags:
            to.linear_decay = to.linear_decay or link.linear_decay
            to.angular_decay = to.angular_decay or link.angular_decay
        whole.set_tags |= body.set_tags

    def _warn_about_world(self, body: Body) -> None:
        if body.collisions or body.visuals:
            self._source.warn("world-shapes", "the link `world` stands for the world itself; its"
                              " shapes are skipped", body.element)

    def _check(self) -> None:
        known = [joint.name for joint in self._model.joints]
        for joint in self._model.joints:
            mimic = joint.axis.mimic if joint.axis is not None else None
            if mimic is not None and mimic.joint not in known:
                self._source.warn("mimic-joint-unknown", f"joint {joint.name!r} follows"
                                  f" {mimic.joint!r}, which is not a joint of the model",
                                  self._elements[id(joint)], closest_name_hint(mimic.joint, known))
        for fault in (*find_faults(self._model), *budget_faults(cost_of(self._model), self._model)):
            element = self._elements.get(id(fault.subject), self._element)
            self._source.log.add(
                Issue(fault.severity, fault.code, fault.message, hint=fault.hint,
                      **self._source.where(element)),
                fatal=fault.severity is Severity.ERROR,
            )

    def _fatal(self, code: str, message: str, element: Any, hint: str = "") -> None:
        self._source.report(FaultLevel.FATAL, code, message, element, hint)


