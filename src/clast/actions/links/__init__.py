"""Links between blocks at a point: hinges, sliders, springs of every kind."""
