"""What inputs become in a model: where they lie on blocks, and what they are checked against."""
