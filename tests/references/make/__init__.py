"""Makes the reference files: see ../README.md."""
