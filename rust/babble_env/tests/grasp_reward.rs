//! Rewards of grasping, and the goal form.

mod playing;

use babble_env::progress::Phase;
use babble_env::tasks::grasp::{FACTS, GraspRequest, GraspState, Grip, ObjectPlace, at};
use babble_env::{Autoreset, Batch, Control, GraspOptions, GraspTask, Outcome, Reward, Task};
use nalgebra::Vector3;
use playing::grasping::{
    CONTROLS, asked, asking_for, before_the_palm, goal_form, grasp, grasp_with, obstacle, play,
    script, with_control,
};
use playing::{Actions, ended, record, seeded};

fn state(env: &Batch<GraspTask>) -> &GraspState {
    env.state(0).unwrap()
}

fn sparse(control: Control) -> GraspOptions {
    GraspOptions {
        reward: Reward::Sparse,
        ..with_control(control)
    }
}

/// Numbers of senses, actions, facts and terms are the spec's, outcomes are named there, and the
/// reward is the sum of its named terms. Catches a term that is shown and not paid, and a fact that
/// Python would name wrongly.
#[test]
fn what_is_shown_is_in_the_spec() {
    for control in CONTROLS {
        for options in [with_control(control), sparse(control), goal_form(control)] {
            let options = GraspOptions {
                max_episode_steps: 25,
                ..options
            };
            let mut env = seeded(grasp(options), 3, Autoreset::SameStep, 1, 30);
            let near = before_the_palm(env.task(), 0.05);
            env.request(0, near).unwrap();
            env.reset(&[true; 3]).unwrap();
            let (task, spec) = (env.task().clone(), env.task().spec());
            assert_eq!(task.action_len(), spec.action.labels.len());
            assert_eq!(spec.facts, &FACTS[..]);
            let senses: usize = spec.senses.iter().map(|entry| entry.labels.len()).sum();
            assert_eq!(task.senses_len(), senses);
            let named = spec.reward_terms.len();
            let mut actions = Actions::of_width(3, 4);
            for _ in 0..40 {
                env.step(&actions.draw()).unwrap();
                for record in env.records() {
                    let step = record.step;
                    assert_eq!(record.senses.len(), senses);
                    assert_eq!(step.terms.iter().sum::<f64>(), step.reward);
                    assert!(step.terms[named..].iter().all(|&term| term == 0.0));
                    assert!(spec.outcomes.contains(&record.info.outcome.name()));
                    assert!(!record.info.facts[FACTS.len()..].contains(&true));
                }
            }
        }
    }
}

/// The object's distance from where the palm would hold it, by the arm's forward kinematics.
fn distance(task: &GraspTask, state: &GraspState) -> f64 {
    let [shoulder, elbow, ..] = task.robot.posture(&state.world);
    let [x, y] = task.before_palm([shoulder, elbow], state.case.radius(), 0.0);
    let object = task.robot.object(&state.world);
    (object - Vector3::new(x, y, 0.0)).norm()
}

/// Plays an episode; holds the terms of the progress reward to what they add up to.
fn adds_up(
    env: &mut Batch<GraspTask>,
    mut action: impl FnMut(&GraspTask, &GraspState) -> [f32; 4],
) {
    let task = env.task().clone();
    let first = state(env).distance;
    assert!((first - distance(&task, state(env))).abs() < 1e-5);
    let [mut progress, mut enclosure] = [0.0; 2];
    loop {
        let action = action(&task, state(env));
        env.step(&action).unwrap();
        let (shown, state) = (record(env), state(env));
        let [moved, closed, success, failure] = shown.step.terms;
        progress += moved;
        enclosure += closed;
        assert!((state.distance - distance(&task, state)).abs() < 1e-5);
        let share = state.enclosure.share(&task.config.grasp);
        assert!((progress - (first - state.distance) / 0.1).abs() < 1e-9);
        assert!((enclosure - share).abs() < 1e-9 && (0.0..=1.0).contains(&share));
        let paid = match state.progress.outcome {
            Outcome::Success => [1.0, 0.0],
            Outcome::Collision | Outcome::Lost => [0.0, -1.0],
            _ => [0.0; 2],
        };
        assert_eq!([success, failure], paid, "{}", state.progress.outcome);
        assert_eq!(shown.step.terminated, paid != [0.0; 2]);
        if ended(&shown) {
            return;
        }
    }
}

