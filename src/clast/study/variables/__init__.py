"""Parameters that vary from run to run: paths of keys, distributions, and how runs are drawn."""
