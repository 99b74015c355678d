"""How a block moves: displacement functions and rotation rules."""
