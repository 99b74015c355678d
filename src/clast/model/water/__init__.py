"""Water: its surface, the edges and joints that it can wet, and how drains lower it."""
