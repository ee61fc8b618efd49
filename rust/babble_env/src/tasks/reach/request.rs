//! Cases as a user asks for them, and random ones.

use babble_body::Obstacle;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::case::{ReachCase, check_clear, check_obstacle, obstacle_from, posture_for};
use super::movement::{Fidelity, MovementPath};
use super::search::Search;
use super::task::ReachTask;
use crate::case::CaseValues;
use crate::error::EnvError;
use crate::executor::Stop;
use crate::options::Control;
use crate::stream::Stream;

impl ReachCase {
    /// A random geometry: target uniform in joint space, start in a uniform direction at a uniform
    /// distance from it \[C\].
    ///
    /// # Errors
    /// [`EnvError::NoLegalCase`] when the config leaves no room for one.
    pub fn draw_geometry(task: &ReachTask, stream: &mut Stream) -> Result<Self, EnvError> {
        let stop = Stop::default();
        Self::search_geometry(task, stream, &mut Search::new(task, &stop))
    }

    fn search_geometry(
        task: &ReachTask,
        stream: &mut Stream,
        search: &mut Search<'_>,
    ) -> Result<Self, EnvError> {
        let [near, far] = task.config.reach.distance_m;
        loop {
            search.draw()?;
            let q = task
                .arm
                .denormalised([stream.uniform(0.0, 1.0), stream.uniform(0.0, 1.0)]);
            let target = task.arm.fingertip(q);
            let (sin, cos) = libm::sincos(stream.uniform(0.0, std::f64::consts::TAU));
            let distance = stream.uniform(near, far);
            let hand = target + Vector2::new(cos, sin) * distance;
            if let Some(case) = Self::between(task, hand, target) {
                return Ok(case);
            }
        }
    }

    /// The case of a babbled movement that was legal: geometry and b1 are drawn until one is.
    ///
    /// Such a case can be solved, as those of the paper's test set can.
    ///
    /// # Errors
    /// [`EnvError::NoLegalCase`] when the config leaves no room for one; [`EnvError::Interrupted`] when
    /// `stop` says so.
    pub fn draw_legal(
        task: &ReachTask,
        stream: &mut Stream,
        fidelity: Fidelity,
        stop: &Stop<'_>,
    ) -> Result<Self, EnvError> {
        Self::search_legal(task, stream, fidelity, &mut Search::new(task, stop))
    }

    fn search_legal(
        task: &ReachTask,
        stream: &mut Stream,
        fidelity: Fidelity,
        search: &mut Search<'_>,
    ) -> Result<Self, EnvError> {
        let [low, high] = task.config.reach.b_range;
        loop {
            let case = Self::search_geometry(task, stream, search)?;
            search.play()?;
            let b1 = stream.uniform(low, high);
            if MovementPath::is_legal_with(task, &case, [b1, 1.0 - b1], fidelity)? {
                return Ok(case);
            }
        }
    }
}

/// What a user asks of the cases to come. What is not asked for is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CaseRequest {
    /// Position of the fingertip at the start \[m\].
    pub start: Option<[f64; 2]>,
    /// Position of the target \[m\].
    pub target: Option<[f64; 2]>,
    /// The obstacle, or that there is none.
    pub obstacle: ObstacleRequest,
}

/// What a user asks of the obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum ObstacleRequest {
    /// Halfway between start and target.
    #[default]
    Halfway,
    /// None.
    Absent,
    /// This one.
    At(Obstacle),
}

impl CaseRequest {
    /// What named values ask: without `obstacle` it stands halfway.
    pub(super) fn from_values(task: &ReachTask, asked: &CaseValues) -> Self {
        let radius = task.config.body.obstacle.radius_m;
        Self {
            start: asked.numbers("start"),
            target: asked.numbers("target"),
            obstacle: match (asked.get("obstacle"), obstacle_from(asked, radius)) {
                (_, Some(obstacle)) => ObstacleRequest::At(obstacle),
                (None, None) => ObstacleRequest::Halfway,
                (Some(_), None) => ObstacleRequest::Absent,
            },
        }
    }

    /// Checks what is given by itself.
    pub(super) fn check(&self, task: &ReachTask) -> Result<(), EnvError> {
        for (what, point) in [("start", self.start), ("target", self.target)] {
            if let Some(point) = point {
                posture_for(task, what, point)?;
            }
        }
        match &self.obstacle {
            ObstacleRequest::At(obstacle) => check_obstacle(obstacle),
            ObstacleRequest::Halfway | ObstacleRequest::Absent => Ok(()),
        }
    }

