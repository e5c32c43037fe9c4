"""Appearance of visuals: materials, scripts and textures, for the editor and for cameras."""
