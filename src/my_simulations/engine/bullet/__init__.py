"""PyBullet, bound to the engine's interface. Nothing else imports pybullet."""
