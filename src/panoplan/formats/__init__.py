"""One module an on-disk format, read and write, no discovery."""
