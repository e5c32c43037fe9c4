"""Feeds changed elements and messages to plugins in a world without physics."""
from __future__ import annotations

import importlib
import inspect
import math
import re
from pathlib import Path
from random import Random
from typing import Any, Callable, Dict, Hashable, List, Tuple, Type

from editor_case import arm
from mutant_doors import Messages
from mutant_run import Target, shape
from mutations import Element, XmlKnowledge, xml_text

from my_simulations.plugins.base import Plugin
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.registry import BUILT_IN
from my_simulations.plugins.testing import FakeContext

JOINTS = ("left_joint", "right_joint", "front_steering_joint", "rear_left_joint", "hinge")
LINKS = ("base", "tip", "palm", "link")
_READ = re.compile(r"""(?:\.|_)(text|texts|number|integer|flag|vector|turn|choice|children)\(\s*"""
                   r"""["'](\w+)["']""")
_FITTING = {"number": "1", "integer": "10", "flag": "true", "vector": "1 0 0", "turn": "0 0 1"}

Heard = Tuple[str, Callable[[Any], None]]


class Context(FakeContext):
    """Keeps the types of subscribed topics."""

    def __init__(self, xml: str, **options: Any) -> None:
        super().__init__(xml, joints=JOINTS, **options)
        self.heard: List[Heard] = []

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None], queue: int = 1) -> Any:
        """Hear a topic."""
        self.heard.append((kind, call))
        return super().subscribe(name, kind, call, queue)


def _text(name: str, kind: str) -> str:
    low = name.lower()
    if kind in _FITTING:
        return _FITTING[kind]
    if "joint" in low:
        return "right_joint" if "right" in low else "left_joint"
    if "link" in low or "body" in low or "base" in low:
        return "base"
    return "topic" if "topic" in low else "a"


def parameters_of(made: Type[Plugin]) -> Dict[str, str]:
    """Return the parameters that a plugin and its base classes read, with fitting values."""
    found: Dict[str, str] = {}
    for above in made.__mro__:
        if above.__module__.startswith("my_simulations.plugins"):
            source = inspect.getsource(importlib.import_module(above.__module__))
            for kind, name in _READ.findall(source):
                found.setdefault(name, _text(name, kind))
    return found


def assert_finite(context: Context, name: str) -> None:
    """Check that all commands of a plugin are finite: a motor with NaN ends a robot."""
    orders = [value for joint in context.joints.values() for value in joint.motor or ()]
    orders += [joint.position for joint in context.joints.values()]
    orders += [value for push in context.wrenches.values() for part in push for value in part]
    orders += [*(context.level or ()), *context.pose.position, *context.twist.linear]
    assert all(map(math.isfinite, orders)), f"{name} orders what is not finite"


class Plugins:
    """All plugins that need no sensor, as their files say or nearly so."""

    def __init__(self, _folder: Path) -> None:
        self._known = XmlKnowledge()
        self._classes: List[Type[Plugin]] = []
        seeds = []
        for where in sorted(set(BUILT_IN.values())):
            module, _, name = where.partition(":")
            made = getattr(importlib.import_module(f"my_simulations.plugins.{module}"), name)
            given = parameters_of(made)
            self._classes.append(made)
            number = ("number", str(len(self._classes) - 1))
            seeds.append(Element("plugin", (number,), "", ()))
            root = Element("plugin", (number,), "", tuple(
                Element(tag, (), text, ()) for tag, text in given.items()))
            seeds.append(root)
            self._known.learn(root)
        self._messages = Messages(("a", "b", "base", "map", "left_joint", "right_joint"))
        self.target = Target("plugins", seeds, self._known.change, self._encode, self._feed,
                             suffix=".xml")

    def close(self) -> None:
        """Nothing is open."""

    @staticmethod
    def _encode(made: Element, chance: Random) -> str:
        return f"<!-- {chance.getrandbits(32)} -->{xml_text(made)}"

    def _feed(self, text: str) -> List[Hashable]:
        seed, _, xml = text.partition(" -->")
        chance = Random(int(seed[5:]))
        number = re.search(r'number="(\d+)"', xml)
        made = self._classes[int(number.group(1)) % len(self._classes) if number else 0]
        context = Context(xml)
        context.description = arm("robot")
        plugin = made(context)
        try:
            plugin.load()
        except PluginError as fault:
            return [(made.__name__, shape(str(fault)))]
        context.advance(0.004)
        for kind, heard in context.heard:
            try:
                package, name = kind.split("/")
                make = self._messages.message(
                    getattr(importlib.import_module(f"{package}.msg"), name))
            except ImportError:
                continue  # not on this system
            for _ in range(3):
                heard(make(chance))
                context.advance(0.002)
                assert_finite(context, made.__name__)
        plugin.reset()
        context.advance(0.002)
        plugin.close()
        return [(made.__name__, shape(text)) for text in context.log_messages[:5]] or [
            made.__name__]
