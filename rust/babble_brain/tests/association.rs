//! Laws of the covariance rule, Eq. 7, and of recall.

use babble_brain::{Association, BrainError, CovarianceRule};
use proptest::collection::vec;
use proptest::prelude::*;

/// Odd sizes, so that no tile, row group or block comes out even.
const N_IN: usize = 77;
const N_OUT: usize = 53;

const PAPER: CovarianceRule = CovarianceRule {
    eta: 1.0,
    w_max: 0.2,
    xi: 0.2,
};

fn unlearnt() -> Association {
    Association::new(N_IN, N_OUT).unwrap()
}

/// Activities as a map gives them: most of them silent or tiny, some strong, some exactly 0 or 1.
fn activity() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => 0.0_f32..=1.0,
        2 => Just(0.0_f32),
        1 => Just(1.0_f32),
        1 => (-45.0_f32..-3.0).prop_map(|e| 10.0_f32.powf(e)),
    ]
}

/// `movements` of N activities from a small generator, for runs too long for proptest to draw.
fn stream(movements: usize, n: usize, mut seed: u32) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    (0..movements * n)
        .map(|_| (2.0 * next() - 1.0).max(0.0))
        .collect()
}

fn bits(association: &Association) -> Vec<u32> {
    let parts = [
        association.weights(),
        association.a_mean(),
        association.g_mean(),
    ];
    parts.concat().into_iter().map(f32::to_bits).collect()
}

/// A batch gives the bits of its movements one by one, on 1, 2 and 8 threads, cut anywhere.
/// Catches sums in another order, averages updated per batch and threads that share a row.
#[test]
fn batch_equals_single_steps() {
    let movements = 150;
    let (gs, as_) = (stream(movements, N_IN, 1), stream(movements, N_OUT, 2));
    let mut single = unlearnt();
    for (g, a) in gs.chunks_exact(N_IN).zip(as_.chunks_exact(N_OUT)) {
        single.learn(&PAPER, g, a).unwrap();
    }
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let mut batch = unlearnt();
        pool.build().unwrap().install(|| {
            let (g, later_g) = gs.split_at(7 * N_IN);
            let (a, later_a) = as_.split_at(7 * N_OUT);
            batch.learn(&PAPER, g, a).unwrap();
            batch.learn(&PAPER, later_g, later_a).unwrap();
        });
        assert_eq!(bits(&batch), bits(&single), "{threads} threads");
    }
}

/// The weights are Eq. 7's, computed plainly in f64. Catches averages updated before the weights,
/// ξ on the new value, a missing |·| and transposed weights.
#[test]
fn learns_equation_7() {
    let movements = 200;
    let (gs, as_) = (stream(movements, N_IN, 3), stream(movements, N_OUT, 4));
    let mut association = unlearnt();
    let rule = CovarianceRule {
        eta: 0.5,
        xi: 0.3,
        ..PAPER
    };
    association.learn(&rule, &gs, &as_).unwrap();
    let (eta, xi, w_max) = (0.5, f64::from(0.3_f32), f64::from(0.2_f32));
    let mut w = vec![0.0_f64; N_OUT * N_IN];
    let (mut a_bar, mut g_bar) = (vec![0.0_f64; N_OUT], vec![0.0_f64; N_IN]);
    for (g, a) in gs.chunks_exact(N_IN).zip(as_.chunks_exact(N_OUT)) {
        for j in 0..N_OUT {
            for i in 0..N_IN {
                let covariance = (f64::from(a[j]) - a_bar[j]) * (f64::from(g[i]) - g_bar[i]);
                let w_ji = &mut w[j * N_IN + i];
                *w_ji += eta * covariance * (w_max - w_ji.abs());
            }
        }
        for (bar, x) in a_bar.iter_mut().zip(a).chain(g_bar.iter_mut().zip(g)) {
            *bar = xi * *bar + (1.0 - xi) * f64::from(*x);
        }
    }
    for (learnt, expected) in association.weights().iter().zip(&w) {
        assert!((f64::from(*learnt) - expected).abs() < 1e-6);
    }
    for (learnt, expected) in association.a_mean().iter().zip(&a_bar) {
        assert!((f64::from(*learnt) - expected).abs() < 1e-6);
    }
}

