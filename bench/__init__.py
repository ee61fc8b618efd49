"""What environments cost, beside their peers and in one run: `make bench`.

`cases.py` lists the rows, `run.py` measures them in rounds and writes `results.json`, `report.py`
and `chart.py` make the tables and the picture of the docs from it. A row runs in a process of its
own (`worker.py`), under the virtual environment of its package; `peers.py`, `ours.py` and `twin.py`
hold what is measured, `clock.py` how.
"""
