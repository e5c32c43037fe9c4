"""Writes descriptions as SDF 1.7, by the readers' tables."""
