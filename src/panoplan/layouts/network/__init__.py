"""Our own layout network: its data, its shape, its training."""
