"""The namespace of a model's plugins, as a spawn request gives it."""
from __future__ import annotations

from dataclasses import replace
from typing import List

from .model import Link, Model, PluginSpec

_ELEMENT = "robotNamespace"


def with_namespace(model: Model, namespace: str) -> Model:
    """The model with `<robotNamespace>` in every plugin that has none (Gazebo behaviour)."""
    return replace(
        model,
        plugins=[_plugin(plugin, namespace) for plugin in model.plugins],
        extra=_extra(model.extra, namespace),
        links=[_link(link, namespace) for link in model.links],
        models=[with_namespace(inner, namespace) for inner in model.models])


def _plugin(plugin: PluginSpec, namespace: str) -> PluginSpec:
    return replace(plugin, xml=_add_namespace(plugin.xml, namespace)) if plugin.xml else plugin


def _link(link: Link, namespace: str) -> Link:
    if not any("<plugin" in text for text in link.extra):
        return link
    sensors = [replace(sensor, plugins=[_plugin(plugin, namespace) for plugin in sensor.plugins])
               for sensor in link.sensors]
    return replace(link, extra=_extra(link.extra, namespace), sensors=sensors)


def _extra(texts: List[str], namespace: str) -> List[str]:
    return [_add_namespace(text, namespace) if "<plugin" in text else text for text in texts]


def _add_namespace(xml: str, namespace: str) -> str:
    """The element `xml` with the namespace added to every `<plugin>` without one.

    XML that cannot be parsed by itself (an undeclared prefix) is unchanged.
    """
    import xml.etree.ElementTree as ElementTree

    try:
        root = ElementTree.fromstring(xml)
    except ElementTree.ParseError:
        return xml
    changed = False
    for plugin in root.iter("plugin"):
        if plugin.find(_ELEMENT) is None:
            ElementTree.SubElement(plugin, _ELEMENT).text = namespace
            changed = True
    return ElementTree.tostring(root, encoding="unicode") if changed else xml
