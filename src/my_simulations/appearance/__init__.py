"""What visuals look like: materials, scripts, textures, for everybody who draws."""
