"""Tables of what acts on blocks: supports, loads, stress, water, bolts, the ground."""
