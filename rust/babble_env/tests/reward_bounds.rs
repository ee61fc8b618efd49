//! No step of any episode earns more or less than the spec says.

mod playing;

use std::sync::Arc;

use babble_env::{Autoreset, Control, GraspOptions, Purpose, ReachOptions, Reward, Stream, Task};
use playing::grasping::{CONTROLS, goal_form, grasp, with_control};
use playing::{control, goal, seeded, task};

/// Least and greatest reward of steps whose actions are as large as they can be, and keep their
/// directions for some steps: fast and far.
fn extremes<T: Task>(task: &Arc<T>, steps: usize) -> [f64; 2] {
    const N: usize = 4;
    let mut envs = seeded(Arc::clone(task), N, Autoreset::SameStep, 1, 90);
    let mut stream = Stream::new(Purpose::Policy, 91, 0);
    let mut action = vec![0.0; N * task.action_len()];
    let [mut least, mut greatest] = [f64::INFINITY, f64::NEG_INFINITY];
    for _ in 0..steps {
        for number in &mut action {
            if stream.uniform(0.0, 1.0) < 0.15 {
                *number = [-1.0, 1.0][usize::from(stream.uniform(0.0, 1.0) < 0.5)];
            }
        }
        envs.step(&action).unwrap();
        for record in envs.records() {
            least = least.min(record.step.reward);
            greatest = greatest.max(record.step.reward);
        }
    }
    [least, greatest]
}

fn check<T: Task>(task: &Arc<T>, steps: usize) {
    let [low, high] = task.spec().reward_bounds;
    let [least, greatest] = extremes(task, steps);
    assert!(
        low < high && low <= least && greatest <= high,
        "{least}…{greatest}"
    );
}

/// Catches bounds of another reward, or of another unit of progress.
#[test]
fn reaching_keeps_to_its_bounds() {
    for &of in Control::ALL {
        let sparse = ReachOptions {
            reward: Reward::Sparse,
            ..control(of)
        };
        for options in [control(of), sparse, goal(of)] {
            check(&task(options), 600);
        }
    }
}

/// As in reaching.
#[test]
fn grasping_keeps_to_its_bounds() {
    for of in CONTROLS {
        let sparse = GraspOptions {
            reward: Reward::Sparse,
            ..with_control(of)
        };
        let stays = GraspOptions {
            support_stays: true,
            ..with_control(of)
        };
        for options in [with_control(of), stays, sparse, goal_form(of)] {
            check(&grasp(options), 40);
        }
    }
}
