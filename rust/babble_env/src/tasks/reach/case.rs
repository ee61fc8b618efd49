//! Start, target and obstacle of one episode.

use babble_body::visual;
use babble_body::{ArmState, Obstacle};
use babble_eye::Gaze;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::task::ReachTask;
use crate::case::{CaseValue, CaseValues};
use crate::error::EnvError;
use crate::outcome::Outcome;
use crate::task::GoalSpace;

/// Greatest coordinate of an obstacle that a user places \[m\].
const FAR_M: f64 = 10.0;

/// One case of the reaching task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReachCase {
    /// Joint angles at the start \[rad\].
    pub start: [f64; 2],
    /// Position of the fingertip at the start \[m\].
    pub hand: [f64; 2],
    /// Position of the target \[m\].
    pub target: [f64; 2],
    /// The obstacle, if there is one.
    pub obstacle: Option<Obstacle>,
}

impl ReachCase {
    /// The case of a movement between two points, with the obstacle halfway between them.
    ///
    /// None where a point is out of reach, or where the arm would touch the obstacle at either end.
    #[must_use]
    pub fn between(task: &ReachTask, hand: Vector2<f64>, target: Vector2<f64>) -> Option<Self> {
        Self::around(task, hand, target, (hand + target) / 2.0)
    }

    /// The case with obstacle and start exchanged, as on the right of Fig. 4.
    ///
    /// None without an obstacle, where the new start is out of reach, or where the arm would touch
    /// the obstacle at either end.
    #[must_use]
    pub fn switched(&self, task: &ReachTask) -> Option<Self> {
        let start = self.obstacle?.centre;
        Self::around(task, start, self.target.into(), self.hand.into())
    }

    fn around(
        task: &ReachTask,
        hand: Vector2<f64>,
        target: Vector2<f64>,
        centre: Vector2<f64>,
    ) -> Option<Self> {
        let (start, end) = (task.posture(hand)?, task.posture(target)?);
        let obstacle = obstacle_at(task, centre.into());
        let clear = |q| obstacle.clearance(&task.arm, q) > 0.0;
        (clear(start) && clear(end)).then_some(Self {
            start,
            hand: hand.into(),
            target: target.into(),
            obstacle: Some(obstacle),
        })
    }

    /// A case chosen by a person: any start, target and obstacle that can be played.
    ///
    /// # Errors
    /// [`EnvError::Case`] naming the part that is out of reach, not finite or in the way.
    pub fn chosen(
        task: &ReachTask,
        hand: [f64; 2],
        target: [f64; 2],
        obstacle: Option<Obstacle>,
    ) -> Result<Self, EnvError> {
        let start = posture_for(task, "start", hand)?;
        posture_for(task, "target", target)?;
        if let Some(obstacle) = obstacle {
            check_obstacle(&obstacle)?;
            check_clear(task, &obstacle, start)?;
        }
        Ok(Self {
            start,
            hand,
            target,
            obstacle,
        })
    }

    /// The case as named values.
    pub(super) fn values(&self) -> CaseValues {
        let values = CaseValues::default()
            .with("start", self.hand)
            .with("target", self.target);
        values.with("obstacle", obstacle_value(self.obstacle.as_ref()))
    }

    /// Distance from start to target \[m\].
    #[must_use]
    pub fn distance(&self) -> f64 {
        (Vector2::from(self.target) - Vector2::from(self.hand)).norm()
    }
}

pub(super) fn posture_for(
    task: &ReachTask,
    what: &'static str,
    point: [f64; 2],
) -> Result<[f64; 2], EnvError> {
    let problem = |problem: String| EnvError::Case { what, problem };
    if !point.iter().all(|x| x.is_finite()) {
        return Err(problem(format!("{point:?} is not finite")));
    }
    let q = task.arm.posture_at(point.into()).ok_or_else(|| {
        problem(format!(
            "{point:?} m is out of the arm's reach of {:.3} m",
            task.arm.length()
        ))
    })?;
    if task.arm.in_range(q) {
        return Ok(q);
    }
    let [shoulder, elbow] = q.map(f64::to_degrees);
    Err(problem(format!(
        "{point:?} m needs shoulder {shoulder:.1}° and elbow {elbow:.1}°, outside of the joint ranges"
    )))
}

impl ReachTask {
    /// The posture with the fingertip at a point \[m\]; none where it is out of reach or of the joint
    /// ranges.
    pub(super) fn posture(&self, point: Vector2<f64>) -> Option<[f64; 2]> {
        self.arm.posture_at(point).filter(|&q| self.arm.in_range(q))
    }

