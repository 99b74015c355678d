"""A run that is watched while it goes on: its page on this machine, and who leads the run."""