    /// The next case that fulfils the request.
    ///
    /// # Errors
    /// [`EnvError::Case`] for a part that cannot be played, [`EnvError::NoLegalCase`] when the rest
    /// cannot be drawn, [`EnvError::Interrupted`] when `stop` says so.
    pub fn draw(
        &self,
        task: &ReachTask,
        stream: &mut Stream,
        stop: &Stop<'_>,
    ) -> Result<ReachCase, EnvError> {
        if let (Some(start), Some(target)) = (self.start, self.target) {
            return self.both_given(task, start, target);
        }
        let search = &mut Search::new(task, stop);
        match self.obstacle {
            ObstacleRequest::Halfway => self.draw_ends(task, stream, search),
            ObstacleRequest::Absent => Ok(ReachCase {
                obstacle: None,
                ..self.draw_ends(task, stream, search)?
            }),
            ObstacleRequest::At(obstacle) => self.draw_around(task, stream, obstacle, search),
        }
    }

    fn draw_ends(
        &self,
        task: &ReachTask,
        stream: &mut Stream,
        search: &mut Search<'_>,
    ) -> Result<ReachCase, EnvError> {
        match (self.start, self.target) {
            (None, None) => ReachCase::search_legal(task, stream, drawn_by(task), search),
            (start, target) => draw_other_end(task, stream, start, target, search),
        }
    }

    /// Draws the ends until the arm at both of them is clear of a placed obstacle.
    fn draw_around(
        &self,
        task: &ReachTask,
        stream: &mut Stream,
        obstacle: Obstacle,
        search: &mut Search<'_>,
    ) -> Result<ReachCase, EnvError> {
        check_obstacle(&obstacle)?;
        if let Some(start) = self.start {
            check_clear(task, &obstacle, posture_for(task, "start", start)?)?;
        }
        loop {
            let case = self.draw_ends(task, stream, search)?;
            let end = posture_for(task, "target", case.target)?;
            if [case.start, end]
                .iter()
                .all(|&q| obstacle.clearance(&task.arm, q) > 0.0)
            {
                return Ok(ReachCase {
                    obstacle: Some(obstacle),
                    ..case
                });
            }
        }
    }

    fn both_given(
        &self,
        task: &ReachTask,
        start: [f64; 2],
        target: [f64; 2],
    ) -> Result<ReachCase, EnvError> {
        let halfway = || Obstacle {
            centre: (Vector2::from(start) + Vector2::from(target)) / 2.0,
            radius: task.config.body.obstacle.radius_m,
        };
        let obstacle = match self.obstacle {
            ObstacleRequest::Halfway => Some(halfway()),
            ObstacleRequest::Absent => None,
            ObstacleRequest::At(obstacle) => Some(obstacle),
        };
        ReachCase::chosen(task, start, target, obstacle)
    }
}

/// How the movement is simulated by which a case is drawn. In `pattern` control the action is a whole
/// movement, so one must be legal with the muscles' lag too. The other controls can wait on the way.
const fn drawn_by(task: &ReachTask) -> Fidelity {
    match task.options.control {
        Control::Pattern => Fidelity::Full,
        Control::DeltaPosture | Control::Posture | Control::Torque => Fidelity::QuasiStatic,
    }
}

/// Draws the end that was not given, at a uniform direction and distance from the one that was.
fn draw_other_end(
    task: &ReachTask,
    stream: &mut Stream,
    start: Option<[f64; 2]>,
    target: Option<[f64; 2]>,
    search: &mut Search<'_>,
) -> Result<ReachCase, EnvError> {
    let (what, given) = match (start, target) {
        (Some(start), _) => ("start", start),
        (None, target) => ("target", target.unwrap_or_default()),
    };
    posture_for(task, what, given)?;
    let [near, far] = task.config.reach.distance_m;
    let given = Vector2::from(given);
    loop {
        search.draw()?;
        let (sin, cos) = libm::sincos(stream.uniform(0.0, std::f64::consts::TAU));
        let other = given + Vector2::new(cos, sin) * stream.uniform(near, far);
        let (hand, target) = if start.is_some() {
            (given, other)
        } else {
            (other, given)
        };
        let [low, high] = task.config.reach.b_range;
        let b1 = stream.uniform(low, high);
        let Some(case) = ReachCase::between(task, hand, target) else {
            continue;
        };
        search.play()?;
        if MovementPath::is_legal_with(task, &case, [b1, 1.0 - b1], drawn_by(task))? {
            return Ok(case);
        }
    }
}
