//! The learning rules against the formulas that name them, and rules of one's own.

use babble_brain::{Association, BrainError, CovarianceRule, HebbRule, LearningRule, OjaRule};

/// Odd sizes, so that no tile or group of neurons comes out even.
const N_IN: usize = 37;
const N_OUT: usize = 13;
const MOVEMENTS: usize = 200;

/// Activities from a small generator, half of them silent.
fn activities(n: usize, mut seed: u32) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    (0..n).map(|_| (2.0 * next() - 1.0).max(0.0)).collect()
}

/// Largest difference of the weights that `rule` learns from those of a formula
/// Δw(a, ā, g, ḡ, w), computed plainly in `f64`.
fn difference(rule: &impl LearningRule, formula: impl Fn(f64, f64, f64, f64, f64) -> f64) -> f64 {
    let (gs, as_) = (
        activities(MOVEMENTS * N_IN, 1),
        activities(MOVEMENTS * N_OUT, 2),
    );
    let mut association = Association::new(N_IN, N_OUT).unwrap();
    association.learn(rule, &gs, &as_).unwrap();
    let mut w = vec![0.0; N_OUT * N_IN];
    let (mut a_mean, mut g_mean) = (vec![0.0; N_OUT], vec![0.0; N_IN]);
    let xi = f64::from(rule.xi());
    for (g, a) in gs.chunks_exact(N_IN).zip(as_.chunks_exact(N_OUT)) {
        for j in 0..N_OUT {
            for i in 0..N_IN {
                let w_ji = w[j * N_IN + i];
                let (a, g) = (f64::from(a[j]), f64::from(g[i]));
                w[j * N_IN + i] += formula(a, a_mean[j], g, g_mean[i], w_ji);
            }
        }
        for (mean, x) in a_mean.iter_mut().zip(a).chain(g_mean.iter_mut().zip(g)) {
            *mean = xi * *mean + (1.0 - xi) * f64::from(*x);
        }
    }
    let learnt = association.weights().iter().zip(&w);
    learnt
        .map(|(&w, expected)| (f64::from(w) - expected).abs())
        .fold(0.0, f64::max)
}

/// Each rule is its formula. Catches averages in Hebb's rule, a missing decay in Oja's, and a rule
/// that is given the signals of another.
#[test]
fn rules_are_their_formulas() {
    let covariance = CovarianceRule {
        eta: 0.5,
        w_max: 0.3,
        xi: 0.6,
    };
    let hebb = HebbRule {
        eta: 0.25,
        w_max: 0.5,
        xi: 0.0,
    };
    let oja = OjaRule {
        eta: 0.125,
        xi: 0.2,
    };
    let (w_max, half) = (f64::from(0.3_f32), 0.5);
    assert!(
        difference(&covariance, |a, a_mean, g, g_mean, w| {
            0.5 * (a - a_mean) * (g - g_mean) * (w_max - w.abs())
        }) < 1e-6
    );
    assert!(difference(&hebb, |a, _, g, _, w| 0.25 * a * g * (half - w.abs())) < 1e-6);
    assert!(difference(&oja, |a, _, g, _, w| 0.125 * a * (g - a * w)) < 1e-6);
}

/// A rule of one's own is as good as a built-in one: three lines, and the averages are at hand.
#[test]
fn a_rule_of_ones_own_learns() {
    struct Presynaptic;
    impl LearningRule for Presynaptic {
        fn post(&self, a: f32, _mean: f32) -> f32 {
            a
        }
        fn pre(&self, g: f32, mean: f32) -> f32 {
            g - mean
        }
        fn change(&self, post: f32, pre: f32, w: f32) -> f32 {
            0.5 * post * (pre - w)
        }
        fn xi(&self) -> f32 {
            0.5
        }
    }
    assert!(
        difference(&Presynaptic, |a, _, g, g_mean, w| 0.5
            * a
            * (g - g_mean - w))
            < 1e-6
    );
}

