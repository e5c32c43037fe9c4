"""The templates of robots as the page asks for them."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Tuple

from ...errors import InputError
from ...resources.resolver import Resolver
from ...robot_templates import TEMPLATES, template_named
from ..editing.inserts import Entity, entity_of_text


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
