//! The lab's engine for a browser: only conversions.
