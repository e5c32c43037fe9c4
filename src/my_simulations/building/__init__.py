"""Building plans: walls, openings, stairs and floors in two dimensions, and models of them."""
