"""The value of a parameter with which a target is met."""
