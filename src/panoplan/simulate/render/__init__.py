"""Pictures of simulated buildings: surfaces, light, one ray caster, one shader."""
