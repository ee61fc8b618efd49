//! When a grasp counts, as a law of the counts of enclosing contacts alone.

use babble_env::Config;
use babble_env::tasks::grasp::{Contacts, Enclosure, GraspConfig, Grip};
use proptest::collection::vec;
use proptest::prelude::*;

fn numbers() -> GraspConfig {
    Config::profile("paper").unwrap().grasp
}

/// The law over a whole history of (physics steps with contact, in the hand): the step at which the
/// support goes, and the step of the verdict with whether it is held.
fn reference(
    numbers: &GraspConfig,
    history: &[(u8, bool)],
) -> (Option<usize>, Option<(usize, bool)>) {
    let (window, per_step) = (numbers.hold_steps as usize, numbers.physics_steps);
    let whole = f64::from(numbers.hold_steps * per_step);
    let sum = |range: &[(u8, bool)]| range.iter().map(|step| f64::from(step.0)).sum::<f64>();
    let goes = (window..=history.len()).find(|&end| {
        history[end - 1].1 && sum(&history[end - window..end]) >= numbers.enclosed_share * whole
    });
    let verdict = goes.and_then(|start| {
        (start + 1..=history.len().min(start + window)).find_map(|end| {
            let to_come = f64::from((start + window - end) as u32 * per_step);
            let most = sum(&history[start..end]) + to_come;
            let passes = most > numbers.held_share * whole;
            (!passes || end == start + window).then_some((end, passes))
        })
    });
    (goes, verdict)
}

/// Contacts of both sides of the hand in the same physics steps.
fn both(contacts: u8) -> Contacts {
    Contacts {
        enclosing: contacts,
        fingers: contacts,
        opposite: contacts,
    }
}

/// A finger alone, or the palm alone, is half of what encloses. Catches a share that counts the
/// enclosing contacts alone, or either side twice.
#[test]
fn one_side_is_worth_half() {
    let numbers = numbers();
    let one_side = [
        Contacts {
            fingers: 10,
            ..Contacts::default()
        },
        Contacts {
            opposite: 10,
            ..Contacts::default()
        },
    ];
    for contacts in one_side {
        let mut enclosure = Enclosure::default();
        for step in 1..=40 {
            assert!(!enclosure.step(&numbers, contacts, true));
            let share = 0.5 * f64::from(step.min(20)) / 20.0;
            assert!((enclosure.share(&numbers) - share).abs() < 1e-12);
        }
        assert_eq!(enclosure.grip, Grip::Open);
    }
}

/// Steps through a history; the same two moments.
fn played(numbers: &GraspConfig, history: &[(u8, bool)]) -> (Option<usize>, Option<(usize, bool)>) {
    let mut enclosure = Enclosure::default();
    let (mut goes, mut verdict) = (None, None);
    for (i, &(contacts, in_hand)) in history.iter().enumerate() {
        let removed = enclosure.step(numbers, both(contacts), in_hand);
        if removed {
            assert_eq!((goes, enclosure.grip), (None, Grip::Tried(0)));
            goes = Some(i + 1);
        }
        let first = (i + 1).saturating_sub(numbers.hold_steps as usize);
        let steps = history[first..=i].iter();
        let sum: u32 = steps.map(|step| u32::from(step.0)).sum();
        let whole = numbers.hold_steps * numbers.physics_steps;
        assert_eq!(enclosure.share(numbers), f64::from(sum) / f64::from(whole));
        match enclosure.grip {
            Grip::Open => {}
            Grip::Tried(steps) => assert_eq!(goes, Some(i + 1 - steps as usize)),
            Grip::Held | Grip::Failed => {
                verdict = verdict.or(Some((i + 1, enclosure.grip == Grip::Held)));
            }
        }
    }
    (goes, verdict)
}

/// Histories of contact in all `per_step` physics steps, but for one control step in `patchy`.
fn history(per_step: u8, patchy: f64) -> impl Strategy<Value = Vec<(u8, bool)>> {
    let contacts = (prop::bool::weighted(patchy), 0..=per_step)
        .prop_map(move |(missing, contacts)| if missing { contacts } else { per_step });
    vec((contacts, prop::bool::weighted(0.9)), 0..90)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Over any history the support goes at the end of the first window of 20 control steps with
    /// contact in 95 % of the physics steps and the object in the hand; then the next 20 must have
    /// it in more than 90 %, and it has failed as soon as they cannot any more. Catches windows
    /// that are one step off or partly filled, contacts of the first window that count in the
    /// second, and "at least" in place of "more than".
    #[test]
    fn enclosure_keeps_to_its_law(history in (0.0..0.2_f64).prop_flat_map(|patchy| history(10, patchy))) {
        let numbers = numbers();
        prop_assert_eq!(played(&numbers, &history), reference(&numbers, &history));
    }

    /// The same with other numbers: the windows and shares are the config's. Catches a 20 or a 10
    /// that is written out.
    #[test]
    fn enclosure_keeps_to_the_config(
        (hold_steps, physics_steps, history) in (1_u32..12, 1_u8..8, 0.0..1.0_f64).prop_flat_map(|(hold, physics, patchy)| {
            (Just(hold), Just(physics), history(physics, patchy))
        }),
        enclosed in 1_u32..=64, held in 1_u32..64,
    ) {
        let numbers = GraspConfig {
            hold_steps,
            physics_steps: physics_steps.into(),
            // In 64ths, so that a share of a count is exact.
            enclosed_share: f64::from(enclosed) / 64.0,
            held_share: f64::from(held) / 64.0,
            ..numbers()
        };
        prop_assert_eq!(played(&numbers, &history), reference(&numbers, &history));
    }
}

/// The paper body's numbers, counted by hand: 190 of 200 enclose and 189 do not, 181 of 200 hold and
/// 180 do not, which is known at the step that misses the twentieth.
#[test]
fn thresholds_by_hand() {
    let numbers = numbers();
    let with_misses = |full: usize, missed: u8, first_window: bool| {
        let mut window = vec![(10, true); full];
        let at = if first_window { 0 } else { 20 };
        for k in 0..usize::from(missed.div_ceil(10)) {
            window[at + k].0 = 10 - missed.saturating_sub(10 * k as u8).min(10);
        }
        played(&numbers, &window)
    };
    assert_eq!(with_misses(20, 10, true), (Some(20), None));
    assert_eq!(with_misses(20, 11, true), (None, None));
    assert_eq!(with_misses(40, 19, false), (Some(20), Some((40, true))));
    assert_eq!(with_misses(40, 20, false), (Some(20), Some((22, false))));
    // A share of 0.95 must be exceeded too: 190 of 200 do not, though 1 − 0.95 is not exact.
    let strict = GraspConfig {
        held_share: 0.95,
        ..numbers
    };
    let mut history = vec![(10, true); 40];
    history[20].0 = 0;
    assert_eq!(played(&strict, &history), (Some(20), Some((21, false))));
    history[20].0 = 1;
    assert_eq!(played(&strict, &history), (Some(20), Some((40, true))));
}

/// Wedged elsewhere than before the palm, nothing is enclosed, however long it lasts.
#[test]
fn contact_outside_of_the_hand_does_not_count() {
    assert_eq!(played(&numbers(), &[(10, false); 60]), (None, None));
}
