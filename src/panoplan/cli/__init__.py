"""Parse, call a library function, print."""
