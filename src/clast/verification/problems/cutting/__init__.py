"""Rock masses that are cut: numbers of blocks, intensities, sizes, directions, areas."""
