"""Test cases, evaluation, and the comparison of agents."""
