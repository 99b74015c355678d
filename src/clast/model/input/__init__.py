"""What scripts and case files give of blocks, joints, supports and loads, before it is checked."""
