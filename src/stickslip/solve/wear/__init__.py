"""Wear: the joint changes over many cycles."""
