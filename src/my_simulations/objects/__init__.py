"""Object lists: what stands where in a world, read from YAML and checked. Pure, without ROS."""
