"""P1 and its solution: equations, solvers, cleaning, earliest-first."""
