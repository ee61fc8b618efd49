//! What environments take and show is what their spec says.

mod playing;

use babble_env::spec::Spec;
use babble_env::task::{MAX_FACTS, MAX_TERMS};
use babble_env::tasks::{grasp, reach};
use babble_env::{Autoreset, Control, GraspOptions, Task};
use playing::{Actions, batch, control};

/// Numbers of senses and actions, outcomes, facts and terms, in every control. Catches a sense or
/// an outcome that is in the task and not in its spec, which Python would name wrongly.
#[test]
fn tasks_keep_to_their_spec() {
    for &of in Control::ALL {
        let mut env = batch(control(of), 8, Autoreset::NextStep, 1, 30);
        let (task, spec) = (env.task().clone(), env.task().spec());
        assert_eq!(task.action_len(), spec.action.labels.len());
        assert!(spec.facts.len() <= MAX_FACTS && spec.reward_terms.len() <= MAX_TERMS);
        let senses: usize = spec.senses.iter().map(|entry| entry.labels.len()).sum();
        assert_eq!(task.senses_len(), senses);
        let mut actions = Actions::new(8);
        for _ in 0..300 {
            env.step(&actions.draw()).unwrap();
            for record in env.records() {
                assert_eq!(record.senses.len(), senses);
                assert!(spec.outcomes.contains(&record.info.outcome.name()));
                let unnamed = &record.info.facts[spec.facts.len()..];
                assert!(unnamed.iter().all(|&fact| !fact));
            }
        }
    }
}

/// Names of the senses and where they begin in a flat observation.
fn places(spec: &Spec) -> Vec<(&'static str, usize)> {
    let mut end = 0;
    let place = spec.senses.iter().map(|sense| {
        let begin = end;
        end += sense.labels.len();
        (sense.name, begin)
    });
    place.collect()
}

/// Agents find a sense where the spec has it. Catches a sense that was moved in the spec alone.
#[test]
fn senses_stand_where_the_spec_says() {
    use reach::at::{ARM, EYE, HAND, OBSTACLE, STRETCH, TIME};
    let task = playing::task(control(Control::DeltaPosture));
    let expected = [
        ("arm", ARM),
        ("eye", EYE),
        ("hand", HAND),
        ("obstacle", OBSTACLE),
        ("stretch", STRETCH),
        ("time", TIME),
    ];
    assert_eq!(places(&task.spec()), expected);
}

#[test]
fn senses_of_grasping_stand_where_the_spec_says() {
    use grasp::at::{ARM, EYE, FOVEA, HAND, STRETCH, TIME, TOUCH};
    let task = playing::grasping::grasp(GraspOptions::default());
    let expected = [
        ("arm", ARM),
        ("eye", EYE),
        ("fovea", FOVEA),
        ("hand", HAND),
        ("stretch", STRETCH),
        ("time", TIME),
        ("touch", TOUCH),
    ];
    assert_eq!(places(&task.spec()), expected);
}
