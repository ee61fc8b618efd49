"""The report of a study: one HTML page with its charts inside, and its numbers beside it."""

from gym_babble.report.writing import REPORT_FILES, write_report

__all__ = ["REPORT_FILES", "write_report"]
