"""Actions on blocks beside their contacts; a new one is one file and its tables in the case."""
