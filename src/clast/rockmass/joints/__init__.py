"""Joint sets: distributions, directions, the six models, courses of masonry."""
