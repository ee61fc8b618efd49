//! Rules in a line: what they mean, what they learn, and what is wrong with those that cannot be used.

use babble_agent::AgentError;
use babble_agent::rule::OwnRule;
use babble_brain::{Association, CovarianceRule, HebbRule, LearningRule, OjaRule};
use babble_lab::expression::RuleExpression;

/// Odd sizes, so that no tile comes out even, and more movements than a block has.
const N_IN: usize = 151;
const N_OUT: usize = 13;
const MOVEMENTS: usize = 200;

const EQ_7: &str = "eta * (a - a_mean) * (g - g_mean) * (w_max - abs(w))";

/// Activities from a small generator, half of them silent.
fn activities(n: usize, mut seed: u32) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    (0..n).map(|_| (2.0 * next() - 1.0).max(0.0)).collect()
}

fn parsed(text: &str) -> RuleExpression {
    text.parse()
        .unwrap_or_else(|fault| panic!("{text}: {fault}"))
}

/// What an association learns by an expression, in two calls.
fn learnt_by(text: &str, numbers: OwnRule) -> Association {
    let (g, a) = (
        activities(MOVEMENTS * N_IN, 1),
        activities(MOVEMENTS * N_OUT, 2),
    );
    let mut association = Association::new(N_IN, N_OUT).unwrap();
    let rule = parsed(text);
    let (g, a) = (g.split_at(37 * N_IN), a.split_at(37 * N_OUT));
    for (g, a) in [(g.0, a.0), (g.1, a.1)] {
        rule.learn(numbers, &mut association, g, a).unwrap();
    }
    association
}

fn learnt(rule: &impl LearningRule) -> Association {
    let (g, a) = (
        activities(MOVEMENTS * N_IN, 1),
        activities(MOVEMENTS * N_OUT, 2),
    );
    let mut association = Association::new(N_IN, N_OUT).unwrap();
    association.learn(rule, &g, &a).unwrap();
    association
}

/// The rules that are built in, written as expressions, learn the same bits. Catches another order of
/// operations, averages that move before the weights change, and a block that begins with the wrong averages.
#[test]
fn rules_that_are_built_in_give_the_same_bits_as_expressions() {
    for (eta, w_max, xi) in [(1.0, 0.2, 0.2), (0.3, 0.5, 0.8), (1.0, 1.0, 0.0)] {
        let numbers = OwnRule { eta, w_max, xi };
        let covariance = learnt(&CovarianceRule { eta, w_max, xi });
        assert_eq!(learnt_by(EQ_7, numbers), covariance);
        assert_eq!(
            learnt_by("η·(a − ā)·(g − g\u{304})·(w_max − abs(w))", numbers),
            covariance
        );
        let hebb = learnt(&HebbRule { eta, w_max, xi });
        assert_eq!(learnt_by("eta * a * g * (w_max - abs(w))", numbers), hebb);
        let oja = learnt(&OjaRule { eta, xi });
        assert_eq!(learnt_by("eta * a * (g - a * w)", numbers), oja);
    }
}

/// A decay goes on where the output neuron is silent, with the bits of a plain loop over movements and weights.
/// Catches silent movements that are left out or counted twice, and the sign of the decay.
#[test]
fn a_decay_gives_the_bits_of_a_plain_loop() {
    let (g, a) = (
        activities(MOVEMENTS * N_IN, 1),
        activities(MOVEMENTS * N_OUT, 2),
    );
    let mut expected = vec![0.0_f32; N_IN * N_OUT];
    for (g, a) in g.chunks(N_IN).zip(a.chunks(N_OUT)) {
        for (w, a) in expected.chunks_mut(N_IN).zip(a) {
            for (w, g) in w.iter_mut().zip(g) {
                *w += 0.3 * a * (g - *w) - 0.01 * *w;
            }
        }
    }
    let numbers = OwnRule {
        eta: 0.3,
        ..OwnRule::default()
    };
    for decay in ["- 0.01 * w", "+ w * -0.01", "- w * 0.01"] {
        let learnt = learnt_by(&format!("eta * a * (g - w) {decay}"), numbers);
        assert_eq!(learnt.weights(), expected, "{decay}");
    }
}

