//! Rewards, success and the end of an episode.

mod playing;

use babble_env::batch::Record;
use babble_env::progress::IS_SUCCESS;
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest, at};
use babble_env::{Autoreset, Batch, Control, Outcome, ReachOptions, ReachTask, Reward, Task};
use playing::{Actions, batch, control, goal};

fn record(env: &Batch<ReachTask>) -> Record {
    env.records().next().unwrap().clone()
}

/// An action of posture control that asks for the posture at the target.
fn to_target(env: &Batch<ReachTask>) -> [f32; 2] {
    let (task, target) = (env.task(), env.state(0).unwrap().case.target);
    let q = task.arm.posture_at(target.into()).unwrap();
    task.arm
        .normalised(q)
        .map(|share| (2.0 * share - 1.0) as f32)
}

fn without_obstacle(options: ReachOptions, seed: u64) -> Batch<ReachTask> {
    let mut env = batch(options, 1, Autoreset::Disabled, 1, seed);
    let obstacle = ObstacleRequest::Absent;
    env.request(
        0,
        CaseRequest {
            obstacle,
            ..CaseRequest::default()
        },
    )
    .unwrap();
    env.reset(&[true]).unwrap();
    env
}

/// The reward is the sum of its named terms, everywhere. Catches a term that is shown and not paid.
#[test]
fn terms_sum_to_the_reward() {
    for &of in Control::ALL {
        let sparse = ReachOptions {
            reward: Reward::Sparse,
            ..control(of)
        };
        for options in [control(of), sparse, goal(of)] {
            let mut env = batch(options, 8, Autoreset::SameStep, 1, 40);
            let named = env.task().spec().reward_terms.len();
            let mut actions = Actions::new(8);
            for _ in 0..80 {
                env.step(&actions.draw()).unwrap();
                for Record { step, .. } in env.records() {
                    assert_eq!(step.terms.iter().sum::<f64>(), step.reward);
                    assert!(step.terms[named..].iter().all(|&term| term == 0.0));
                }
            }
        }
    }
}

/// The progress of an episode adds up to the way made towards the target in units of 10 cm; +1 and
/// −1 are paid once, at its end. Catches a distance taken before the step, or from another episode.
#[test]
fn progress_adds_up_over_an_episode() {
    for &of in Control::ALL {
        for seed in 0..40 {
            let mut env = batch(control(of), 1, Autoreset::Disabled, 1, seed);
            let mut actions = Actions::new(1);
            let first = env.state(0).unwrap().distance;
            let (mut progress, mut others) = (0.0, 0.0);
            loop {
                env.step(&actions.draw()).unwrap();
                let step = record(&env).step;
                progress += step.terms[0];
                others += step.terms[1] + step.terms[2];
                if step.terminated || step.truncated {
                    break;
                }
                assert_eq!(others, 0.0);
            }
            let state = env.state(0).unwrap();
            assert!((progress - (first - state.distance) / 0.1).abs() < 1e-9);
            let paid = match state.progress.outcome {
                Outcome::Success => 1.0,
                Outcome::Collision | Outcome::JointLimit => -1.0,
                _ => 0.0,
            };
            assert_eq!(others, paid, "{of}: {}", state.progress.outcome);
        }
    }
}

/// With nothing in the way the arm gets there: success ends the episode and pays 1 in either
/// reward, on the first step within the radius. Asked to settle, it ends later and at rest.
#[test]
fn success_ends_the_episode() {
    for reward in [Reward::Progress, Reward::Sparse] {
        for settled in [false, true] {
            let options = ReachOptions {
                reward,
                settled,
                ..control(Control::Posture)
            };
            let mut env = without_obstacle(options, 3);
            let action = to_target(&env);
            let radius = env.task().config.reach.success_radius_m;
            let mut arrived = None;
            for step in 1.. {
                env.step(&action).unwrap();
                let (shown, state) = (record(&env), env.state(0).unwrap());
                if state.distance <= radius && arrived.is_none() {
                    arrived = Some(step);
                }
                assert_eq!(shown.info.facts[IS_SUCCESS], shown.step.terminated);
                if shown.step.terminated {
                    let slow = state.arm.v.iter().all(|v| v.abs() < 0.05);
                    assert!(if settled { slow } else { arrived == Some(step) });
                    assert_eq!(shown.info.outcome, Outcome::Success);
                    let term = usize::from(reward == Reward::Progress);
                    assert_eq!(shown.step.terms[term], 1.0);
                    break;
                }
                assert!(!shown.step.truncated && step < 240);
            }
        }
    }
}

