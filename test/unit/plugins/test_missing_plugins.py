"""Libraries without a substitute: none of them runs, and each has an alternative."""
from __future__ import annotations

import re

from my_simulations.plugins.missing_plugins import _REASONS, missing_plugin
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.plugins.without_effect import WITHOUT_EFFECT


def test_a_library_has_one_answer_only():
    registry = PluginRegistry()
    assert not [name for name in _REASONS if registry.is_supported(name)]
    assert not set(_REASONS) & set(WITHOUT_EFFECT)


def test_libraries_that_are_named_as_alternatives_run():
    registry = PluginRegistry()
    named = [library for _, hint in _REASONS.values()
             for library in re.findall(r"lib\w+\.so", hint)]
    assert len(named) > 10 and all(map(registry.is_supported, named))


def test_other_libraries_have_the_usual_hint():
    assert missing_plugin("libmystery.so") == (
        "there is no plugin for libmystery.so", "a package can bring one: see doc/plugins.md")
    assert "without a name" in missing_plugin("")[0]
