"""Buildings, walks, exact views and calibrated noise."""
