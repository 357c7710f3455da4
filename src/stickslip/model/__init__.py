"""From a validated case to the input of the solver."""
