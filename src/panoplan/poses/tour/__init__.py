"""Sparse photo tours: stills metres apart are joined into one frame."""
