"""From a validated case to what the solver needs."""
