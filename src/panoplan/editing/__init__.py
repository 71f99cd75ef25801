"""Edits of a plan: found again by where they lie, then applied."""
