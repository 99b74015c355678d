"""Rock bolts: their forces, what their springs have been through, and what is said of it."""
