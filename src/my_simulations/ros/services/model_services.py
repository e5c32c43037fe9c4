"""spawn_urdf_model, spawn_sdf_model (models and lights) and delete_model."""
from __future__ import annotations

from dataclasses import replace as with_changes
from typing import Any, Callable, List, Optional

from ...description.compare import differences
from ...description.flatten import flattened
from ...description.model import Model
from ...description.world import Light
from ...errors import CommandError, InputError, Issue, Severity, errors_of
from ...formats.mesh.loading import collision_meshes
from ...formats.reading import read_entity
from ...geometry import IDENTITY, Pose, compose
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ...simulator.spawn_advice import arrival_advice
from ..message_conversion import LENGTH, pose_from_message, within
from .entity_errors import in_gazebos_words
from .spawn_request import (
    FILE_ATTRIBUTE,
    MARK,
    asks_to_replace,
    checked_name,
    launched_by,
    named,
    root_of,
)

SAME = 1e-9
"""Numbers that differ by less, in their unit or relative to their size, are the same."""

NO_FRAME = "reference reference_frame not found"


class ModelServices:
    """Puts models into the world and takes them out."""

    def __init__(self, simulator: Simulator, resolver: Resolver,
                 log: Callable[[Issue], None], launcher: int = 0,
                 changed: Callable[[], None] = lambda: None) -> None:
        """Take over a simulator.

        Args:
            simulator: the world.
            resolver: finds what models name.
            log: hears of faults.
            launcher: process id of the roslaunch that started the simulator, 0 for none.
            changed: called after a model has come or gone, before that is answered.
        """
        self._launcher = launcher
        self._changed = changed
        self._simulator = simulator
        self._resolver = resolver
        self._log = log

    def spawn_urdf(self, request: Any, _response: Any) -> str:
        """A URDF document; any other root is refused, as in Gazebo."""
        root, _ = root_of(request.model_xml)
        if root not in ("robot", ""):
            raise CommandError("Failure - entity format is invalid. The root element of a URDF is "
                               f"<robot>, here it is <{root}>; use spawn_sdf_model for SDF")
        return self._spawn(request)

    def spawn_sdf(self, request: Any, _response: Any) -> str:
        """An SDF document, or a URDF one."""
        return self._spawn(request)

    def _spawn(self, request: Any) -> str:
        name = checked_name(request.model_name)
        initial = pose_from_message(request.initial_pose, "initial_pose")
        marks = root_of(request.model_xml)[1]
        replaces, launched = asks_to_replace(marks), launched_by(marks, self._launcher)
        there = self._simulator.models.has(name)
        if there and not replaces and not (launched and self._is_the_worlds(name)):
            raise CommandError(f"Failure - entity already exists. (model {name!r})")
        return self.spawn_text(request.model_xml, name, initial,
                               frame=request.reference_frame, namespace=request.robot_namespace,
                               replace=replaces, launched=launched,
                               file=f"model '{name}', {marks.get(FILE_ATTRIBUTE) or 'model_xml'}")

    def spawn_text(self, text: str, name: Optional[str], initial: Pose = IDENTITY, *,
                   frame: str = "", namespace: str = "", replace: bool = False,
                   launched: bool = False, file: str = "model_xml") -> str:
        """Put the model or light of a document into the world.

        Args:
            text: URDF or SDF.
            name: its name in the world; None for the document's own.
            initial: pose in `frame`; the document's own pose is composed onto it, and with
                several frames T_frame o T_initial o T_own is where the model goes (Gazebo).
            frame: "" or a literal for the world, else a model or link.
            namespace: for plugins that name none.
            replace: take a model of that name out in the same step.
            launched: by the launch file of the simulator: where the world has that very model
                already, it is taken for it.
            file: what messages call the document.

        Returns:
            What to tell the client.

        Raises:
            InputError: the document describes no whole model.
            CommandError: the world refuses it.
        """
        entity, issues = read_entity(text, self._resolver, file=file)
        if not isinstance(entity, Model):
            self._report(issues)
            return self._spawn_light(entity, name, initial, frame)
        model = named(entity, name if name is not None else entity.name, namespace)
        meshes, mesh_issues = collision_meshes(model)
        # Every message about the attribute is about what was read from it already.
        issues = [issue for issue in (*issues, *mesh_issues)
                  if MARK not in issue.message]
        self._report(issues)
        if errors_of(issues):
            raise InputError(issues)
        if launched and not replace and self._is_the_worlds(model.name):
            return self._adopt(model)
        where = compose(initial, model.pose)
        within(where.position, LENGTH, "m", "the model's position")
        with in_gazebos_words("", NO_FRAME):
            self._simulator.models.spawn(model, where, frame, meshes, replace, launched=launched)
        self._changed()
        self._report(arrival_advice(self._simulator, model.name, meshes))
        remarks = sum(issue.severity is not Severity.NOTE for issue in issues)
        warnings = f" ({remarks} remarks in the log)" if remarks else ""
        return f"Successfully spawned entity{warnings}"

    def _is_the_worlds(self, name: str) -> bool:
        """Whether there is a model of that name, which the world file brought."""
        return self._simulator.models.has(name) and any(
            model.name == name for model in self._simulator.world.models)

    def _adopt(self, model: Model) -> str:
        """Take the world's model for the one that was to be spawned, if they are the same."""
        here = self._simulator.models.get(model.name)
        other = differences(with_changes(here, pose=IDENTITY, name=""),
                            with_changes(flattened(model), pose=IDENTITY, name=""), SAME)
        world = self._simulator.world.file
        if other:
            raise CommandError(
                f"Failure - entity already exists. (model {model.name!r}: {world} holds one that"
                f" is described otherwise, in {other[0]}; take it out of that file, or out of the"
                " launch file)")
        return (f"{world} holds '{model.name}' already, as described; it stays where the world has"
                " it")

    def _spawn_light(self, light: Light, name: Optional[str], initial: Pose, frame: str) -> str:
        light = with_changes(light, name=light.name if name is None else name,
                             pose=compose(initial, light.pose))
        if any(one.name == light.name for one in self._simulator.lights.all()):
            raise CommandError(f"Failure - entity already exists. (light {light.name!r})")
        with in_gazebos_words("", NO_FRAME):
            self._simulator.lights.add(light, frame)
        return "Successfully spawned entity"

    def _report(self, issues: List[Issue]) -> None:
        for issue in issues:
            self._log(issue)

    def delete(self, request: Any, _response: Any) -> str:
        """Take a model out; it is in no list any more when this answers."""
        with in_gazebos_words("model does not exist"):
            self._simulator.models.delete(request.model_name)
        self._changed()
        return "successfully deleted model"


