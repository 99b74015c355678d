"""Pictures of runs and of verification problems; the only importer of matplotlib."""
