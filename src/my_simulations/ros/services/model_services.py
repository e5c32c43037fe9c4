"""spawn_urdf_model, spawn_sdf_model, spawn_object (models and lights) and delete_model."""
from __future__ import annotations

from dataclasses import replace as with_changes
from typing import Any, Callable, List, Optional

from ...description.compare import differences
from ...description.flatten import flattened
from ...description.light import Light
from ...description.model import Model
from ...errors import CommandError, InputError, Issue, Severity, errors_of, warning
from ...formats.mesh.loading import collision_meshes
from ...formats.reading import ParsedDocument, parse_document
from ...geometry import IDENTITY, Pose, compose
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ...simulator.spawn_advice import arrival_advice
from ..message_conversion import LENGTH, pose_from_message, within
from .entity_errors import in_gazebos_words
from .spawn_request import (
    FILE_ATTRIBUTE,
    LAUNCH_ATTRIBUTE,
    REPLACE_ATTRIBUTE,
    SpawnOptions,
    checked_name,
    named,
    options_of_attributes,
)

SAME = 1e-9
"""Numbers that differ by less, in their unit or relative to their size, are the same."""

NO_FRAME = "reference reference_frame not found"


class ModelServices:
    """Puts models into the world and takes them out."""

    def __init__(self, simulator: Simulator, resolver: Resolver,
                 log: Callable[[Issue], None], launcher: int = 0) -> None:
        """`launcher`: process id of the roslaunch that started the simulator, 0 for none."""
        self._launcher = launcher
        self._simulator = simulator
        self._resolver = resolver
        self._log = log
        self._told_deprecated = False

    def spawn_urdf(self, request: Any, _response: Any) -> str:
        """A URDF document; any other root is refused, as in Gazebo."""
        document = self._parsed(request, "")
        if document.root_tag != "robot":
            raise CommandError("Failure - entity format is invalid. The root element of a URDF is "
                               f"<robot>, here it is <{document.root_tag}>; use spawn_sdf_model for"
                               " SDF")
        return self._spawn(request, document, self._attribute_options(request, document))

    def spawn_sdf(self, request: Any, _response: Any) -> str:
        """An SDF document, or a URDF one."""
        document = self._parsed(request, "")
        return self._spawn(request, document, self._attribute_options(request, document))

    def spawn_object(self, request: Any, _response: Any) -> str:
        """A document of either format, with the options of our own tools."""
        return self._spawn(request, self._parsed(request, request.file),
                           SpawnOptions(request.replace, request.file, request.launch_pid))

    def _parsed(self, request: Any, file: str) -> ParsedDocument:
        checked_name(request.model_name)
        return parse_document(request.model_xml, self._resolver, _label(request, file))

    def _attribute_options(self, request: Any, document: ParsedDocument) -> SpawnOptions:
        found = document.take_attributes(
            (REPLACE_ATTRIBUTE, FILE_ATTRIBUTE, LAUNCH_ATTRIBUTE))
        options = options_of_attributes(found)
        if options.file:
            document.set_file(_label(request, options.file))
        if found and not self._told_deprecated:
            self._told_deprecated = True
            self._log(warning(
                "attribute-deprecated", f"the attribute {next(iter(found))!r} of a spawn request is"
                " deprecated", file=_label(request, options.file),
                hint="call the service spawn_object, whose request has a field for it"))
        return options

    def _spawn(self, request: Any, document: ParsedDocument, options: SpawnOptions) -> str:
        name = request.model_name
        initial = pose_from_message(request.initial_pose, "initial_pose")
        launched = self._launcher != 0 and options.launch_pid == self._launcher
        there = self._simulator.models.has(name)
        if there and not options.replace and not (launched and self._is_the_worlds(name)):
            raise CommandError(f"Failure - entity already exists. (model {name!r})")
        return self._spawn_document(
            document, name, initial, frame=request.reference_frame,
            namespace=request.robot_namespace, replace=options.replace, launched=launched)

    def spawn_text(self, text: str, name: Optional[str], initial: Pose = IDENTITY, *,
                   launched: bool = False, file: str = "model_xml") -> str:
        """Put the model or light of a document into the world.

        Args:
            text: URDF or SDF.
            name: its name in the world; None for the document's own.
            initial: pose in the world frame; the document's own pose is composed onto it.
            launched: whether the launch file of the simulator spawns it: where the world file
                has that very model already, that one is taken.
            file: what messages call the document.

        Returns:
            What to tell the client.

        Raises:
            InputError: the document describes no whole model.
            CommandError: the world refuses it.
        """
        document = parse_document(text, self._resolver, file)
        return self._spawn_document(document, name, initial, launched=launched)

    def _spawn_document(self, document: ParsedDocument, name: Optional[str], initial: Pose, *,
                        frame: str = "", namespace: str = "", replace: bool = False,
                        launched: bool = False) -> str:
        """As `spawn_text`.

        The model goes to T_frame T_initial T_own (Gazebo behaviour). `frame` is a model or link,
        "" for the world; `namespace` is for plugins that name none; `replace` replaces a model of
        that name in the same step.
        """
        entity, issues = document.read_entity()
        if not isinstance(entity, Model):
            self._report(issues)
            return self._spawn_light(entity, name, initial, frame)
        model = named(entity, name if name is not None else entity.name, namespace)
        meshes, mesh_issues = collision_meshes(model)
        issues = [*issues, *mesh_issues]
        self._report(issues)
        if errors_of(issues):
            raise InputError(issues)
        if launched and not replace and self._is_the_worlds(model.name):
            return self._adopt(model)
        where = compose(initial, model.pose)
        within(where.position, LENGTH, "m", "the model's position")
        with in_gazebos_words("", NO_FRAME):
            self._simulator.models.spawn(model, where, frame, meshes, replace, launched=launched)
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
        return "successfully deleted model"


def _label(request: Any, file: str) -> str:
    """What messages call the document of a request."""
    return f"model '{request.model_name}', {file or 'model_xml'}"
