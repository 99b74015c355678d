"""Rock bolts: their forces, the history of their springs, and their events."""
