"""Actors: where they are and what shape they have at a time."""
