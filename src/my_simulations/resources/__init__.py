"""Resolves URIs to paths; errors list every place that was tried."""
