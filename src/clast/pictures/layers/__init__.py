"""What is drawn above the blocks of a still picture where it is asked for."""
