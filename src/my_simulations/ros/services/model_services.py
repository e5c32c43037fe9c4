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
from .entity_errors import gazebo_prefix
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
"""Tolerance, absolute in the value's unit or relative, below which values are equal."""

NO_FRAME = "reference reference_frame not found"


class ModelServices:
    """Spawns and deletes models, and spawns lights."""

    def __init__(self, simulator: Simulator, resolver: Resolver,
                 log: Callable[[Issue], None], launcher: int = 0) -> None:
        """`launcher`: process id of the roslaunch that started the simulator, 0 for none."""
        self._launcher = launcher
        self._simulator = simulator
        self._resolver = resolver
        self._log = log

    def spawn_urdf(self, request: Any, _response: Any) -> str:
        """Spawn a URDF model; any other root element is rejected (Gazebo behaviour)."""
        root, _ = root_of(request.model_xml)
        if root not in ("robot", ""):
            raise CommandError("Failure - entity format is invalid. The root element of a URDF is "
                               f"<robot>, here it is <{root}>; use spawn_sdf_model for SDF")
        return self._spawn(request)

    def spawn_sdf(self, request: Any, _response: Any) -> str:
        """Spawn an SDF or URDF model, or an SDF light."""
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
        """Spawn the model or light of a document.

        Args:
            text: URDF or SDF.
            name: name in the world; None for the document's own.
            initial: pose in `frame`; the document's own pose is composed onto it: the model's
                world pose is T_frame o T_initial o T_own (Gazebo behaviour).
            frame: "" or a name of the world frame, else a model or link.
            namespace: robotNamespace of plugins that set none.
            replace: delete a model of that name in the same step.
            launched: spawned by the launch file of the simulator: if the world file contains the
                same model already, that one is kept.
            file: name of the document in messages.

        Returns:
            The status message.

        Raises:
            InputError: the document contains no usable model.
            CommandError: the name is taken, or the engine rejected the model.
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
        within(where.position, LENGTH, "m", "position of the model")
        with gazebo_prefix("", NO_FRAME):
            self._simulator.models.spawn(model, where, frame, meshes, replace, launched=launched)
        self._report(arrival_advice(self._simulator, model.name, meshes))
        warned = sum(issue.severity is not Severity.NOTE for issue in issues)
        counted = "1 warning" if warned == 1 else f"{warned} warnings"
        return "Successfully spawned entity" + (f" ({counted}, see log)" if warned else "")

    def _is_the_worlds(self, name: str) -> bool:
        """Whether the world file contains a model of that name, which still exists."""
        return self._simulator.models.has(name) and any(
            model.name == name for model in self._simulator.world.models)

    def _adopt(self, model: Model) -> str:
        """Keep the world file's model instead of spawning, if both are equal."""
        here = self._simulator.models.get(model.name)
        other = differences(with_changes(here, pose=IDENTITY, name=""),
                            with_changes(flattened(model), pose=IDENTITY, name=""), SAME)
        world = self._simulator.world.file
        if other:
            raise CommandError(
                f"Failure - entity already exists. (model {model.name!r}: {world} contains a model"
                f" of that name that differs in {other[0]}; remove it from that file or from the"
                " launch file)")
        return (f"{world} already contains an identical model '{model.name}'; kept at its pose in"
                " the world file")

    def _spawn_light(self, light: Light, name: Optional[str], initial: Pose, frame: str) -> str:
        light = with_changes(light, name=light.name if name is None else name,
                             pose=compose(initial, light.pose))
        if any(one.name == light.name for one in self._simulator.lights.all()):
            raise CommandError(f"Failure - entity already exists. (light {light.name!r})")
        with gazebo_prefix("", NO_FRAME):
            self._simulator.lights.add(light, frame)
        return "Successfully spawned entity"

    def _report(self, issues: List[Issue]) -> None:
        for issue in issues:
            self._log(issue)

    def delete(self, request: Any, _response: Any) -> str:
        """Delete a model; it is gone when this returns."""
        with gazebo_prefix("model does not exist"):
            self._simulator.models.delete(request.model_name)
        return "successfully deleted model"


