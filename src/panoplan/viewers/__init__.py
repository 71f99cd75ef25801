"""Live views: they consume events only."""