/// Averages of a neuron that has fallen silent reach zero instead of ever smaller numbers.
/// Catches subnormal arithmetic, which makes learning tens of times slower.
#[test]
fn averages_fade_to_zero() {
    let mut association = unlearnt();
    association
        .learn(&PAPER, &[1.0; N_IN], &[1.0; N_OUT])
        .unwrap();
    for _ in 0..40 {
        association
            .learn(&PAPER, &[0.0; N_IN], &[0.0; N_OUT])
            .unwrap();
    }
    assert!(association.a_mean().iter().all(|&bar| bar == 0.0));
    assert!(association.g_mean().iter().all(|&bar| bar == 0.0));
}

/// A deviation below 1e-10 teaches nothing, on either side; one above does.
/// Catches a threshold on one side alone, and one so high that weak activity is lost.
#[test]
fn silence_teaches_nothing() {
    let learnt = |g, a| {
        let mut one = unlearnt();
        one.learn(&PAPER, &[g; N_IN], &[a; N_OUT]).unwrap();
        one.weights()[0]
    };
    assert_eq!(learnt(9e-11, 1.0), 0.0);
    assert_eq!(learnt(1.0, 9e-11), 0.0);
    assert!(learnt(1.1e-10, 1.0) > 0.0 && learnt(1.0, 1.1e-10) > 0.0);
}

/// A weight one ulp past its bound stays there, whatever is learnt next.
/// Catches the runaway of Eq. 7 where `w_max - |w|` is negative.
#[test]
fn weight_past_the_bound_stays() {
    for w in [PAPER.w_max.next_up(), -PAPER.w_max.next_up()] {
        let mut one = Association::from_parts(&[w], &[0.5], &[0.5]).unwrap();
        for k in 0..100 {
            one.learn(&PAPER, &[(k % 2) as f32], &[(k / 2 % 2) as f32])
                .unwrap();
        }
        assert_eq!(one.weights(), [w]);
    }
}

