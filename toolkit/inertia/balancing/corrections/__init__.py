"""Ways of correcting a rotor: point masses, holes, flats, and weights from a kit."""
