"""Robots and sensors as SDF, made from a few numbers and names."""
from .template_catalog import TEMPLATES, Template, template_named

__all__ = ["TEMPLATES", "Template", "template_named"]
