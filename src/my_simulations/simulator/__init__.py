"""The running world for front ends: description, clock, and the only caller of the engine."""