/// Eq. 7 in another order of operations differs by rounding alone: in each movement by a few units in the last
/// place of a weight near `w_max`.
#[test]
fn eq_7_in_another_order_differs_by_rounding() {
    let numbers = OwnRule::default();
    let expected = learnt_by(EQ_7, numbers);
    let unit = numbers.w_max - numbers.w_max.next_down();
    for text in [
        "(w_max - abs(w)) * (g - g_mean) * eta * (a - a_mean)",
        "-(a_mean - a) * (w_max - max(w, -w)) * (g - g_mean) / (1 / eta)",
        "eta * a * g * (w_max - abs(w)) - eta * (a_mean * g + a * g_mean - a_mean * g_mean) * (w_max - abs(w))",
    ] {
        let found = learnt_by(text, numbers);
        let pairs = expected.weights().iter().zip(found.weights());
        let most = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
        let units = most / unit / MOVEMENTS as f32;
        assert!(
            units > 0.0 && units < 4.0,
            "{text}: {units} units in each movement"
        );
    }
}

/// The weight after one movement with a = 0.5, g = 0.25 and w = 0.125, both averages 0.75.
fn once(text: &str) -> f32 {
    let mut association = Association::from_parts(&[0.125], &[0.75], &[0.75]).unwrap();
    let numbers = OwnRule {
        eta: 0.25,
        w_max: 0.5,
        xi: 0.2,
    };
    parsed(text)
        .learn(numbers, &mut association, &[0.25], &[0.5])
        .unwrap();
    association.weights()[0] - 0.125
}

