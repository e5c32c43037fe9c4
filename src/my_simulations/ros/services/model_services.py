"""spawn_urdf_model, spawn_sdf_model, spawn_object (models and lights) and delete_model.

Options, name and namespace of a request change the description, not the text, so no number is
rounded and comments do not matter.
"""
from __future__ import annotations

import re
from dataclasses import dataclass, replace
from dataclasses import replace as with_changes
from typing import Any, Callable, List, Mapping, Optional

from ...description.compare import differences
from ...description.flatten import flatten_model
from ...description.light import Light
from ...description.model import Model
from ...description.plugin_namespace import with_namespace
from ...errors import CommandError, InputError, Issue, Severity, errors_of, group_repeated, warning
from ...formats.mesh.loading import collision_meshes
from ...formats.reading import ParsedDocument, parse_document
from ...geometry import IDENTITY, Pose, compose
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ...simulator.spawn_advice import placement_warnings
from ..message_conversion import LENGTH, check_vector, pose_from_message
from .entity_errors import gazebo_prefix, name_taken_message

SAME = 1e-9
"""Tolerance, absolute in the value's unit or relative, below which values are equal."""

NO_FRAME = "reference reference_frame not found"


class ModelServices:
    """Spawns and deletes models, and spawns lights."""

    def __init__(self, simulator: Simulator, resolver: Resolver,
                 log: Callable[[Issue], None], launcher: int = 0,
                 changed: Callable[[str], List[Issue]] = lambda model: []) -> None:
        """Take over a simulator.

        Args:
            simulator: the world.
            resolver: resolves URIs in models.
            log: receives issues.
            launcher: process id of the roslaunch that started the simulator; 0 for none.
            changed: called with the name of a model that was spawned or deleted, before the
                response; returns why plugins of it do not work.
        """
        self._launcher = launcher
        self._changed = changed
        self._simulator = simulator
        self._resolver = resolver
        self._log = log
        self._told_deprecated = False

    def spawn_urdf(self, request: Any, _response: Any) -> str:
        """Spawn a URDF model; any other root element is rejected (Gazebo behaviour)."""
        document = self._parse_document(request, "")
        if document.root_tag != "robot":
            raise CommandError("Failure - entity format is invalid. The root element of a URDF is "
                               f"<robot>, here it is <{document.root_tag}>; use spawn_sdf_model for"
                               " SDF")
        return self._spawn(request, document, self._attribute_options(request, document))

    def spawn_sdf(self, request: Any, _response: Any) -> str:
        document = self._parse_document(request, "")
        return self._spawn(request, document, self._attribute_options(request, document))

    def spawn_object(self, request: Any, _response: Any) -> str:
        """A document of either format, with the options of our own tools."""
        return self._spawn(request, self._parse_document(request, request.file),
                           SpawnOptions(request.replace, request.file, request.launch_pid))

    def _parse_document(self, request: Any, file: str) -> ParsedDocument:
        check_name(request.model_name)
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
        model = with_name(entity, name if name is not None else entity.name, namespace)
        meshes, mesh_issues = collision_meshes(model, document.written(entity.name))
        issues = [*issues, *mesh_issues]
        self._report(issues)
        if errors_of(issues):
            raise InputError(issues)
        if launched and not replace and self._is_the_worlds(model.name):
            return self._adopt(model)
        where = compose(initial, model.pose)
        check_vector(where.position, LENGTH, "m", "position of the model")
        with gazebo_prefix("", NO_FRAME), name_taken_message(f"model {model.name!r}"):
            self._simulator.models.spawn(model, where, frame, meshes, replace, launched=launched)
        faults = self._changed(model.name)   # the plugin host has logged them
        self._report(placement_warnings(self._simulator, model.name, meshes,
                                    document.written(entity.name)))
        return "Successfully spawned entity" + _warnings_in_status([*faults, *issues])

    def _is_the_worlds(self, name: str) -> bool:
        """Whether the world file contains a model of that name that still exists."""
        return self._simulator.models.has(name) and any(
            model.name == name for model in self._simulator.world.models)

    def _adopt(self, model: Model) -> str:
        """Keep the world file's model instead of spawning, if both are equal."""
        here = self._simulator.models.get(model.name)
        other = differences(with_changes(here, pose=IDENTITY, name=""),
                            with_changes(flatten_model(model), pose=IDENTITY, name=""), SAME)
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
        with gazebo_prefix("", NO_FRAME), name_taken_message(f"light {light.name!r}"):
            self._simulator.lights.add(light, frame)
        return "Successfully spawned entity"

    def _report(self, issues: List[Issue]) -> None:
        for issue in group_repeated(issues):
            self._log(issue)

    def delete(self, request: Any, _response: Any) -> str:
        """Delete a model; it is gone when this returns."""
        with gazebo_prefix("model does not exist"):
            self._simulator.models.delete(request.model_name)
        self._changed(request.model_name)
        return "successfully deleted model"


def _warnings_in_status(issues: List[Issue]) -> str:
    """The first warning or error and the number of all, for a status message; "" for none."""
    warned = [issue for issue in issues if issue.severity is not Severity.NOTE]
    if not warned:
        return ""
    kind = "problem" if errors_of(warned) else "warning"
    many = f"{len(warned)} {kind}s, see log; the first" if len(warned) > 1 else f"1 {kind}"
    first = warned[0]
    where, what = f"{first.location}: " if first.location else "", first.message
    return f" ({many}: {where}{what}" + (f"; {first.hint})" if first.hint else ")")


def _label(request: Any, file: str) -> str:
    """What messages call the document of a request."""
    return f"model '{request.model_name}', {file or 'model_xml'}"


REPLACE_ATTRIBUTE = "my_simulations_replace"
FILE_ATTRIBUTE = "my_simulations_file"
LAUNCH_ATTRIBUTE = "my_simulations_launch"
"""Deprecated attributes of the root element that say what `SpawnObject.srv` has fields for."""


@dataclass(frozen=True)
class SpawnOptions:
    """What our own tools may add to a spawn request (see `SpawnObject.srv`).

    Attributes:
        replace: replace a model of that name in one step.
        file: file that the document was read from, "" if unknown.
        launch_pid: process id of the roslaunch that runs the caller, 0 if there is none.
    """

    replace: bool = False
    file: str = ""
    launch_pid: int = 0


def options_of_attributes(attributes: Mapping[str, str]) -> SpawnOptions:
    """The options in the deprecated attributes of a document's root element."""
    pid = attributes.get(LAUNCH_ATTRIBUTE, "")
    return SpawnOptions(
        attributes.get(REPLACE_ATTRIBUTE, "").strip().lower() in ("true", "1", "yes"),
        attributes.get(FILE_ATTRIBUTE, ""), int(pid) if re.fullmatch("[0-9]{1,9}", pid) else 0)


def check_name(name: str) -> str:
    """The name, checked. Raises CommandError: invalid as the name of a model."""
    if not name.strip():
        raise CommandError("model_name is empty")
    if "::" in name:
        raise CommandError(f"model_name {name!r} must not contain '::', the separator of scoped "
                           "names")
    return name


def with_name(model: Model, name: str, namespace: str) -> Model:
    """The model with the requested name; plugins without a namespace get that of the request."""
    renamed = replace(model, name=name)
    return with_namespace(renamed, namespace) if namespace else renamed
