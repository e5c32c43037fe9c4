"""What other packages import from gazebo_ros."""
