"""What a plan is written as."""