/// Each name, sign and function means what the page says, alone and together.
#[test]
fn expressions_mean_what_they_mean_on_paper() {
    for (text, expected) in [
        ("1", 1.0),
        ("w", 0.125),
        ("a", 0.5),
        ("g", 0.25),
        ("a_mean + g_mean", 1.5),
        ("eta - w_max", -0.25),
        ("8 - 2 - 1", 5.0),
        ("8 / 2 / 2", 2.0),
        ("2 + 3 * 4", 14.0),
        ("(2 + 3) * 4", 20.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("4^0.5", 2.0),
        ("2^9 - 2^8", 256.0),
        ("- - 3", 3.0),
        ("2 * -3", -6.0),
        ("1e1 + .5 + 5.", 15.5),
        ("min(a, g) + max(a, g)", 0.75),
        ("min(w, 1) + max(w, 1)", 1.125),
        ("abs(-3) + sign(-3) + sign(0) + sign(2)", 3.0),
        ("sqrt(16) * exp(0) + tanh(0)", 4.0),
        ("w * w - w^2", 0.0),
        ("a - a_mean", -0.25),
        ("w_max - abs(w)", 0.375),
        ("0.0625 - abs(w)", -0.0625),
        ("(a - 0.5) * (1 / (g - 0.25))", 0.0),
    ] {
        assert_eq!(once(text), expected, "{text}");
    }
}

/// A fault names the character, what stands there, and what was expected.
#[test]
fn faults_name_the_place_and_what_was_expected() {
    for (text, at, said) in [
        ("", 0, "the rule is empty"),
        ("  ", 0, "the rule is empty"),
        ("eta * gmean", 6, "did you mean g_mean?"),
        ("eta * Tanh(a)", 6, "did you mean tanh?"),
        ("eta * x", 6, "known are a, a_mean"),
        ("2 a", 2, "write * to multiply"),
        ("a (g)", 2, "write * to multiply"),
        ("ā ḡ", 2, "write * to multiply"),
        ("(a + g", 0, "never closed"),
        ("max(a, g", 3, "never closed"),
        ("a + g)", 5, "closes nothing"),
        ("0,5 * a", 1, "a decimal number has a point"),
        ("max(a)", 3, "max takes 2 arguments, and 1 are given"),
        ("abs(a, g)", 3, "abs takes 1 argument, and 2 are given"),
        ("abs a", 4, "expected ( after abs"),
        ("a * * g", 4, "where a number, a name or ( was expected"),
        ("a *", 3, "the end where a number"),
        ("a ^ ", 4, "the end where a number"),
        ("Δw = a", 3, "write only what Δw equals"),
        ("a > g", 2, "sign, min and max can replace"),
        ("|w|", 0, "write abs(w)"),
        ("a & g", 2, "'&' is unknown"),
        ("1.2.3", 0, "is not a number"),
        ("1e99", 0, "numbers go up to 3.4e38"),
    ] {
        let fault = RuleExpression::parse(text).unwrap_err();
        assert_eq!(fault.at, at, "{text}: {fault}");
        assert!(fault.problem.contains(said), "{text}: {fault}");
    }
}

/// Long and deep texts are refused before they can exhaust the stack.
#[test]
fn long_and_deep_expressions_are_refused() {
    let sum = vec!["a"; 250].join("+");
    assert_eq!(once(&sum), 125.0);
    let fault = RuleExpression::parse(&vec!["a"; 251].join("+")).unwrap_err();
    assert!(
        fault.problem.contains("501 characters; at most 500"),
        "{fault}"
    );
    for (open, close) in [("(", ")"), ("-", ""), ("abs(", ")"), ("2^", "")] {
        let nested = |n: usize| format!("{}a{}", open.repeat(n), close.repeat(n));
        assert!(RuleExpression::parse(&nested(31)).is_ok());
        let fault = RuleExpression::parse(&nested(32)).unwrap_err();
        assert!(fault.problem.contains("more than 32"), "{fault}");
    }
}

/// A change that is no finite number is an error that names the neurons and their values; nothing is learnt.
#[test]
fn a_change_that_is_not_finite_is_an_error_and_changes_nothing() {
    let mut g = vec![0.5; 3 * N_IN];
    g[2 * N_IN + 140] = 0.25;
    let a = vec![1.0; 3 * N_OUT];
    let mut association = Association::new(N_IN, N_OUT).unwrap();
    let before = association.clone();
    for (text, value) in [
        ("1 / (g - 0.25)", "inf"),
        ("sqrt(g - 0.3)", "NaN"),
        ("exp(1000 * (0.3 - g) + 1000 * (0.3 - g))", "inf"),
    ] {
        let error = parsed(text)
            .learn(OwnRule::default(), &mut association, &g, &a)
            .unwrap_err();
        let AgentError::Rule { problem } = error else {
            panic!("{error}");
        };
        let expected = format!(
            "the weight from input neuron 140 to output neuron 0 would become {value}, which is not finite, with \
             a = 1, a_mean = 0.96000004, g = 0.25, g_mean = 0.48000002, w = "
        );
        assert!(problem.starts_with(&expected), "{text}: {problem}");
        assert_eq!(association, before);
    }
}

/// Terms of a sum whose factor of the output neuron is zero are zero, whatever else is in them; the others are
/// added. Catches a term that is left out with them, and its sign.
#[test]
fn a_term_with_a_factor_that_is_zero_is_zero_and_the_others_stay() {
    let factored = "(a - a_mean) * exp(1000 * (1 + g)) / (1 + w)";
    for (text, expected) in [
        (factored.to_owned(), 0.2),
        (format!("{factored} - 0.5 * w"), 0.1),
        (format!("g - {factored}"), 0.45),
        (format!("-(0.5 * w + {factored} - g) - {factored}"), 0.35),
        (format!("-({factored}) - abs(w)"), 0.0),
    ] {
        let mut association = Association::new(2, 1).unwrap();
        association.set_weights(&[0.2, -0.2]).unwrap();
        let rule = parsed(&text);
        rule.learn(OwnRule::default(), &mut association, &[0.25, 0.0], &[0.0])
            .unwrap();
        let w = association.weights()[0];
        assert!((w - expected).abs() < 1e-6, "{text}: {w}");
    }
}

/// Activities of a wrong length or outside of [0, 1] are refused, and nothing is learnt.
#[test]
fn activities_that_are_none_are_refused() {
    let rule = parsed(EQ_7);
    let mut association = Association::new(2, 1).unwrap();
    for (g, a) in [
        (vec![0.5; 3], vec![0.5; 1]),
        (vec![0.5; 4], vec![0.5; 1]),
        (vec![0.5, 1.5], vec![0.5]),
        (vec![0.5; 2], vec![f32::NAN]),
    ] {
        let error = rule
            .learn(OwnRule::default(), &mut association, &g, &a)
            .unwrap_err();
        assert!(matches!(error, AgentError::Brain(_)), "{error}");
        assert_eq!(association, Association::new(2, 1).unwrap());
    }
}
