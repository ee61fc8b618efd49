//! One whole movement along the path of the pattern generators (Sect. III-A).

use babble_body::{ArmState, Pull};
use babble_brain::TimeBaseGenerator;
use nalgebra::Vector2;

use super::case::ReachCase;
use super::task::ReachTask;
use crate::error::EnvError;
use crate::noise::Errors;
use crate::outcome::Outcome;

/// An arm with less than this clearance in a posture touches, whatever the rounding errors of the
/// bound in [`ContactWatch`](babble_body::ContactWatch) \[m\].
const SURELY_INSIDE_M: f64 = -1e-9;

/// How a movement is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fidelity {
    /// Muscles and inertia: the arm lags behind the posture asked for.
    Full,
    /// The arm is always in the posture asked for.
    QuasiStatic,
}

/// How a movement ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Movement {
    /// Success, collision, joint limit or timeout.
    pub outcome: Outcome,
    /// When it ended \[s\].
    pub time_s: f64,
    /// The arm at that moment.
    pub arm: ArmState,
}

/// The postures asked for, one a control period.
#[derive(Debug, Clone, PartialEq)]
pub struct MovementPath {
    /// Joint angles \[rad\], up to the first that leaves the joint ranges.
    postures: Vec<[f64; 2]>,
    /// Whether the path left the joint ranges after the last of `postures`.
    violates: bool,
}

impl MovementPath {
    /// Path of the movement with parameters b = (b1, b2): Eq. 5, placed by Eq. 6, turned into
    /// postures by inverse kinematics.
    ///
    /// # Errors
    /// [`EnvError::Brain`] for b outside of (0, 1).
    pub fn new(task: &ReachTask, case: &ReachCase, b: [f64; 2]) -> Result<Self, EnvError> {
        Ok(Self::along(task, case, &generator(task, b)?))
    }

    fn along(task: &ReachTask, case: &ReachCase, generator: &TimeBaseGenerator) -> Self {
        let steps = task.config.reach.movement_steps();
        let mut path = Self {
            postures: Vec::with_capacity(steps),
            violates: false,
        };
        for point in points(case, generator, steps) {
            let Some(q) = task.posture(point) else {
                path.violates = true;
                break;
            };
            path.postures.push(q);
        }
        path
    }

