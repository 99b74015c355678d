"""What supports bear, drawn on a picture."""
