"""What a spawn request asks for, from its text: a description, named, placed and namespaced.

The description is changed, never the text: no number is rounded and no comment can be in the way.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Dict, List, Tuple
from xml.parsers import expat

from ...description.model import Link, Model, PluginSpec
from ...errors import CommandError

MARK = "my_simulations_"
"""What the names of our own attributes of the root element begin with."""

REPLACE_ATTRIBUTE = MARK + "replace"
"""Root attribute that asks for a model of the same name to be replaced in one step."""

FILE_ATTRIBUTE = MARK + "file"
"""Root attribute: where a tool read the document, for messages."""

LAUNCH_ATTRIBUTE = MARK + "launch"
"""Root attribute: process id of the roslaunch that started the tool."""

NAMESPACE_ELEMENT = "robotNamespace"


class _RootSeen(Exception):
    """Ends the parse at the first element."""


def root_of(text: str) -> Tuple[str, Dict[str, str]]:
    """Name and attributes of a document's root element; ("", {}) when it has none to read."""
    found: Tuple[str, Dict[str, str]] = ("", {})

    def start(name: str, attributes: Dict[str, str]) -> None:
        nonlocal found
        found = (name, attributes)
        raise _RootSeen

    reader = expat.ParserCreate()
    reader.StartElementHandler = start
    try:
        reader.Parse(text, True)
    except (_RootSeen, expat.ExpatError):
        return found
    return found


def asks_to_replace(attributes: Dict[str, str]) -> bool:
    """True when the root element's attributes ask for a replacement."""
    return attributes.get(REPLACE_ATTRIBUTE, "").strip().lower() in ("true", "1", "yes")


def launched_by(attributes: Dict[str, str], launcher: int) -> bool:
    """True when the root element's attributes name this roslaunch (0: none) as the sender's."""
    return launcher != 0 and attributes.get(LAUNCH_ATTRIBUTE, "") == str(launcher)


def checked_name(name: str) -> str:
    """The name itself.

    Raises:
        CommandError: no model can have it.
    """
    if not name.strip():
        raise CommandError("model_name is empty")
    if "::" in name:
        raise CommandError(f"model_name {name!r} contains '::', which separates a model's name "
                           "from its link's")
    return name


def named(model: Model, name: str, namespace: str) -> Model:
    """The model under the request's name, its plugins told their namespace where they lack one."""
    renamed = replace(model, name=name)
    return with_namespace(renamed, namespace) if namespace else renamed


def with_namespace(model: Model, namespace: str) -> Model:
    """The model with `<robotNamespace>` in every plugin that has none (Gazebo behaviour)."""
    return replace(
        model,
        plugins=[_plugin(plugin, namespace) for plugin in model.plugins],
        extra=_extra(model.extra, namespace),
        links=[_link(link, namespace) for link in model.links],
        models=[with_namespace(inner, namespace) for inner in model.models])


def _plugin(plugin: PluginSpec, namespace: str) -> PluginSpec:
    return replace(plugin, xml=_injected(plugin.xml, namespace)) if plugin.xml else plugin


def _link(link: Link, namespace: str) -> Link:
    if not any("<plugin" in text for text in link.extra):
        return link
    sensors = [replace(sensor, plugins=[_plugin(plugin, namespace) for plugin in sensor.plugins])
               for sensor in link.sensors]
    return replace(link, extra=_extra(link.extra, namespace), sensors=sensors)


def _extra(texts: List[str], namespace: str) -> List[str]:
    return [_injected(text, namespace) if "<plugin" in text else text for text in texts]


def _injected(xml: str, namespace: str) -> str:
    """The element `xml` with the namespace in every `<plugin>` of it that has none.

    What cannot be parsed by itself (a prefix that is declared nowhere) stays as it is.
    """
    import xml.etree.ElementTree as ElementTree

    try:
        root = ElementTree.fromstring(xml)
    except ElementTree.ParseError:
        return xml
    changed = False
    for plugin in root.iter("plugin"):
        if plugin.find(NAMESPACE_ELEMENT) is None:
            ElementTree.SubElement(plugin, NAMESPACE_ELEMENT).text = namespace
            changed = True
    return ElementTree.tostring(root, encoding="unicode") if changed else xml
