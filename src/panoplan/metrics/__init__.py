"""Scores of a plan against the truth."""
