"""A picture a stage: why a plan is as it is."""
