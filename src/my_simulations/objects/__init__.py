"""Object lists in YAML: names, files and poses of objects in a world. Independent of ROS."""