/// An association of no neurons or of too many is refused.
#[test]
fn bad_sizes_are_named() {
    let field = |n_in, n_out| match Association::new(n_in, n_out) {
        Err(BrainError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    assert_eq!(field(0, 2), "n_in");
    assert_eq!(field(2, 0), "n_out");
    assert_eq!(field(1 << 20, 1 << 20), "n_out");
}

/// Wrong lengths and activities that are none are refused by name, and nothing is learnt.
#[test]
fn bad_activities_are_named() {
    let mut association = unlearnt();
    let before = bits(&association);
    let (g, a) = ([0.5; N_IN], [0.5; N_OUT]);
    let length = |field, expected, actual| BrainError::Length {
        field,
        expected,
        actual,
    };
    let short = association.learn(&PAPER, &g[1..], &a).unwrap_err();
    assert_eq!(short, length("g", 0, N_IN - 1));
    let mut learn = |g: &[f32]| association.learn(&PAPER, g, &a).unwrap_err();
    assert_eq!(learn(&[0.5; 2 * N_IN]), length("a", 2 * N_OUT, N_OUT));
    assert_eq!(learn(&[0.5; N_IN + 1]), length("g", N_IN, N_IN + 1));
    for value in [-0.1, 1.5, f32::NAN, f32::INFINITY] {
        let mut bad = a;
        bad[3] = value;
        let message = association.learn(&PAPER, &g, &bad).unwrap_err().to_string();
        assert!(message.starts_with("a[3] = "), "{message}");
    }
    let mut out = [9.0; N_OUT];
    let few = association.recall(&g, &mut out[1..]).unwrap_err();
    assert_eq!(few, length("g", 0, N_IN));
    assert!(association.recall(&[f32::NAN; N_IN], &mut out).is_err());
    assert_eq!(bits(&association), before);
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let parts =
        |w: f32, n: usize, mean: f32| Association::from_parts(&vec![w; n], &[mean; 2], &[0.0; 3]);
    assert!(parts(-0.2, 6, 0.5).is_ok());
    let error = |result: Result<Association, BrainError>| result.unwrap_err().to_string();
    assert!(error(parts(0.1, 5, 0.5)).starts_with("weights has 5 elements, expected 6"));
    assert!(error(parts(0.1, 6, 1.5)).starts_with("a_mean[0] = 1.5"));
    assert!(error(parts(f32::INFINITY, 6, 0.5)).starts_with("weights[0] = inf"));
    assert!(error(parts(f32::NAN, 6, 0.5)).starts_with("weights[0] = NaN"));
}

/// An association goes on learning from its parts as if it had never been taken apart.
#[test]
fn parts_hold_the_whole_state() {
    let (gs, as_) = (stream(20, N_IN, 5), stream(20, N_OUT, 6));
    let mut whole = unlearnt();
    whole.learn(&PAPER, &gs, &as_).unwrap();
    let mut rebuilt =
        Association::from_parts(whole.weights(), whole.a_mean(), whole.g_mean()).unwrap();
    whole.learn(&PAPER, &gs, &as_).unwrap();
    rebuilt.learn(&PAPER, &gs, &as_).unwrap();
    assert_eq!(rebuilt, whole);
}

/// A batch of stimuli recalls what each of them does.
#[test]
fn recalls_in_batches() {
    let mut association = unlearnt();
    let gs = stream(5, N_IN, 7);
    association
        .learn(&PAPER, &gs, &stream(5, N_OUT, 8))
        .unwrap();
    let mut batch = vec![0.0; 5 * N_OUT];
    association.recall(&gs, &mut batch).unwrap();
    for (g, a) in gs.chunks_exact(N_IN).zip(batch.chunks_exact(N_OUT)) {
        let mut one = vec![0.0; N_OUT];
        association.recall(g, &mut one).unwrap();
        assert_eq!(one, a);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// |w| ≤ w_max to one ulp for any activities and any η in (0, 1], without clipping.
    /// Catches a sign error in w_max - |w| and averages that leave [0, 1].
    #[test]
    fn weights_stay_within_their_bound(
        eta in prop_oneof![Just(1.0_f32), 0.001_f32..=1.0],
        xi in 0.0_f32..0.999,
        gs in vec(activity(), 30 * N_IN),
        as_ in vec(activity(), 30 * N_OUT),
    ) {
        let mut association = unlearnt();
        association.learn(&CovarianceRule { eta, xi, ..PAPER }, &gs, &as_).unwrap();
        let bound = PAPER.w_max.next_up();
        prop_assert!(association.weights().iter().all(|w| w.abs() <= bound));
        prop_assert!(association.a_mean().iter().all(|bar| (0.0..=1.0).contains(bar)));
    }

    /// Recall is max(tanh(Σ w g), 0), computed plainly in f64.
    /// Catches a lost tail of the sum, transposed weights and tanh of a negative sum.
    #[test]
    fn recalls_equation_4(
        w in vec(-0.2_f32..0.2, N_OUT * N_IN),
        g in vec(activity(), N_IN),
    ) {
        let association = Association::from_parts(&w, &[0.0; N_OUT], &[0.0; N_IN]).unwrap();
        let mut a = vec![f32::NAN; N_OUT];
        association.recall(&g, &mut a).unwrap();
        for (row, a_j) in w.chunks_exact(N_IN).zip(a) {
            let products = row.iter().zip(&g).map(|(&w, &g)| f64::from(w) * f64::from(g));
            let expected = products.sum::<f64>().tanh().max(0.0);
            prop_assert!((f64::from(a_j) - expected).abs() < 2e-6);
        }
    }
}