/// The progress of an episode adds up to the way of the object towards the palm in units of 10 cm,
/// the enclosure to the share at its end; +1 and −1 are paid once, with the end. Catches a distance
/// taken before the step or from another episode, and a share that is paid again after the support
/// went.
#[test]
fn progress_adds_up_over_an_episode() {
    let mut outcomes = Vec::new();
    for control in CONTROLS {
        for (seed, diameter) in [(0, 0.024), (1, 0.06)] {
            let task = grasp(with_control(control));
            let near = before_the_palm(&task, diameter);
            let mut env = asked(task, seed, near);
            adds_up(&mut env, |task, state| script(task, state, true));
            outcomes.push(state(&env).progress.outcome);
        }
        let short = GraspOptions {
            max_episode_steps: 40,
            ..with_control(control)
        };
        let mut env = asked(grasp(short), 5, GraspRequest::default());
        let mut actions = Actions::of_width(1, 4);
        adds_up(&mut env, |_, _| *actions.draw().first_chunk().unwrap());
        outcomes.push(state(&env).progress.outcome);
    }
    let slippery = r#"{"body": {"object": {"friction": 0, "density_kg_m3": 4000}}}"#;
    let task = grasp_with(slippery, with_control(Control::Posture));
    let near = before_the_palm(&task, 0.06);
    let mut env = asked(task, 0, near);
    adds_up(&mut env, |task, state| script(task, state, true));
    outcomes.push(state(&env).progress.outcome);
    for outcome in [Outcome::Success, Outcome::Timeout, Outcome::Lost] {
        assert!(outcomes.contains(&outcome), "{outcomes:?}");
    }
}

/// Sparse: nothing but 1 on the step of the success, whatever is lost.
#[test]
fn sparse_pays_for_the_success_alone() {
    let slippery = r#"{"body": {"object": {"friction": 0, "density_kg_m3": 4000}}}"#;
    for (config, paid) in [("{}", 1.0), (slippery, 0.0)] {
        let task = grasp_with(config, sparse(Control::Posture));
        let near = before_the_palm(&task, 0.06);
        let mut env = asked(task, 0, near);
        let mut sum = 0.0;
        play(&mut env, true, |env| sum += record(env).step.reward);
        let shown = record(&env);
        assert!(shown.step.terminated);
        assert_eq!((sum, shown.step.reward), (paid, paid));
    }
}

/// Grasps as the script does and carries the object to its goal.
fn carry(task: &GraspTask, state: &GraspState) -> [f32; 4] {
    if state.enclosure.grip != Grip::Held {
        return script(task, state, true);
    }
    let there = task.grasp_posture(state.case.goal.unwrap(), state.case.radius());
    let (arm, hand) = (there.unwrap(), task.reflex());
    asking_for(task, state, [arm[0], arm[1], hand[0], hand[1]])
}

/// Goal form: each step's reward is what the function of the shown positions gives, 0 or −1, and
/// `is_success` says the same; no episode ends before its time limit, and the outcome at the limit
/// is that of the last step. What the hand carries to its goal gets there. Catches a reward that
/// hindsight cannot recompute, and a grasp that ends the carrying.
#[test]
fn goal_reward_is_the_steps_reward() {
    let [mut earned, mut missed] = [0; 2];
    for control in CONTROLS {
        let options = GraspOptions {
            max_episode_steps: 150,
            ..goal_form(control)
        };
        let task = grasp(options);
        let near = before_the_palm(&task, 0.04);
        // Where it lies, and 8 and 80 mm further.
        for (shift, seed) in [(0.0, 0), (0.008, 1), (0.08, 2)] {
            let [x, y] = near.object.point().unwrap();
            let goal = [x - shift, y];
            let request = GraspRequest {
                goal: Some(goal),
                ..near
            };
            let mut env = asked(task.clone(), seed, request);
            let mut ever = false;
            for step in 1..=150 {
                let action = carry(&task, state(&env));
                env.step(&action).unwrap();
                let (shown, state) = (record(&env), state(&env));
                let object = task.robot.object(&state.world);
                let there = [object.x as f32, object.y as f32];
                assert_eq!(shown.achieved, there);
                assert_eq!(shown.desired, goal.map(|x| x as f32));
                let again = task.goal_reward(&there, &shown.desired);
                assert_eq!(shown.step.reward, again);
                assert_eq!(shown.step.terms, [again, 0.0, 0.0, 0.0]);
                assert_eq!(state.progress.is_success, again == 0.0);
                ever |= state.progress.is_success;
                assert_eq!(state.progress.ever_success, ever);
                let last = step == 150;
                assert_eq!((shown.step.terminated, shown.step.truncated), (false, last));
                let outcome = match (last, state.progress.is_success) {
                    (true, true) => Outcome::Success,
                    (true, false) => Outcome::Timeout,
                    _ => Outcome::Running,
                };
                assert_eq!(state.progress.outcome, outcome);
                earned += u32::from(again == 0.0);
                missed += u32::from(again != 0.0);
            }
            // Torques without stiffness let the fingers run on, and the object slips in the hand.
            let carries = control != Control::Torque;
            assert!(
                shift < 0.08 || state(&env).progress.is_success || !carries,
                "{control}"
            );
        }
    }
    assert!(earned > 100 && missed > 100, "{earned} {missed}");
}

