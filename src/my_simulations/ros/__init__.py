"""The ROS face: converts, asks the simulator, converts back."""