    /// Whether the task is done while the arm is like this: the fingertip is at the target, and at
    /// rest if the options ask for that.
    ///
    /// The goal form compares the f32 numbers that an agent stores.
    #[must_use]
    pub fn is_reached(&self, case: &ReachCase, arm: &ArmState) -> bool {
        if self.options.goal {
            let [tip, target] = self.goals(case, arm.q);
            return self.goal_space().reward(&tip, &target) == 0.0;
        }
        let numbers = &self.config.reach;
        let rested = arm.v.iter().all(|v| v.abs() < numbers.settled_speed_rad_s);
        let near = self.distance(case, arm.q) <= numbers.success_radius_m;
        near && (rested || !self.options.settled)
    }

    /// Outcome of a movement that ended undisturbed with the arm like this.
    #[must_use]
    pub fn end_of_movement(&self, case: &ReachCase, arm: &ArmState) -> Outcome {
        if self.is_reached(case, arm) {
            Outcome::Success
        } else {
            Outcome::Timeout
        }
    }

    /// Positions of the fingertip in a posture and of the target \[m\].
    pub(super) fn goals(&self, case: &ReachCase, q: [f64; 2]) -> [[f32; 2]; 2] {
        let tip: [f64; 2] = self.arm.fingertip(q).into();
        [tip, case.target].map(|point| point.map(|x| x as f32))
    }

    /// What the goal form can achieve.
    pub(super) fn goal_space(&self) -> GoalSpace {
        GoalSpace {
            bound: self.arm.length(),
            radius: self.config.reach.success_radius_m,
        }
    }

    /// Distance from the fingertip to the target \[m\].
    #[must_use]
    pub fn distance(&self, case: &ReachCase, q: [f64; 2]) -> f64 {
        (self.arm.fingertip(q) - Vector2::from(case.target)).norm()
    }

    /// The gaze that the reflex of Eq. 1 ends in for `case`, from pixels.
    ///
    /// The red of the target shows through obstacle and arm: Sect. II-A assumes that the eye always
    /// foveates the target, and a solid obstacle of any height would hide it in some cases.
    ///
    /// # Errors
    /// [`EnvError::Body`] when the eye cannot find the target.
    pub fn foveate(&self, case: &ReachCase) -> Result<Gaze, EnvError> {
        let scene = [visual::target(&self.config.body, case.target)];
        Ok(self
            .eye
            .foveate(&scene, self.eye.rest())
            .map_err(babble_body::BodyError::from)?)
    }
}

/// Checks an obstacle that a user placed.
pub(crate) fn check_obstacle(obstacle: &Obstacle) -> Result<(), EnvError> {
    let near = obstacle.centre.iter().all(|x| x.abs() <= FAR_M);
    if near && (1e-4..=1.0).contains(&obstacle.radius) {
        return Ok(());
    }
    Err(EnvError::Case {
        what: "obstacle",
        problem: format!(
            "centre {:?} m must be within ±{FAR_M} m, and radius {} m in [0.0001, 1]",
            obstacle.centre.as_slice(),
            obstacle.radius
        ),
    })
}

pub(super) fn check_clear(
    task: &ReachTask,
    obstacle: &Obstacle,
    start: [f64; 2],
) -> Result<(), EnvError> {
    let clearance = obstacle.clearance(&task.arm, start);
    if clearance > 0.0 {
        return Ok(());
    }
    Err(EnvError::Case {
        what: "obstacle",
        problem: format!("the arm at the start is {:.4} m inside of it", -clearance),
    })
}

/// The config's obstacle with its axis through a point of the plane \[m\].
#[must_use]
pub fn obstacle_at(task: &ReachTask, centre: [f64; 2]) -> Obstacle {
    Obstacle {
        centre: centre.into(),
        radius: task.config.body.obstacle.radius_m,
    }
}

/// The obstacle among named values: (x, y, radius), or (x, y) with the config's radius \[m\].
pub(crate) fn obstacle_from(asked: &CaseValues, radius: f64) -> Option<Obstacle> {
    let given = asked.numbers("obstacle");
    let [x, y, radius] =
        given.or_else(|| asked.numbers("obstacle").map(|[x, y]| [x, y, radius]))?;
    Some(Obstacle {
        centre: [x, y].into(),
        radius,
    })
}

/// An obstacle as a named value.
pub(crate) fn obstacle_value(obstacle: Option<&Obstacle>) -> CaseValue {
    obstacle.map_or(CaseValue::Absent, |o| {
        [o.centre.x, o.centre.y, o.radius].into()
    })
}
