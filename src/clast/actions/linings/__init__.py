"""Linings: chains of stiff segments with springs between them, limited by their sections."""
