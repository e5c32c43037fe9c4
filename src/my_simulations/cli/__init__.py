"""What people type: thin `main(argv)` functions that map faults to exit codes."""
