"""Command line programs: thin `main(argv)` functions that map faults to exit codes."""
