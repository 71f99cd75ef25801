"""The nouns of the method: frozen values, validated when made."""
