"""Joints on pictures: edges by joint, slip and opening."""
