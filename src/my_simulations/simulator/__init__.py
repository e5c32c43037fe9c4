"""The world as the faces see it: description, clock, and the only caller of the engine."""
