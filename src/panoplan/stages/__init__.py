"""The method of the paper: one module a subsection, none imports another."""
