"""Mass properties and a shaft in; unbalance, tolerance, correction and verdict out."""
