"""What tests of several subjects share: systems of blocks, runs, reference computations."""
