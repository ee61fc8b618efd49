"""Numbers as short text."""

from __future__ import annotations

__all__ = ["count", "p_value", "seconds"]


def count(value: float) -> str:
    """A number of trials or steps, short: 950, 12,300, 1.25 M."""
    if value >= 999_500:
        return f"{value / 1e6:.3g} M" if value < 999.5e6 else f"{value / 1e9:.3g} G"
    return f"{float(f'{value:.3g}'):,.0f}"


def seconds(value: float) -> str:
    """A time, short: 0.12 s, 95 s, 12 min, 3.4 h."""
    if value < 99.5:
        return f"{value:.2g} s" if value < 9.95 else f"{value:.0f} s"
    return f"{value / 60:.0f} min" if value < 99.5 * 60 else f"{value / 3600:.3g} h"


def p_value(value: float) -> str:
    """A p-value with two digits."""
    return "< .0001" if value < 1e-4 else f"{value:.2g}".removeprefix("0")