/// The state but for the clock and what it says of the episode's course.
fn body(state: &GraspState) -> Vec<u8> {
    let mut state = state.clone();
    (
        state.progress.steps,
        state.lifecycle.phase,
        state.progress.outcome,
    ) = (0, Phase::Running, Outcome::Running);
    postcard::to_stdvec(&state).unwrap()
}

/// Plays an episode of the goal form in which something fails with `outcome`, and holds what follows
/// to standing still.
fn stands_still(env: &mut Batch<GraspTask>, outcome: Outcome, towards: [f64; 4]) {
    let task = env.task().clone();
    let limit = task.options.max_episode_steps;
    let mut actions = Actions::of_width(1, 4);
    let mut failed: Option<(Vec<u8>, Vec<f32>)> = None;
    let mut held = 0;
    for step in 1..=limit {
        let action = asking_for(&task, state(env), towards);
        if failed.is_some() {
            env.step(&actions.draw()).unwrap();
        } else {
            env.step(&action).unwrap();
        }
        let (shown, state) = (record(env), state(env));
        let again = task.goal_reward(&shown.achieved, &shown.desired);
        assert_eq!(shown.step.reward, again);
        assert_eq!(
            (shown.step.terminated, shown.step.truncated),
            (false, step == limit)
        );
        let mut senses = shown.senses.clone();
        senses.remove(at::TIME);
        if let Some(failed) = &failed {
            assert_eq!((body(state), senses), *failed);
            assert_eq!(state.progress.outcome, outcome);
            assert!(!state.progress.is_success);
            held += 1;
        } else if state.progress.outcome != Outcome::Running {
            assert_eq!(state.progress.outcome, outcome);
            failed = Some((body(state), senses));
        }
    }
    assert!(held > 10, "stood still for {held} steps");
}

/// Goal form: after a collision arm, object and senses stand as they are until the time limit,
/// whatever the actions, and that is no success and earns nothing, even with the object at its goal.
/// Catches a hand that slips off, and a failure at the goal that pays for the rest of the episode.
#[test]
fn a_collision_freezes_the_goal_form() {
    for control in CONTROLS {
        let options = GraspOptions {
            max_episode_steps: 60,
            ..goal_form(control)
        };
        let task = grasp(options);
        let way = obstacle(task.before_palm([0.5, 0.8], 0.0, 0.02), 0.02);
        let request = GraspRequest {
            start: Some([0.2, 0.8]),
            object: ObjectPlace::At([-0.2, 0.15]),
            goal: Some([-0.2, 0.15]),
            obstacle: Some(way),
            ..GraspRequest::default()
        };
        let mut env = asked(task.clone(), 0, request);
        stands_still(
            &mut env,
            Outcome::Collision,
            task.robot.open_hand([1.2, 0.8]),
        );
        assert_eq!(record(&env).step.reward, -1.0);
        assert!(!state(&env).progress.is_success && state(&env).progress.ever_success);
    }
}

/// The same after a loss.
#[test]
fn a_loss_freezes_the_goal_form() {
    let slippery = r#"{"body": {"object": {"support_friction": 0, "linear_damping": 0}}}"#;
    let options = GraspOptions {
        max_episode_steps: 110,
        ..goal_form(Control::Posture)
    };
    let task = grasp_with(slippery, options);
    let mut env = asked(task.clone(), 0, before_the_palm(&task, 0.06));
    stands_still(&mut env, Outcome::Lost, task.robot.open_hand([2.5, 0.4]));
    assert!(!state(&env).progress.is_success);
}

/// A hand that opens on the way drops the object: 10 cm below the plane it is lost, and not before,
/// though it was held. Catches a drop that only the support's absence would tell.
#[test]
fn what_is_dropped_is_lost() {
    let task = grasp(goal_form(Control::Posture));
    let near = before_the_palm(&task, 0.04);
    let [x, y] = near.object.point().unwrap();
    let goal = Some([x - 0.08, y]);
    let mut env = asked(task.clone(), 0, GraspRequest { goal, ..near });
    let (mut held, mut lost) = (false, 0);
    for _ in 0..task.options.max_episode_steps {
        let now = state(&env);
        held |= now.enclosure.grip == Grip::Held;
        let action = if held {
            asking_for(&task, now, task.robot.open_hand(now.case.start))
        } else {
            carry(&task, now)
        };
        env.step(&action).unwrap();
        let (shown, state) = (record(&env), state(&env));
        let below = task.robot.object(&state.world).z < -0.1;
        assert_eq!(state.progress.outcome == Outcome::Lost, below);
        assert_eq!(shown.info.facts[4], state.enclosure.grip == Grip::Held);
        lost += u32::from(below);
    }
    assert!(held && lost > 20, "{held} {lost}");
}
