"""Water that flows in joints."""
