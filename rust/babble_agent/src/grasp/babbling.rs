//! Babbling with the object in the hand: the enclosure reflex closes the hand, the arm moves.

use babble_env::tasks::grasp::{FOVEA_NEURONS, GraspTask, InHand};
use babble_env::{EnvError, Executor, Purpose, Stop, Stream};
use rayon::prelude::*;

use crate::error::AgentError;

/// Babbles that are made together.
const CHUNK: u64 = 64;
/// With fewer kept objects than one in this many, nothing can be learnt.
const RAREST: u64 = 1_000;
/// Time that the reflex closes the hand before the arm moves, and time that it moves \[s\]; 2 and 2
/// \[C\], in which the arm makes 86 % of its way.
const CLOSING_S: f64 = 2.0;
const MOVING_S: f64 = 2.0;
/// Time that one babble takes \[s\].
pub const BABBLE_S: f64 = CLOSING_S + MOVING_S;

/// Equilibrium points of thumb and virtual finger as the paper counts them: opening angles,
/// EP = 90° − flexion \[deg\].
pub type HandPosture = [f32; 2];

/// What a babble with the object in the hand leaves behind.
#[derive(Debug, Clone, PartialEq)]
pub struct Experience {
    /// Pan and tilt on the object, over their ranges: where it is.
    pub eye: [f32; 2],
    /// Edges in the fovea: what it is.
    pub fovea: Box<[f32; FOVEA_NEURONS]>,
    /// Shoulder and elbow as they are, as shares of their ranges.
    pub arm: [f32; 2],
    /// Thumb and finger as they are.
    pub hand: HandPosture,
    /// Diameter of the object \[m\].
    pub diameter: f64,
}

/// A sequence of babbles. Babble k depends on the seed and k alone.
#[derive(Debug, Clone)]
pub struct GraspBabbling {
    seed: u64,
    babbles: u64,
    kept: u64,
}

impl GraspBabbling {
    /// The sequence of `seed` from its beginning.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self::resume(seed, 0, 0)
    }

    /// The sequence of `seed` after `babbles`, in `kept` of which the hand kept the object.
    #[must_use]
    pub const fn resume(seed: u64, babbles: u64, kept: u64) -> Self {
        Self {
            seed,
            babbles,
            kept,
        }
    }

    /// Its seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Babbles so far.
    #[must_use]
    pub const fn babbles(&self) -> u64 {
        self.babbles
    }

    /// In how many of them the hand kept the object in sight of the eye.
    #[must_use]
    pub const fn kept(&self) -> u64 {
        self.kept
    }

    /// Babbles until `n` more objects were kept.
    ///
    /// # Errors
    /// [`AgentError::NothingHeld`] when hands that keep the object are too rare, or an error of the
    /// task or the pool; the sequence is then where it was.
    pub fn experience(
        &mut self,
        task: &GraspTask,
        n: usize,
        pool: &mut Executor,
    ) -> Result<Vec<Experience>, AgentError> {
        let mut ahead = self.clone();
        let found = pool.run_until(|stop| ahead.babble(task, n, stop))??;
        *self = ahead;
        Ok(found)
    }

    fn babble(
        &mut self,
        task: &GraspTask,
        n: usize,
        stop: &Stop,
    ) -> Result<Vec<Experience>, AgentError> {
        let mut found = Vec::with_capacity(n);
        let seed = self.seed;
        while found.len() < n {
            let first = self.babbles;
            // No more than may be needed: each takes milliseconds.
            let count = CHUNK.min((n - found.len()) as u64);
            let tried: Vec<_> = (first..first + count)
                .into_par_iter()
                .map(|k| {
                    stop.check()?;
                    babble(task, &mut Stream::new(Purpose::Learning, seed, k))
                })
                .collect();
            self.babbles += count;
            for result in tried {
                if let Some(experience) = result? {
                    self.kept += 1;
                    found.push(experience);
                }
            }
            if self.babbles > RAREST * (self.kept + 1) {
                return Err(AgentError::NothingHeld {
                    kept: self.kept,
                    babbles: self.babbles,
                });
            }
        }
        Ok(found)
    }
}

/// One babble, from a random posture to another: none if the hand lost the object, or hides all of
/// it.
fn babble(task: &GraspTask, stream: &mut Stream) -> Result<Option<Experience>, EnvError> {
    let diameter = task.draw_diameter(stream);
    let mut object = InHand::draw(task, diameter, stream)?;
    let to = task.draw_free_posture(diameter / 2.0, stream)?;
    object.carry(task, object.start(), CLOSING_S);
    object.carry(task, to, MOVING_S);
    if !object.is_held(task) {
        return Ok(None);
    }
    let mut fovea = Box::new([0.0; FOVEA_NEURONS]);
    let Some(gaze) = object.see(task, &mut fovea) else {
        return Ok(None);
    };
    let posture = object.posture(task);
    let share = task.robot.normalised(posture);
    Ok(Some(Experience {
        eye: task.eye.normalised(gaze).map(|x| x as f32),
        fovea,
        arm: [share[0], share[1]].map(|x| x.clamp(0.0, 1.0) as f32),
        hand: [posture[2], posture[3]].map(|flexion| (90.0 - flexion.to_degrees()) as f32),
        diameter,
    }))
}
