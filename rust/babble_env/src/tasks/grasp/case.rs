//! Start, object and goal of one episode.

use babble_body::Obstacle;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::config::RegionConfig;
use super::task::{GraspTask, MAX_TRIES};
use crate::case::CaseValues;
use crate::error::EnvError;
use crate::executor::Stop;
use crate::stream::Stream;
use crate::tasks::reach::case::{check_obstacle, obstacle_from, obstacle_value};

/// Least and greatest diameter of an object \[m\].
pub(super) const DIAMETER_BOUNDS_M: [f64; 2] = [0.005, 0.2];
/// Least distance from the object to the point that it is to be carried to \[m\].
const CARRY_M: f64 = 0.05;
/// Distance within which an object given by a user is at the place meant \[m\].
const SAME_PLACE_M: f64 = 1e-6;

/// One case of the grasping task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GraspCase {
    /// Shoulder and elbow at the start \[rad\]; the hand is open.
    pub start: [f64; 2],
    /// Centre of the object \[m\].
    pub object: [f64; 2],
    /// Its diameter \[m\].
    pub diameter: f64,
    /// In the goal form, where it is to be carried \[m\].
    pub goal: Option<[f64; 2]>,
    /// The obstacle, if there is one.
    pub obstacle: Option<Obstacle>,
}

impl GraspCase {
    /// The case as named values.
    pub(super) fn values(&self) -> CaseValues {
        let mut values = CaseValues::default()
            .with("start", self.start)
            .with("object", self.object)
            .with("diameter", self.diameter);
        if let Some(goal) = self.goal {
            values = values.with("goal", goal);
        }
        values.with("obstacle", obstacle_value(self.obstacle.as_ref()))
    }

    /// Radius of the object \[m\].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.diameter / 2.0
    }
}

/// Where a user wants the object. The order of the variants is that of their bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum ObjectPlace {
    /// Where it is drawn; the option `in_hand_starts` says how often that is in the hand.
    #[default]
    Sampled,
    /// With its centre at a point \[m\].
    At([f64; 2]),
    /// At the palm of the open hand.
    InHand,
    /// Where it is drawn, and not in the hand.
    Apart,
}

impl ObjectPlace {
    /// The point asked for, if there is one \[m\].
    #[must_use]
    pub const fn point(self) -> Option<[f64; 2]> {
        match self {
            Self::At(point) => Some(point),
            Self::Sampled | Self::InHand | Self::Apart => None,
        }
    }
}

/// What a user asks of the cases to come. What is not asked for is drawn; there is no obstacle
/// unless it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct GraspRequest {
    /// Shoulder and elbow at the start \[rad\].
    pub start: Option<[f64; 2]>,
    /// Where the object is.
    pub object: ObjectPlace,
    /// Diameter of the object \[m\].
    pub diameter: Option<f64>,
    /// Where the object is to be carried \[m\].
    pub goal: Option<[f64; 2]>,
    /// The obstacle.
    pub obstacle: Option<Obstacle>,
}

impl GraspRequest {
    /// What named values ask.
    pub(super) fn from_values(task: &GraspTask, asked: &CaseValues) -> Self {
        let object = match (asked.flag("in_hand"), asked.numbers("object")) {
            (Some(true), _) => ObjectPlace::InHand,
            (_, Some(point)) => ObjectPlace::At(point),
            (Some(false), None) => ObjectPlace::Apart,
            (None, None) => ObjectPlace::Sampled,
        };
        Self {
            start: asked.numbers("start"),
            object,
            diameter: asked.number("diameter"),
            goal: asked.numbers("goal"),
            obstacle: obstacle_from(asked, task.config.body.obstacle.radius_m),
        }
    }

    /// The next case that fulfils the request.
    ///
    /// # Errors
    /// [`EnvError::Case`] for a part that cannot be played, [`EnvError::NoGraspCase`] when the rest
    /// cannot be drawn, [`EnvError::Interrupted`] when `stop` says so.
    pub fn draw(
        &self,
        task: &GraspTask,
        stream: &mut Stream,
        stop: &Stop<'_>,
    ) -> Result<GraspCase, EnvError> {
        self.check(task)?;
        let fixed = matches!(self.object, ObjectPlace::At(_) | ObjectPlace::InHand);
        let placed = self.start.is_some() && fixed;
        let carried = !task.options.goal || self.goal.is_some();
        let tries = if placed && carried && self.diameter.is_some() {
            1
        } else {
            MAX_TRIES
        };
        let in_hand = self.is_in_hand(task, stream);
        let mut last = None;
        for _ in 0..tries {
            stop.check()?;
            let mut case = self.fill(task, stream);
            if in_hand {
                if self.start.is_none() {
                    case.start = task.draw_free_posture(case.radius(), stream)?;
                }
                case.object = task.at_palm(case.start, case.radius());
            }
            match playable(task, &case, self) {
                Ok(()) => return Ok(case),
                Err(error) => last = Some(error),
            }
        }
        match last {
            // The places were given, and no diameter or goal fits between them.
            Some(error) if placed => Err(error),
            last => Err(EnvError::NoGraspCase {
                tries,
                problem: last.map_or_else(String::new, |error| error.to_string()),
            }),
        }
    }

    /// Whether the object is to begin in the hand. Unless that is asked for, a case of which the start
    /// is given never does.
    fn is_in_hand(&self, task: &GraspTask, stream: &mut Stream) -> bool {
        let share = task.options.in_hand_starts;
        match self.object {
            ObjectPlace::InHand => true,
            ObjectPlace::At(_) | ObjectPlace::Apart => false,
            ObjectPlace::Sampled => {
                share > 0.0 && self.start.is_none() && stream.uniform(0.0, 1.0) < share
            }
        }
    }

