//! Laws of the time base generators, Eq. 5 and 6.

use std::f64::consts::PI;

use babble_brain::{BrainError, TimeBaseGenerator, place};
use proptest::prelude::*;
use statrs::function::beta::{beta, beta_reg};

fn samples(b1: f64, b2: f64, n: usize) -> Vec<[f64; 2]> {
    let mut out = vec![[f64::NAN; 2]; n];
    TimeBaseGenerator::new(b1, b2, 8.0)
        .unwrap()
        .sample_into(&mut out);
    out
}

/// By how much `s` misses the time at which the closed form `I_c(1 - b1, 1 - b2) = t/T` passes `c`,
/// give or take one ulp of c: near c = 1 an ulp can be a large share of the time.
fn time_error(b1: f64, b2: f64, c: f64, s: f64) -> f64 {
    if c > 0.5 {
        // 1 - c is exact, and the closed form is precise near 0 alone.
        let left = |rest: f64| beta_reg(1.0 - b2, 1.0 - b1, rest.clamp(0.0, 1.0));
        let (rest, ulp) = (1.0 - c, 0.5 * f64::EPSILON);
        let (most, least) = (left(rest + ulp), left(rest - ulp));
        (least - (1.0 - s)).max(1.0 - s - most).max(0.0)
    } else {
        (beta_reg(1.0 - b1, 1.0 - b2, c) - s).abs()
    }
}

fn worst_time_error(b1: f64, b2: f64, n: usize) -> f64 {
    let mut worst: f64 = 0.0;
    for (k, [cx, cy]) in (1..).zip(samples(b1, b2, n)) {
        let s = f64::from(k) / n as f64;
        worst = worst
            .max(time_error(b1, b2, cx, s))
            .max(time_error(b2, b1, cy, s));
    }
    worst
}

/// The trajectory is the closed form, everywhere in the range babbling draws from, corners of
/// (b1, b2) included. Catches seeding Eq. 5 with c = ε (0.1 T late at b1 = 0.9) and every
/// integration that steps over the singular ends.
#[test]
fn follows_the_closed_form() {
    let grid = [0.01, 0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.98, 0.99];
    for b1 in grid {
        for b2 in grid {
            let error = worst_time_error(b1, b2, 160);
            assert!(error < 1e-7, "b1 = {b1}, b2 = {b2}: {error:e} T");
        }
    }
}

/// Clearance of the midpoint between start and target, over their distance, for b2 = 1 - b1.
/// Catches an exchange of cx and cy in Eq. 5, and the seeded integration.
#[test]
fn clears_the_midpoint_as_derived() {
    let table = [
        (0.55, 0.091),
        (0.6, 0.180),
        (0.65, 0.265),
        (0.7, 0.333),
        (0.75, 0.351),
        (0.99, 0.3536),
    ];
    for (b1, expected) in table {
        let clearance = samples(b1, 1.0 - b1, 4000)
            .into_iter()
            .map(|c| place([0.0, 0.0], [1.0, 0.0], c))
            .map(|[x, y]| (x - 0.5).hypot(y))
            .fold(f64::INFINITY, f64::min);
        assert!(
            (clearance - expected).abs() < 6e-4,
            "b1 = {b1}: {clearance}"
        );
    }
}

/// b1 > 1/2 passes on the left of the line from start to target, b1 < 1/2 on the right.
/// Catches a mirrored Eq. 6.
#[test]
fn curves_to_the_left_above_one_half() {
    for (b1, side) in [(0.7, 1.0), (0.3, -1.0)] {
        let halfway = samples(b1, 1.0 - b1, 160)[79];
        let [_, y] = place([0.0, 0.0], [1.0, 0.0], halfway);
        assert!(y * side > 0.1, "b1 = {b1}: y = {y}");
    }
}

