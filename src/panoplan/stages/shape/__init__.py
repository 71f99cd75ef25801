"""Room shape by iterative shortest path (iSPA)."""
