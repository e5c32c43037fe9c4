"""Live views of what is published on ROS topics, and driving robots with the keys."""
