//! Numbers that are spread evenly, the same in every run.

/// The k-th point of a low-discrepancy sequence in the unit square (Roberts' R2).
pub(crate) fn spread(k: usize) -> [f64; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (k as f64 * step).fract())
}
