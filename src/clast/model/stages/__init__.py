"""Stages of a run: what begins with each, when it ends, and what is known of it afterwards."""
