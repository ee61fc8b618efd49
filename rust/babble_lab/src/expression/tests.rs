//! Laws of parsing, printing and learning, for any expression.

use babble_agent::rule::OwnRule;
use babble_brain::Association;
use proptest::prelude::*;

use super::RuleExpression;
use super::syntax::{Expr, One, Quantity, Two};

fn expressions() -> impl Strategy<Value = Expr> {
    let number = (0..0x7F80_0000_u32).prop_map(|bits| Expr::Number(f32::from_bits(bits)));
    let quantity = (0..Quantity::NAMES.len()).prop_map(|i| Expr::Quantity(Quantity::NAMES[i].1));
    let ones = prop::sample::select(vec![
        One::Negate,
        One::Abs,
        One::Sign,
        One::Sqrt,
        One::Exp,
        One::Tanh,
    ]);
    let twos = vec![
        Two::Add,
        Two::Subtract,
        Two::Multiply,
        Two::Divide,
        Two::Power,
        Two::Min,
        Two::Max,
    ];
    let twos = prop::sample::select(twos);
    prop_oneof![number, quantity].prop_recursive(5, 24, 2, move |inner| {
        prop_oneof![
            (ones.clone(), inner.clone()).prop_map(|(one, x)| Expr::One(one, Box::new(x))),
            (twos.clone(), inner.clone(), inner).prop_map(|(two, x, y)| Expr::Two(
                two,
                Box::new(x),
                Box::new(y)
            )),
        ]
    })
}

proptest! {
    /// What is printed is read as the same expression. Catches parentheses that are missing where they matter.
    #[test]
    fn what_is_printed_is_parsed_as_the_same(expr in expressions()) {
        let rule = RuleExpression(expr);
        let text = rule.to_string();
        prop_assume!(text.chars().count() <= super::MOST_CHARACTERS);
        prop_assert_eq!(RuleExpression::parse(&text), Ok(rule), "{}", text);
    }

    /// Any text is a rule or has a fault within it.
    #[test]
    fn any_text_is_a_rule_or_has_a_fault_within_it(text in "\\PC{0,60}") {
        if let Err(fault) = RuleExpression::parse(&text) {
            prop_assert!(fault.at <= text.chars().count());
        }
    }

    /// So is any text made of the language's own words.
    #[test]
    fn any_words_are_a_rule_or_have_a_fault_within_them(
        words in prop::collection::vec(prop::sample::select(vec![
            "a", "ā", "g_mean", "w", "eta", "w_max", "1", "0.5", "1e-3", "+", "-", "*", "/", "^", "(", ")", ",",
            "min(", "tanh(", "abs", " ",
        ]), 0..40)
    ) {
        let text = words.concat();
        match RuleExpression::parse(&text) {
            Ok(rule) => prop_assert_eq!(RuleExpression::parse(&rule.to_string()), Ok(rule)),
            Err(fault) => prop_assert!(fault.at <= text.chars().count()),
        }
    }

    /// Learning by any expression leaves finite weights, or an error and the association as it was.
    #[test]
    fn learning_leaves_finite_weights_or_nothing(
        expr in expressions(),
        activities in prop::collection::vec(0.0_f32..=1.0, 3 * 4),
    ) {
        let mut association = Association::new(3, 1).unwrap();
        let before = association.clone();
        let (g, a) = activities.split_at(9);
        let learnt = RuleExpression(expr).learn(OwnRule::default(), &mut association, g, a);
        prop_assert!(association.weights().iter().all(|w| w.is_finite()));
        prop_assert!(learnt.is_ok() || association == before);
    }
}
