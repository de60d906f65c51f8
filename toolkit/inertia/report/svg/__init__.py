"""Pictures of a rotor, drawn as SVG."""
