"""Robots read from the files of others: links, what is stated of each, and the shapes it has. One module a format."""
