"""What robots do by themselves: plugins behind Gazebo's library names."""
