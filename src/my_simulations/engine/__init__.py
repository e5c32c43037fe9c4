"""The physics: PyBullet in a process of its own, told by commands and read from a ring."""
