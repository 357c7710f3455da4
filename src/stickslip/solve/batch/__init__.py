"""Many small curves at once: Newton's method and continuation of all of them in lockstep."""
