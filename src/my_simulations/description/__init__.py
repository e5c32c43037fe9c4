"""What a world is made of: plain dataclasses, filled by the readers and by nothing else."""
