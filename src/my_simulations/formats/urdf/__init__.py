"""URDF robots, read as Gazebo's converter reads them."""
