"""Building plans: walls, openings, stairs and floors in two dimensions, and the model they make."""
