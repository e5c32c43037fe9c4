"""The requests about models that may be inserted, and models saved to a folder of the user."""
from __future__ import annotations

import asyncio
import os
import tempfile
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

from ...description.flatten import flatten_model
from ...description.model import Model
from ...description.unflatten import unflatten_model
from ...errors import CommandError, InputError, Issue
from ...formats.sdf.writer.entities import write_entity
from ...geometry import Pose
from ...resources.database.fuel_uri import is_web_address
from ...resources.resolver import Resolver
from ...robot_templates import TEMPLATES, template_named
from ...simulator.safe_file import write_atomically
from ...simulator.simulator import Simulator
from ..editing.inserts import Entity, entity_of_text, entity_of_uri
from ..scene.scene_json import Documents
from ..transport.browser_client import Client
from ..transport.error_messages import EditRefusedError
from ..transport.hub import Hub
from ..transport.web_socket import Route
from .model_import import (
    check_folder_name,
    check_loading,
    config_text,
    default_folder,
    import_model,
    relocate_issue,
)
from .model_library import Library

_LOOK_S = 2.0


class LibraryRequests:
    """`library…` and `preview`; runs in a pool of threads.

    Args:
        hub: hears of changes and downloads.
        resolver: finds models.
        library: knows them.
        pool: where requests run.
        report: receives warnings about models.
    """

    def __init__(self, hub: Hub, resolver: Resolver, library: Library, pool: Executor,
                 report: Callable[[Issue], None]) -> None:
        self._hub = hub
        self._resolver = resolver
        self._library = library
        self._pool = pool
        self._report = report
        self._asked = False
        self._signature: Optional[Any] = None

    def routes(self) -> Dict[str, Route]:
        handlers: Dict[str, Callable[[Client, Dict[str, Any]], Any]] = {
            "library": self._list, "library_add": self._add, "library_remove": self._remove,
            "library_get": self._get, "preview": self._preview,
            "import_model": self._import, "save_model": self._save,
            "templates": self._templates, "template": self._template,
        }
        return {kind: Route(handler, self._pool) for kind, handler in handlers.items()}

    async def watch(self) -> None:
        """Push the library after each change, from the first request for it."""
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(_LOOK_S)
            if not self._asked or not self._hub.clients:
                continue
            signature = await loop.run_in_executor(self._pool, self._library.signature)
            if signature != self._signature:
                self._hub.push(await loop.run_in_executor(self._pool, self._push))

    def _push(self) -> Dict[str, Any]:
        return {"type": "library", **self._locations()}

    def _locations(self) -> Dict[str, Any]:
        self._signature = self._library.signature()  # first: what changes meanwhile is told again
        return {"locations": self._library.locations()}

    def _list(self, _client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        if not self._asked:
            self._asked = True
            self._pool.submit(self._fetch)
        return self._locations()

    def _fetch(self) -> None:
        self._library.fetch_list()
        self._hub.push_soon(self._push())

    def _add(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        self._library.add(message["path"])
        return self._locations()

    def _remove(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        self._library.remove(message["path"])
        return self._locations()

    def _get(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        uri = message["uri"]
        if not uri.startswith(("model://", "file://")) and not is_web_address(uri):
            raise CommandError(f"{uri!r} is not a model URI")
        self._library.provide(uri)
        entity, issues = entity_of_uri(uri, self._resolver)
        # The gallery's pictures load models that the user did not request.
        for issue in () if message.get("quiet") else issues:
            self._report(issue)
        return preview_document(entity, self._hub.documents)

    def _import(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        reply, issues = import_model(message, self._resolver)
        for issue in issues:
            self._report(issue)
        return reply

    def _save(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        reply, issues = save_model(message, self._hub.simulator, self._resolver)
        for issue in issues:
            self._report(issue)
        return reply

    @staticmethod
    def _templates(_client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        return {"templates": listed_templates()}

    def _template(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        sdf, model = model_of_template(message["name"], message["values"], self._resolver)
        return {"sdf": sdf, "model": preview_document(model, self._hub.documents)["model"]}

    def _preview(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        entity, _ = entity_of_text(message["sdf"], self._resolver, message.get("source"))
        return preview_document(entity, self._hub.documents)


def preview_document(entity: Entity, documents: Documents) -> Dict[str, Any]:
    """The document of a model or light that is not in the world."""
    from ...description.model import Model

    if isinstance(entity, Model):
        return {"model": documents.model(flatten_model(entity), entity.pose), "light": None}
    return {"model": None, "light": documents.light(entity)}


def listed_templates() -> List[Dict[str, Any]]:
    """All templates, as the protocol's `Template`s."""
    return [{"name": template.name, "title": template.title, "description": template.description,
             "parameters": [
                 {"name": one.name, "title": one.title, "kind": one.kind, "default": one.default,
                  "unit": one.unit, "minimum": one.minimum, "maximum": one.maximum}
                 for one in template.parameters]} for template in TEMPLATES]


def model_of_template(name: str, values: Mapping[str, Any],
                      resolver: Resolver) -> Tuple[str, Entity]:
    """SDF text and model of a template with values for its parameters.

    Raises CommandError for an unknown template and for values that are not allowed.
    """
    sdf = template_named(name).sdf(values)
    model, issues = entity_of_text(sdf, resolver, f"{name}.sdf")
    if issues:
        raise InputError(issues)
    return sdf, model


def save_model(message: Dict[str, Any], world: Simulator,
               resolver: Resolver) -> Tuple[Dict[str, Any], List[Issue]]:
    """Store a model of the world as a model folder; the reply, and what is odd about the model.

    The model is stored under the folder's name, as it is described, at the height at which it
    stands now. Other files of the folder stay. Nothing is stored of a model that could not be
    loaded again.

    Raises:
        InputError: the written file could not be read.
        EditRefusedError: `exists`, where there is a folder of that name that must not be replaced.
        CommandError: no such model, no usable name, or the folder cannot be written.
    """
    name = check_folder_name(message["name"])
    model = world.models.get(message["model"])
    height = world.states.model_state(model.name)[0].position[2]
    target = os.path.join(default_folder(), name)
    if os.path.lexists(target) and not message.get("overwrite"):
        raise EditRefusedError("exists", f"{target} already exists",
                               "overwrite it, or choose another name")
    files = {
        "model.sdf": _text(model, name, height).replace(
            f"{target}/".encode(), f"model://{name}/".encode()),
        "model.config": config_text(name, "model.sdf", message.get("about") or {}),
    }
    issues = _readable(files, name, target, resolver)
    for file, data in files.items():
        write_atomically(os.path.join(target, file), data, overwrite=True)
    return {"uri": f"model://{name}", "path": target}, issues


def _text(model: Model, name: str, height: float) -> bytes:
    whole = replace(unflatten_model(model), name=name, pose=Pose((0.0, 0.0, height)), uri="")
    return write_entity(whole)


def _readable(files: Dict[str, bytes], name: str, target: str, resolver: Resolver) -> List[Issue]:
    """What the simulator says of the folder. Raises InputError."""
    with tempfile.TemporaryDirectory(prefix="my_simulations-") as scratch:
        folder = os.path.join(scratch, name)
        os.makedirs(folder)
        for file, data in files.items():
            with open(os.path.join(folder, file), "wb") as stream:
                stream.write(data)
        return [relocate_issue(issue, folder, target) for issue in check_loading(folder, resolver)]
