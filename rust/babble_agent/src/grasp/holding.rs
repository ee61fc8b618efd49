//! How well the reflex holds: objects put at the palm, carried about without support.

use babble_env::tasks::grasp::{GraspState, GraspTask, InHand};
use babble_env::{EnvError, Executor, Purpose, Stream};

/// Time that the reflex closes the hand before the support goes \[s\].
const CLOSING_S: f64 = 3.0;
/// Time that the arm is moved about \[s\].
const MOVING_S: f64 = 10.0;
/// Time between two random postures of the arm \[s\].
const CHANGE_S: f64 = 0.5;

/// How a trial went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Whether the object was in the hand at the end.
    pub held: bool,
    /// How deep it was inside of arm and hand at most \[m\].
    pub penetration: f64,
    /// Flexion of thumb and finger before the support went \[rad\].
    pub flexion: [f64; 2],
}

/// How many objects of a size the reflex holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Holding {
    /// Trials in which the object was in the hand at the end.
    pub held: usize,
    /// How deep an object was inside of arm and hand at most \[m\].
    pub penetration: f64,
    /// Mean flexion of thumb and finger before the support went \[rad\].
    pub flexion: [f64; 2],
}

impl Holding {
    /// The summary of some trials.
    #[must_use]
    pub fn of(trials: &[Trial]) -> Self {
        let n = trials.len() as f64;
        let mean = |i: usize| trials.iter().map(|trial| trial.flexion[i]).sum::<f64>() / n;
        let depths = trials.iter().map(|trial| trial.penetration);
        Self {
            held: trials.iter().filter(|trial| trial.held).count(),
            penetration: depths.fold(0.0, f64::max),
            flexion: [mean(0), mean(1)],
        }
    }
}

/// Whether a hand that holds an object in an episode keeps it, without support, while the arm moves for
/// so many seconds to a random posture every half second; the hand's equilibrium points stay.
///
/// # Errors
/// [`EnvError::NoGraspCase`] if the body has no such posture.
pub fn keeps(
    task: &GraspTask,
    state: &GraspState,
    seconds: f64,
    seed: u64,
) -> Result<bool, EnvError> {
    let mut stream = Stream::new(Purpose::Test, seed, 1);
    let mut object = InHand::of(state);
    object.remove_support(task);
    let [.., thumb, finger] = state.equilibrium;
    for _ in 0..(seconds / CHANGE_S).round() as usize {
        let [shoulder, elbow] = task.draw_free_posture(state.case.radius(), &mut stream)?;
        object.pull(task, [shoulder, elbow, thumb, finger], CHANGE_S);
    }
    Ok(object.is_held(task))
}

/// `n` trials with the seeds 0, 1, …: the reflex closes on an object of `diameter` \[m\] in a random
/// posture, the support goes, and the arm moves for 10 s to a random posture every half second.
///
/// # Errors
/// An error of the task or the executor.
pub fn trials(
    task: &GraspTask,
    diameter: f64,
    n: usize,
    executor: &mut Executor,
) -> Result<Vec<Trial>, EnvError> {
    executor.map(0..n, |seed, _| {
        trial(
            task,
            diameter,
            &mut Stream::new(Purpose::Test, seed as u64, 0),
        )
    })
}

fn trial(task: &GraspTask, diameter: f64, stream: &mut Stream) -> Result<Trial, EnvError> {
    let mut object = InHand::draw(task, diameter, stream)?;
    let mut penetration = object.carry(task, object.start(), CLOSING_S);
    let [.., thumb, finger] = object.posture(task);
    object.remove_support(task);
    for _ in 0..(MOVING_S / CHANGE_S) as usize {
        let to = task.draw_free_posture(diameter / 2.0, stream)?;
        penetration = penetration.max(object.carry(task, to, CHANGE_S));
    }
    Ok(Trial {
        held: object.is_held(task),
        penetration,
        flexion: [thumb, finger],
    })
}
