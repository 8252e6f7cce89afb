"""Functions for other packages."""
