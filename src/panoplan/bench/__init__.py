"""What `panoplan bench` runs."""
