"""Many files → one table with a row for every file: `analyse`, `check`, `balance` or `audit` in worker processes."""
