"""Inputs: what a user gives, each thing declared once, with what it becomes in a model."""
