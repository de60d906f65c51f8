"""How triangles divide one another and the space around them, exactly."""