    /// Whether the movement with parameters b is [legal](Self::is_legal). Most movements are not, and
    /// one of a few postures on their way shows it: those are looked at before all others.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn is_legal_with(
        task: &ReachTask,
        case: &ReachCase,
        b: [f64; 2],
        fidelity: Fidelity,
    ) -> Result<bool, EnvError> {
        let generator = generator(task, b)?;
        let steps = task.config.reach.movement_steps();
        // Every 16th posture or, if they do not end with the last one, more.
        let few = steps >> steps.trailing_zeros().min(4);
        let surely_illegal = |point| {
            task.posture(point).is_none_or(|q| {
                fidelity == Fidelity::QuasiStatic
                    && case
                        .obstacle
                        .is_some_and(|obstacle| obstacle.clearance(&task.arm, q) < SURELY_INSIDE_M)
            })
        };
        if few < steps && points(case, &generator, few).any(surely_illegal) {
            return Ok(false);
        }
        Ok(Self::along(task, case, &generator).is_legal(task, case, fidelity))
    }

    /// Whether the movement neither touches the obstacle nor asks for a posture outside of the
    /// joint ranges. The ranges are looked at first, as they cost no simulation.
    #[must_use]
    pub fn is_legal(&self, task: &ReachTask, case: &ReachCase, fidelity: Fidelity) -> bool {
        !self.violates
            && match fidelity {
                Fidelity::Full => {
                    self.play(task, case, fidelity, |_| {}).outcome != Outcome::Collision
                }
                Fidelity::QuasiStatic => self.first_touch(task, case).is_none(),
            }
    }

    /// The movement without noise in the given fidelity; whichever of collision and joint limit comes
    /// first in time ends it. `each` is called with the arm at the end of every control period.
    pub fn play(
        &self,
        task: &ReachTask,
        case: &ReachCase,
        fidelity: Fidelity,
        each: impl FnMut(&ArmState),
    ) -> Movement {
        self.play_with(task, case, fidelity, &mut Errors::none(), each)
    }

    /// The same with the muscles' errors, which a quasi-static movement does not have.
    pub fn play_with(
        &self,
        task: &ReachTask,
        case: &ReachCase,
        fidelity: Fidelity,
        errors: &mut Errors,
        each: impl FnMut(&ArmState),
    ) -> Movement {
        match fidelity {
            Fidelity::Full => self.simulate(task, case, errors, each),
            Fidelity::QuasiStatic => self.follow(task, case, each),
        }
    }

    fn simulate(
        &self,
        task: &ReachTask,
        case: &ReachCase,
        errors: &mut Errors,
        mut each: impl FnMut(&ArmState),
    ) -> Movement {
        let period = task.config.reach.control_period_s;
        let mut arm = ArmState::at_rest(case.start);
        let mut watch = task.watch(case.obstacle, arm.q);
        let last = self.postures.last().copied().unwrap_or(case.start);
        let settling = if self.violates {
            0
        } else {
            task.settle_steps()
        };
        let held = std::iter::repeat_n(last, settling);
        for (k, asked) in self.postures.iter().copied().chain(held).enumerate() {
            let q_des = task.with_errors(asked, errors);
            let touched = task.advance(&mut arm, &mut watch, Pull::Towards(q_des));
            each(&arm);
            if touched {
                let time_s = (k + 1) as f64 * period;
                return Movement {
                    outcome: Outcome::Collision,
                    time_s,
                    arm,
                };
            }
        }
        let time_s = (self.postures.len() + settling) as f64 * period;
        let outcome = if self.violates {
            Outcome::JointLimit
        } else {
            task.end_of_movement(case, &arm)
        };
        Movement {
            outcome,
            time_s,
            arm,
        }
    }

    fn follow(
        &self,
        task: &ReachTask,
        case: &ReachCase,
        mut each: impl FnMut(&ArmState),
    ) -> Movement {
        let period = task.config.reach.control_period_s;
        let touch = self.first_touch(task, case);
        let played = touch.map_or(self.postures.len(), |k| k + 1);
        for &q in &self.postures[..played] {
            each(&ArmState::at_rest(q));
        }
        let last = self.postures[..played].last();
        let arm = ArmState::at_rest(last.copied().unwrap_or(case.start));
        let outcome = if touch.is_some() {
            Outcome::Collision
        } else if self.violates {
            Outcome::JointLimit
        } else {
            task.end_of_movement(case, &arm)
        };
        Movement {
            outcome,
            time_s: played as f64 * period,
            arm,
        }
    }

    /// Index of the first posture on the way to which the arm touches the obstacle.
    fn first_touch(&self, task: &ReachTask, case: &ReachCase) -> Option<usize> {
        let mut watch = task.watch(case.obstacle, case.start);
        let mut from = case.start;
        self.postures.iter().position(|&to| {
            let touch = watch.touch(&task.arm, from, to);
            from = to;
            touch.is_some()
        })
    }

    /// The postures asked for \[rad\], up to the first outside of the joint ranges.
    #[must_use]
    pub fn postures(&self) -> &[[f64; 2]] {
        &self.postures
    }

    /// The fingertip's desired positions \[m\], whether the arm can take them or not.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn desired(
        task: &ReachTask,
        case: &ReachCase,
        b: [f64; 2],
    ) -> Result<Vec<Vector2<f64>>, EnvError> {
        let steps = task.config.reach.movement_steps();
        Ok(points(case, &generator(task, b)?, steps).collect())
    }
}

/// Eq. 5 with parameters b.
fn generator(task: &ReachTask, [b1, b2]: [f64; 2]) -> Result<TimeBaseGenerator, EnvError> {
    Ok(TimeBaseGenerator::new(
        b1,
        b2,
        task.config.reach.movement_s,
    )?)
}

/// The fingertip's desired positions \[m\] at `count` equal intervals of time: Eq. 6.
fn points(
    case: &ReachCase,
    generator: &TimeBaseGenerator,
    count: usize,
) -> impl Iterator<Item = Vector2<f64>> {
    let mut curve = vec![[0.0; 2]; count];
    generator.sample_into(&mut curve);
    let (hand, target) = (case.hand, case.target);
    curve
        .into_iter()
        .map(move |c| babble_brain::generator::place(hand, target, c).into())
}
