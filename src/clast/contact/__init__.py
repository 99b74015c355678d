"""Contacts between blocks: detection, corners, memory, laws."""
