"""Descriptions as SDF 1.7 text, by the tables that read it."""
