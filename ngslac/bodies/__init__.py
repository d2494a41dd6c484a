"""What holds bodies: their rigid motions, contact, friction, and nothing else."""
