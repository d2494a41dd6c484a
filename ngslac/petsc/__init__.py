"""Linear systems on PETSc, in one process or on many."""