#[test]
fn bad_parameters_are_named() {
    for bad in [0.0, 1.0, -0.1, 1.5, f64::NAN] {
        let field = |b1, b2, t| match TimeBaseGenerator::new(b1, b2, t) {
            Err(BrainError::OutOfRange { field, .. }) => field,
            other => panic!("{other:?}"),
        };
        assert_eq!(field(bad, 0.5, 8.0), "b1");
        assert_eq!(field(0.5, bad, 8.0), "b2");
    }
    for bad in [0.0, -8.0, f64::INFINITY, f64::NAN] {
        let error = TimeBaseGenerator::new(0.5, 0.5, bad).unwrap_err();
        assert!(error.to_string().starts_with("duration"), "{error}");
    }
}

/// Parameters next to 0 and 1 give numbers in [0, 1] like all others: no overflow of B.
#[test]
fn extreme_parameters_stay_finite() {
    let ends = [
        f64::MIN_POSITIVE,
        1e-9,
        0.5,
        1.0 - 1e-9,
        1.0_f64.next_down(),
    ];
    for b1 in ends {
        for b2 in ends {
            let c = samples(b1, b2, 160);
            let inside = |v: f64| (0.0..=1.0).contains(&v);
            assert!(c.iter().flatten().all(|&v| inside(v)), "{b1} {b2}");
        }
    }
}

proptest! {
    /// γ T = B(1 - b1, 1 - b2), and π / sin π b1 for mirrored parameters.
    /// Catches γ set for one of the two cases alone.
    #[test]
    fn gamma_sets_the_duration(b1 in 0.01..0.99, b2 in 0.01..0.99, t in 0.1..100.0) {
        let area = |b1, b2| TimeBaseGenerator::new(b1, b2, t).unwrap().gamma() * t;
        let expected = beta(1.0 - b1, 1.0 - b2);
        prop_assert!((area(b1, b2) / expected - 1.0).abs() < 1e-11);
        let mirrored = PI / (PI * b1).sin();
        prop_assert!((area(b1, 1.0 - b1) / mirrored - 1.0).abs() < 1e-12);
    }

    /// cy(s) = 1 - cx(1 - s) for any pair, and cx and cy change places with b1 and b2.
    /// Catches a join of the two halves at the wrong time.
    #[test]
    fn is_symmetric(b1 in 0.01..0.99, b2 in 0.01..0.99) {
        let (c, swapped) = (samples(b1, b2, 160), samples(b2, b1, 160));
        for k in 0..159 {
            prop_assert!((c[k][1] - (1.0 - c[158 - k][0])).abs() < 1e-15);
            prop_assert!((c[k][0] - swapped[k][1]).abs() < 1e-12);
        }
    }

    /// Both coordinates never step back and end on (1, 1) exactly. Catches interpolation that
    /// overshoots, a gap at the join and samples that stop short of the end.
    #[test]
    fn rises_monotonically_to_one(b1 in 0.001..0.999, b2 in 0.001..0.999, n in 1_usize..700) {
        let c = samples(b1, b2, n);
        prop_assert_eq!(c[n - 1], [1.0, 1.0]);
        for pair in c.windows(2) {
            prop_assert!(pair[0][0] <= pair[1][0] && pair[0][1] <= pair[1][1]);
        }
        prop_assert!(c[0][0] >= 0.0 && c[0][1] >= 0.0);
    }

    /// (0, 0) is placed on the start, (1, 1) on the target, and the lengths in between scale.
    /// Catches Eq. 6 as printed, which ends √2 too far and 45° off.
    #[test]
    fn place_joins_start_and_target(
        start in prop::array::uniform2(-1.0_f64..1.0),
        target in prop::array::uniform2(-1.0_f64..1.0),
        c in prop::array::uniform2(0.0_f64..1.0),
    ) {
        prop_assert_eq!(place(start, target, [0.0, 0.0]), start);
        let end = place(start, target, [1.0, 1.0]);
        let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        prop_assert!(distance(end, target) < 1e-15);
        let scaled = distance(start, target) / 2.0_f64.sqrt() * c[0].hypot(c[1]);
        prop_assert!((distance(place(start, target, c), start) - scaled).abs() < 1e-14);
    }
}
