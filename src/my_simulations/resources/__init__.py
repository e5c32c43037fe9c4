"""From a URI to a path, or to an error that lists every place tried."""
