"""Studies: many runs of a case whose sum is an answer, on one machine or many."""
