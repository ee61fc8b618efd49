"""The numbers of README and docs: stored results, what shows them, and how to measure them anew.

`stores.py` lists the commands, NAME.json has what a command printed, `blocks.py` makes the tables,
`sentences.md` lists the numbers in prose, and `pages.py` writes both into the pages. `make results`
runs it all; `python -m results.pages` only writes the pages from the stores.
"""
