"""Back-analysis: observations, runs that are kept, least squares and ensembles."""
