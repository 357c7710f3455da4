"""The study file: text to one frozen, validated Case in SI units."""