    /// Draws what is not given.
    fn fill(&self, task: &GraspTask, stream: &mut Stream) -> GraspCase {
        let region = task.region();
        let diameter = task.draw_diameter(stream);
        let object = draw_point(region, stream);
        let start = draw_start(task, region, stream);
        let object = self.object.point().unwrap_or(object);
        let goal = task.options.goal.then(|| draw_point(region, stream));
        GraspCase {
            start: self.start.unwrap_or(start),
            object,
            diameter: self.diameter.unwrap_or(diameter),
            goal: goal.map(|goal| self.goal.unwrap_or(goal)),
            obstacle: self.obstacle,
        }
    }

    /// Checks what is given by itself.
    pub(super) fn check(&self, task: &GraspTask) -> Result<(), EnvError> {
        if let Some(start) = self.start {
            check_start(task, start)?;
        }
        for (what, point) in [("object", self.object.point()), ("goal", self.goal)] {
            let Some([x, y]) = point else { continue };
            let reach = task.arm.length();
            if !(x.is_finite() && y.is_finite() && libm::hypot(x, y) <= reach) {
                return Err(EnvError::Case {
                    what,
                    problem: format!("[{x}, {y}] m is not within the arm's reach of {reach:.3} m"),
                });
            }
        }
        if self.goal.is_some() && !task.options.goal {
            return Err(EnvError::Case {
                what: "goal",
                problem: "objects are carried with obs = \"goal\" alone".to_owned(),
            });
        }
        let [least, most] = DIAMETER_BOUNDS_M;
        if let Some(diameter) = self.diameter.filter(|d| !(least..=most).contains(d)) {
            return Err(EnvError::Case {
                what: "diameter",
                problem: format!("{diameter} m is not in {DIAMETER_BOUNDS_M:?}"),
            });
        }
        self.obstacle.as_ref().map_or(Ok(()), check_obstacle)
    }
}

fn check_start(task: &GraspTask, start: [f64; 2]) -> Result<(), EnvError> {
    if task.arm.in_range(start) {
        return Ok(());
    }
    let [shoulder, elbow] = start.map(f64::to_degrees);
    Err(EnvError::Case {
        what: "start",
        problem: format!(
            "shoulder {shoulder:.1}° and elbow {elbow:.1}° are outside of the joint ranges"
        ),
    })
}

/// Whether arm, object and obstacle are clear of each other at the start. A drawn object can also
/// be reached: some posture brings the palm to it. An object in the hand is nearer than others.
fn playable(task: &GraspTask, case: &GraspCase, request: &GraspRequest) -> Result<(), EnvError> {
    let posture = task.robot.open_hand(case.start);
    let centre = Vector2::from(case.object);
    let gap = task.robot.clearance(posture, &centre.push(0.0)) - case.radius();
    let palm = Vector2::from(task.at_palm(case.start, case.radius()));
    let in_hand = (centre - palm).norm() <= SAME_PLACE_M;
    let least = if in_hand {
        0.0
    } else {
        task.config.grasp.clearance_m
    };
    if gap < least {
        return Err(EnvError::Case {
            what: "object",
            problem: format!(
                "the arm at the start is {gap:.4} m from it, at least {least} m needed"
            ),
        });
    }
    if !in_hand
        && request.object.point().is_none()
        && task.grasp_posture(case.object, case.radius()).is_none()
    {
        return Err(EnvError::Case {
            what: "object",
            problem: format!("{:?} m cannot be brought to the palm", case.object),
        });
    }
    if let Some(goal) = case.goal.filter(|_| request.goal.is_none()) {
        check_goal(task, case, goal)?;
    }
    let Some(obstacle) = &case.obstacle else {
        return Ok(());
    };
    let arm = task.robot.clearance_of_vertical(posture, obstacle.centre) - obstacle.radius;
    let object = (obstacle.centre - centre).norm() - obstacle.radius - case.radius();
    if arm > 0.0 && object > 0.0 {
        return Ok(());
    }
    Err(EnvError::Case {
        what: "obstacle",
        problem: format!(
            "it is {arm:.4} m from the arm at the start and {object:.4} m from the object"
        ),
    })
}

/// A drawn goal is some way off, and some posture brings the object there.
fn check_goal(task: &GraspTask, case: &GraspCase, goal: [f64; 2]) -> Result<(), EnvError> {
    let [x, y] = [0, 1].map(|i| goal[i] - case.object[i]);
    let clear = case.obstacle.is_none_or(|obstacle| {
        (obstacle.centre - Vector2::from(goal)).norm() > obstacle.radius + case.radius()
    });
    let reachable = task.grasp_posture(goal, case.radius()).is_some();
    if clear && reachable && libm::hypot(x, y) >= CARRY_M {
        return Ok(());
    }
    Err(EnvError::Case {
        what: "goal",
        problem: format!("{goal:?} m is within {CARRY_M} m of the object, or cannot be reached"),
    })
}

/// Uniform in distance and direction from the shoulder.
fn draw_point(region: &RegionConfig, stream: &mut Stream) -> [f64; 2] {
    let radius = stream.uniform(region.radius_m[0], region.radius_m[1]);
    let polar = stream.uniform(region.polar_deg[0], region.polar_deg[1]);
    let (sin, cos) = libm::sincos(polar.to_radians());
    [radius * cos, radius * sin]
}

fn draw_start(task: &GraspTask, region: &RegionConfig, stream: &mut Stream) -> [f64; 2] {
    let ranges = [region.shoulder_deg, region.elbow_deg];
    [0, 1].map(|i| {
        let [low, high] = ranges[i].map(f64::to_radians);
        let (lower, upper) = (task.arm.lower[i], task.arm.upper_limit[i]);
        stream.uniform(low.clamp(lower, upper), high.clamp(lower, upper))
    })
}
