"""One case from study file to report."""
