"""Files to descriptions and back, by tables. Readers collect issues; they never print."""
