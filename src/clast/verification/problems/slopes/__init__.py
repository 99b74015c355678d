"""Rock slopes."""
