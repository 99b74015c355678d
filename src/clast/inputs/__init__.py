"""The inputs of a user, each declared once, and their conversion into a model."""
