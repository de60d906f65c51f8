"""Mass properties in the files of other programs: one module a format, one table of conventions."""
