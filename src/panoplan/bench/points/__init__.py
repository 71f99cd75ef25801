"""The point-cloud baseline: a plan from a laser-like scan, without learning.

Density map of the whole scene, its rooms told apart, and each room's outline as one shortest path:
the shape step of Floor-SP without its networks.
"""
