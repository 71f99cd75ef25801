"""Three-dimensional models: the rooms as seen from inside."""
