"""The heavy symmetric top in closed form."""
