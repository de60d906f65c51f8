"""What a scene file says, checked."""
