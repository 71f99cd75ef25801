"""Past the paper: views grouped into rooms, fused, and turned into one plan."""
