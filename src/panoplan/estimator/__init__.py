"""The only place with time: state, step, streaming front."""
