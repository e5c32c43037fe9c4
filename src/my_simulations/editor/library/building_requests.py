"""The requests of the building editor."""
from __future__ import annotations

from concurrent.futures import Executor
from typing import Any, Callable, Dict, List

from ...building import building_operations as building
from ...building.building_folder import default_folder
from ...description.flatten import flatten_model
from ...errors import Issue
from ..transport.browser_client import Client
from ..transport.error_messages import issue_document
from ..transport.hub import Hub
from ..transport.web_socket import Route
from .model_library import Library
from .world_files import WorldFiles


class BuildingRequests:
    """`building_…`; a saved building is a model of the library at once."""

    def __init__(self, hub: Hub, library: Library, pool: Executor, files: WorldFiles) -> None:
        self._hub = hub
        self._library = library
        self._pool = pool
        self._files = files

    def routes(self) -> Dict[str, Route]:
        handlers: Dict[str, Callable[[Client, Dict[str, Any]], Any]] = {
            "building_sdf": self._sdf, "building_save": self._save, "building_load": self._load,
            "building_list": self._list,
        }
        return {kind: Route(handler, self._pool) for kind, handler in handlers.items()}

    def _sdf(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        """The model and its SDF; a preview, which needs no text, asks for none."""
        model, text, issues = building.building_sdf(message["plan"],
                                                    message.get("text") is not False)
        return {"model": self._hub.documents.model(flatten_model(model), model.pose), "sdf": text,
                "issues": _issue_documents(issues)}

    def _save(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        done = building.building_save(message["plan"], message["name"],
                                      message.get("options") or {}, self._files.roots())
        folder = done["path"].rpartition("/")[0]
        self._library.add(folder)
        return {**done, "issues": _issue_documents(done["issues"])}

    def _load(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        done = building.building_load(message["name"], self._places())
        return {**done, "issues": _issue_documents(done["issues"])}

    def _list(self, _client: Client, _message: Dict[str, Any]) -> List[Dict[str, str]]:
        return building.building_list(self._places())

    def _places(self) -> List[str]:
        return [*self._files.roots(), default_folder(), *self._library.added]


def _issue_documents(issues: List[Issue]) -> List[Dict[str, Any]]:
    return [issue_document(issue) for issue in issues]
