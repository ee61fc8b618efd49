"""Test cases, evaluation, and comparison of agents."""
