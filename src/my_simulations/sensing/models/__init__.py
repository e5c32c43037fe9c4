"""What sensors that look at nothing measure: pure functions of the state."""
