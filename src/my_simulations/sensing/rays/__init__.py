"""Rays, cast by Embree."""
