"""The physics engine: PyBullet in a child process, with commands in and snapshots out."""
