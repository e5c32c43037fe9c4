"""The ROS interface: converts requests, calls the simulator, converts results."""