/// Goal form: each step's reward is what the function of stored positions gives, 0 or −1, and no
/// episode ends before its time limit. Catches a reward that hindsight cannot recompute.
#[test]
fn goal_reward_is_the_steps_reward() {
    let mut reached = 0;
    for &of in Control::ALL {
        let mut env = batch(
            ReachOptions {
                max_episode_steps: 60,
                ..goal(of)
            },
            8,
            Autoreset::NextStep,
            1,
            1,
        );
        let task = env.task().clone();
        let mut actions = Actions::new(8);
        for k in 0..122 {
            let mut actions = actions.draw();
            if of == Control::Posture && k % 61 < 50 {
                actions[..2].copy_from_slice(&to_target(&env));
            }
            let resets: Vec<bool> = env.records().map(ends).collect();
            env.step(&actions).unwrap();
            for (shown, reset) in env.records().zip(resets) {
                if reset {
                    assert_eq!(shown.step.reward, 0.0);
                    continue;
                }
                let again = task.goal_reward(&shown.achieved, &shown.desired);
                assert_eq!(shown.step.reward, again);
                assert_eq!(shown.step.terminated, of == Control::Pattern);
                reached += usize::from(again == 0.0);
            }
        }
    }
    assert!(reached > 0, "no reward was ever earned");
}

fn ends(shown: &Record) -> bool {
    shown.step.terminated || shown.step.truncated
}

/// Goal form: an arm that touched the obstacle stands where it is until the time limit, whatever
/// the actions, and counts as a collision. Catches an arm that slips off and earns the goal.
#[test]
fn collision_holds_the_arm_in_goal_form() {
    let mut held = 0;
    for seed in 0..20 {
        let options = ReachOptions {
            max_episode_steps: 100,
            ..goal(Control::Posture)
        };
        let mut env = batch(options, 1, Autoreset::Disabled, 1, seed);
        let action = to_target(&env);
        let mut actions = Actions::new(1);
        let mut touched_at: Option<[f64; 2]> = None;
        for step in 1..=100 {
            let action = if touched_at.is_some() {
                [actions.draw()[0], 1.0]
            } else {
                action
            };
            env.step(&action).unwrap();
            let (shown, state) = (record(&env), env.state(0).unwrap());
            assert_eq!(
                (shown.step.terminated, shown.step.truncated),
                (false, step == 100)
            );
            if let Some(q) = touched_at {
                assert_eq!((state.arm.q, state.arm.v), (q, [0.0; 2]));
                assert_eq!(state.progress.outcome, Outcome::Collision);
                held += 1;
            }
            if state.progress.outcome == Outcome::Collision {
                touched_at = Some(state.arm.q);
            }
        }
    }
    assert!(held > 100, "{held} steps after a touch");
}

/// An episode is cut at its limit, on that step and none before, and the clock shows it. A movement
/// in pattern control is one step and ends by itself. Catches a limit that is one off.
#[test]
fn time_limit_truncates() {
    for of in [Control::DeltaPosture, Control::Posture, Control::Torque] {
        let options = ReachOptions {
            max_episode_steps: 7,
            ..control(of)
        };
        let mut env = batch(options, 1, Autoreset::Disabled, 1, 5);
        let still = if of == Control::Posture {
            to_start(&env)
        } else {
            [0.0; 2]
        };
        for step in 1..=7_u8 {
            env.step(&still).unwrap();
            let shown = record(&env);
            assert_eq!(
                (shown.step.terminated, shown.step.truncated),
                (false, step == 7)
            );
            assert_eq!(shown.senses[at::TIME], f32::from(step) / 7.0);
        }
        assert_eq!(record(&env).info.outcome, Outcome::Timeout);
    }
    let mut env = batch(control(Control::Pattern), 1, Autoreset::Disabled, 1, 5);
    env.step(&[0.5, -0.5]).unwrap();
    let Record { step, .. } = record(&env);
    assert_eq!((step.terminated, step.truncated), (true, false));
}

fn to_start(env: &Batch<ReachTask>) -> [f32; 2] {
    let start = env.state(0).unwrap().case.start;
    env.task()
        .arm
        .normalised(start)
        .map(|share| (2.0 * share - 1.0) as f32)
}

/// Each control does what its name says to an arm at rest: an angle added to the equilibrium point
/// and kept, a share of the range, a torque against damping alone. Catches mixed-up units.
#[test]
fn controls_act_on_their_quantity() {
    let state = |of, actions: &[[f32; 2]]| {
        let mut env = without_obstacle(control(of), 12);
        for action in actions {
            env.step(action).unwrap();
        }
        (env.task().clone(), env.state(0).unwrap().clone())
    };
    let (_, delta) = state(Control::DeltaPosture, &[[1.0, -0.5], [0.2, 0.0]]);
    let moved = [0, 1].map(|i| (delta.equilibrium[i] - delta.case.start[i]).to_degrees());
    assert!(
        (moved[0] - 6.0).abs() < 1e-6 && (moved[1] + 2.5).abs() < 1e-6,
        "{moved:?}"
    );
    let (task, posture) = state(Control::Posture, &[[0.0, -0.5]]);
    let share = task.arm.normalised(posture.equilibrium);
    assert!((share[0] - 0.5).abs() < 1e-9 && (share[1] - 0.25).abs() < 1e-9);
    let (_, torque) = state(Control::Torque, &[[0.1, 0.0]; 4]);
    // 5 N·m against 40 N·m·s/rad.
    assert!((torque.arm.v[0] - 0.125).abs() < 1e-3, "{:?}", torque.arm);
}
