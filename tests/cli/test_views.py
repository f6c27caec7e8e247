"""What a person reads, to the letter."""
