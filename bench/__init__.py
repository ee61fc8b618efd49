"""Measures the cost of our environments and of their peers in one run: `make bench`.

`cases.py` lists the rows. `run.py` measures them in rounds and writes `results.json`. `report.py`
and `chart.py` make the docs' tables and picture from it. Each row runs in its own process
(`worker.py`), in the virtual environment of its package. `peers.py`, `ours.py` and `twin.py` have
the measured code, `clock.py` the clocks.
"""
