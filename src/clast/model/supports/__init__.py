"""What holds and moves blocks from outside, and whose reactions are recorded."""
