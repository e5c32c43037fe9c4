"""ros_control in the simulator: hardware interfaces, a controller manager, controllers."""
