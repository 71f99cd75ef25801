"""Odometry of a walk: keyframe in, pose out."""
