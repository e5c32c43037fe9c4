"""What looks at the world: rays, cameras and sensor models. Plans and data import nothing."""
