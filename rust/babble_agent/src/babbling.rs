//! Random movements (motor babbling), of which the legal ones are experienced.

use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::{EnvError, Executor, Purpose, ReachCase, ReachTask, Stop, Stream};
use rayon::prelude::*;

use crate::error::AgentError;

/// Movements that are babbled together; half of them on average are made in vain at the end.
const CHUNK: u64 = 64;
/// With fewer legal movements than one in this many, nothing can be learnt.
const RAREST: u64 = 100_000;

/// What a legal movement leaves behind: percepts as the environment's senses give them, and what
/// was done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experience {
    /// Pan and tilt on the target, over their ranges.
    pub eye: [f32; 2],
    /// Angles of the obstacle in the camera frame \[rad\].
    pub obstacle: [f32; 2],
    /// Parameters (b1, b2) of the movement.
    pub b: [f32; 2],
}

/// A sequence of babbled movements. Movement k depends on the seed and k alone.
#[derive(Debug, Clone)]
pub struct Babbling {
    seed: u64,
    fidelity: Fidelity,
    movements: u64,
    legal: u64,
}

impl Babbling {
    /// The sequence of `seed` from its beginning.
    #[must_use]
    pub const fn new(seed: u64, fidelity: Fidelity) -> Self {
        Self::resume(seed, fidelity, 0, 0)
    }

    /// The sequence of `seed` after `movements` movements, of which `legal` were legal.
    #[must_use]
    pub const fn resume(seed: u64, fidelity: Fidelity, movements: u64, legal: u64) -> Self {
        Self {
            seed,
            fidelity,
            movements,
            legal,
        }
    }

    /// Movements babbled so far.
    #[must_use]
    pub const fn movements(&self) -> u64 {
        self.movements
    }

    /// How many of them were legal.
    #[must_use]
    pub const fn legal(&self) -> u64 {
        self.legal
    }

    /// Babbles until `n` more movements were legal.
    ///
    /// # Errors
    /// [`AgentError::NothingLegal`] when legal movements are too rare, or an error of the task or the
    /// pool; the sequence is then where it was.
    pub fn experience(
        &mut self,
        task: &ReachTask,
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
        task: &ReachTask,
        n: usize,
        stop: &Stop,
    ) -> Result<Vec<Experience>, AgentError> {
        let mut found = Vec::with_capacity(n);
        let (seed, fidelity) = (self.seed, self.fidelity);
        while found.len() < n {
            stop.check()?;
            let first = self.movements;
            let tried: Vec<_> = (first..first + CHUNK)
                .into_par_iter()
                .map(|k| movement(task, fidelity, Stream::new(Purpose::Learning, seed, k)))
                .collect();
            for result in tried {
                if found.len() == n {
                    break;
                }
                self.movements += 1;
                if let Some(experience) = result? {
                    self.legal += 1;
                    found.push(experience);
                }
            }
            if self.movements > RAREST * (self.legal + 1) {
                return Err(AgentError::NothingLegal {
                    legal: self.legal,
                    movements: self.movements,
                });
            }
        }
        Ok(found)
    }
}

/// One babbled movement: a random case, b1 uniform in its range and b2 = 1 − b1.
fn movement(
    task: &ReachTask,
    fidelity: Fidelity,
    mut stream: Stream,
) -> Result<Option<Experience>, EnvError> {
    let case = ReachCase::draw_geometry(task, &mut stream)?;
    let [low, high] = task.config.reach.b_range;
    let b1 = stream.uniform(low, high);
    let b = [b1, 1.0 - b1];
    if !MovementPath::new(task, &case, b)?.is_legal(task, &case, fidelity) {
        return Ok(None);
    }
    let gaze = task.foveate(&case)?;
    let camera = task.eye.camera(gaze);
    let single = |x: [f64; 2]| x.map(|x| x as f32);
    Ok(Some(Experience {
        eye: single(task.eye.normalised(gaze)),
        obstacle: single(ReachTask::obstacle_angles(&camera, case.obstacle.as_ref())),
        b: single(b),
    }))
}