/// Where inputs and outputs are often active together by chance, Hebb's rule connects them all and
/// the covariance rule does not. This is why the paper takes Eq. 7.
#[test]
fn hebb_learns_chance_and_covariance_does_not() {
    let all = activities(10_000, 3);
    let (gs, as_) = all.split_at(5_000);
    let learnt = |rule: &dyn Fn(&mut Association)| {
        let mut association = Association::new(1, 1).unwrap();
        rule(&mut association);
        association.weights()[0]
    };
    let hebb = HebbRule {
        eta: 0.01,
        ..HebbRule::default()
    };
    let hebb = learnt(&|association| association.learn(&hebb, gs, as_).unwrap());
    let rule = CovarianceRule {
        eta: 0.01,
        ..CovarianceRule::default()
    };
    let covariance = learnt(&|association| association.learn(&rule, gs, as_).unwrap());
    assert!(
        hebb > 0.15 && covariance.abs() < 0.05,
        "{hebb} {covariance}"
    );
}

/// Oja's weights approach g/a of a pattern that repeats, unbounded by any `w_max`.
#[test]
fn oja_converges_to_the_pattern() {
    let mut association = Association::new(2, 1).unwrap();
    for _ in 0..2_000 {
        association
            .learn(&OjaRule::default(), &[0.8, 0.2], &[0.5])
            .unwrap();
    }
    let [w0, w1] = association.weights() else {
        panic!()
    };
    assert!(
        (w0 - 1.6).abs() < 1e-3 && (w1 - 0.4).abs() < 1e-3,
        "{w0} {w1}"
    );
}

/// Parameters out of range are named.
#[test]
fn bad_parameters_are_named() {
    let field = |result: Result<(), BrainError>| match result {
        Err(BrainError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    for eta in [0.0, 1.1, f32::NAN] {
        assert_eq!(
            field(
                CovarianceRule {
                    eta,
                    ..CovarianceRule::default()
                }
                .validate()
            ),
            "eta"
        );
        assert_eq!(
            field(
                HebbRule {
                    eta,
                    ..HebbRule::default()
                }
                .validate()
            ),
            "eta"
        );
        assert_eq!(field(OjaRule { eta, xi: 0.2 }.validate()), "eta");
    }
    for w_max in [0.0, -0.2, f32::INFINITY, f32::NAN] {
        let rule = CovarianceRule {
            w_max,
            ..CovarianceRule::default()
        };
        assert_eq!(field(rule.validate()), "w_max");
        assert_eq!(
            field(
                HebbRule {
                    w_max,
                    ..HebbRule::default()
                }
                .validate()
            ),
            "w_max"
        );
    }
    for xi in [-0.1, 1.0, f32::NAN] {
        assert_eq!(
            field(
                CovarianceRule {
                    xi,
                    ..CovarianceRule::default()
                }
                .validate()
            ),
            "xi"
        );
        assert_eq!(field(OjaRule { eta: 0.1, xi }.validate()), "xi");
    }
    assert!(toml::from_str::<CovarianceRule>("etta = 1").is_err());
}

/// The outstar's fixed point is the mean of what an input was paired with, weighted with its activity;
/// silent inputs learn nothing. Catches a rate that does not fall, and one for all inputs.
#[test]
fn the_outstar_learns_a_mean() {
    let mut association = Association::new(3, 2).unwrap();
    let g = [1.0, 0.5, 0.0, 0.25, 0.5, 0.0, 0.75, 0.0, 0.0];
    let a = [0.2, 1.0, 0.8, 0.0, 0.4, 0.5];
    association.learn_outstar(&g, &a).unwrap();
    for i in 0..3 {
        let used: f32 = (0..3).map(|m| g[3 * m + i]).sum();
        assert_eq!(association.g_mean()[i], used);
        for j in 0..2 {
            let sum: f32 = (0..3).map(|m| g[3 * m + i] * a[2 * m + j]).sum();
            let mean = if used > 0.0 { sum / used } else { 0.0 };
            assert!((association.weights()[3 * j + i] - mean).abs() < 1e-6);
        }
    }
    let mut copy = Association::new(3, 2).unwrap();
    copy.set_use(association.g_mean()).unwrap();
    assert_eq!(copy.g_mean(), association.g_mean());
    assert!(copy.set_use(&[-1.0, 0.0, 0.0]).is_err());
}
