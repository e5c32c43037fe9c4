"""Models, worlds and buildings on disk that the page lists, opens and saves."""
