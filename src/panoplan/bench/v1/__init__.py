"""The benchmark v1: many buildings, predicted once, kept, and scored as often as wanted."""
