//! Babbling with the object in the hand: the enclosure reflex closes the hand, the arm moves.

use babble_env::picture::Film;
use babble_env::tasks::grasp::{FOVEA_NEURONS, InHand};
use babble_env::{EnvError, GraspTask, Outcome, Purpose, Stream};

use serde::{Deserialize, Serialize};

use crate::babbling::{Babble, Column, ColumnKind};
use crate::chain::{self, Sequence};

/// Time that the reflex closes the hand before the arm moves \[s\]; 2 \[C\].
const CLOSING_S: f64 = 2.0;
/// Random postures that the arm is given, one after the other; 3 \[C\].
pub const POSTURES: usize = 3;
/// Time that the arm moves to each of them \[s\]; 2 \[C\], in which it makes 86 % of its way.
const MOVING_S: f64 = 2.0;
/// Time that one babble takes \[s\].
const BABBLE_S: f64 = CLOSING_S + POSTURES as f64 * MOVING_S;

/// Equilibrium points of thumb and virtual finger as the paper counts them: opening angles,
/// EP = 90° − flexion \[deg\].
pub type HandPosture = [f32; 2];

/// What a moment of a babble with the object in the hand leaves behind.
#[derive(Debug, Clone, PartialEq)]
pub struct Experience {
    /// Pan and tilt on the object, over their ranges: where it is. NaN where all of it is hidden.
    pub eye: [f32; 2],
    /// Edges in the fovea: what it is. Zeros where all of it is hidden.
    pub fovea: Box<[f32; FOVEA_NEURONS]>,
    /// Shoulder and elbow as they are, as shares of their ranges.
    pub arm: [f32; 2],
    /// Thumb and finger as they are.
    pub hand: HandPosture,
    /// In a chain, shoulder and elbow before the grasp, as shares of their ranges; `arm` is then where
    /// the palm touched.
    pub pregrasp: Option<[f32; 2]>,
    /// Diameter of the object \[m\].
    pub diameter: f64,
    /// Success if the hand kept the object to the end of the babble, lost if not.
    pub outcome: Outcome,
}

impl Experience {
    /// Whether the hand kept the object, and the eye sees it.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.outcome == Outcome::Success && !self.eye[0].is_nan()
    }
}

/// How an infant babbles in grasping.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(untagged)]
pub enum GraspBabbling {
    /// With the object in the hand, as in the paper.
    #[default]
    InHand,
    /// In a chain that ends in a grasp.
    Chain(Sequence),
}

impl Babble for GraspTask {
    type Options = GraspBabbling;
    type Experience = Experience;

    const TRIES: usize = 1;
    const RAREST: u64 = 500;
    const PERIODS_S: Option<[f64; 2]> = Some([0.01, MOVING_S]);

    /// From a random posture to others. It can be learnt from if the hand kept the object to the end,
    /// whenever the eye sees it. The period begins anew with each posture.
    fn babble(
        &self,
        options: GraspBabbling,
        period_s: Option<f64>,
        stream: &mut Stream,
        all: bool,
    ) -> Result<Vec<Experience>, EnvError> {
        let (mut experiences, _) = made(self, options, period_s, stream, false)?;
        experiences.retain(|one| all || one.is_kept());
        Ok(experiences)
    }

    fn film(
        &self,
        options: GraspBabbling,
        period_s: Option<f64>,
        stream: &mut Stream,
    ) -> Result<(Vec<Experience>, Film), EnvError> {
        made(self, options, period_s, stream, true)
    }

    fn babble_steps(&self, options: GraspBabbling) -> usize {
        let seconds = match options {
            GraspBabbling::InHand => BABBLE_S,
            GraspBabbling::Chain(sequence) => chain::infant::seconds(&sequence),
        };
        (seconds / self.config.grasp.control_period_s).round() as usize
    }

    fn is_learnable(experience: &Experience) -> bool {
        experience.is_kept()
    }

    fn with_action_of(experience: &Experience, other: &Experience) -> Experience {
        Experience {
            arm: other.arm,
            hand: other.hand,
            pregrasp: other.pregrasp,
            ..experience.clone()
        }
    }

    fn outcome(experience: &Experience) -> Outcome {
        experience.outcome
    }

    fn columns(all: &[Experience]) -> Vec<Column> {
        let mut columns = vec![
            Column::of("eye", ColumnKind::Percept, all, |e| e.eye),
            Column::of("fovea", ColumnKind::Percept, all, |e| *e.fovea),
            Column::of("arm", ColumnKind::Action, all, |e| e.arm),
            Column::of("hand", ColumnKind::Action, all, |e| e.hand),
            Column::of("diameter", ColumnKind::Case, all, |e| [e.diameter as f32]),
        ];
        if all.iter().any(|e| e.pregrasp.is_some()) {
            let pregrasp = |e: &Experience| e.pregrasp.unwrap_or([f32::NAN; 2]);
            let column = Column::of("pregrasp", ColumnKind::Action, all, pregrasp);
            columns.push(column);
        }
        columns
    }
}

/// A babble, with its film if it is to be filmed.
fn made(
    task: &GraspTask,
    options: GraspBabbling,
    period_s: Option<f64>,
    stream: &mut Stream,
    filmed: bool,
) -> Result<(Vec<Experience>, Film), EnvError> {
    match options {
        GraspBabbling::InHand => {
            let choose = |_, radius, stream: &mut Stream| task.draw_free_posture(radius, stream);
            carried(task, period_s, stream, filmed, choose)
        }
        GraspBabbling::Chain(sequence) => {
            let (one, film) = chain::infant::made(task, &sequence, stream, filmed)?;
            Ok((vec![one], film))
        }
    }
}

/// Babbles to postures of the arm that somebody chooses, shares of its joint ranges, with an experience
/// at the end of each movement. All else is as in babble `index` of the seed.
///
/// # Errors
/// An error of the task.
pub fn babble_to(
    task: &GraspTask,
    seed: u64,
    index: u64,
    postures: &[[f64; 2]; POSTURES],
) -> Result<Vec<Experience>, EnvError> {
    let mut stream = Stream::new(Purpose::Learning, seed, index);
    let choose = |i: usize, _, _: &mut Stream| Ok(task.arm.denormalised(postures[i]));
    Ok(carried(task, Some(MOVING_S), &mut stream, false, choose)?.0)
}

/// One babble to postures that `choose` gives for their number and the object's radius, with an
/// experience at its end or every `period_s` seconds, and its film if it is to be filmed.
fn carried(
    task: &GraspTask,
    period_s: Option<f64>,
    stream: &mut Stream,
    filmed: bool,
    choose: impl Fn(usize, f64, &mut Stream) -> Result<[f64; 2], EnvError>,
) -> Result<(Vec<Experience>, Film), EnvError> {
    let diameter = task.draw_diameter(stream);
    let mut object = InHand::draw(task, diameter, stream)?;
    if filmed {
        object.start_film(task);
    }
    object.carry(task, object.start(), CLOSING_S);
    let step_s = task.config.grasp.physics_step_s();
    let steps = |seconds: f64| (seconds / step_s).round().max(1.0);
    let period = period_s.map_or(f64::INFINITY, steps);
    let mut experiences = Vec::new();
    for i in 0..POSTURES {
        let to = choose(i, diameter / 2.0, stream)?;
        let mut left = steps(MOVING_S);
        while left >= period {
            object.carry(task, to, period * step_s);
            experiences.push(experience(task, &object, diameter));
            object.mark();
            left -= period;
        }
        object.carry(task, to, left * step_s);
    }
    if period_s.is_none() {
        experiences.push(experience(task, &object, diameter));
        object.mark();
    }
    if object.is_held(task) {
        let kept = |one: &mut Experience| one.outcome = Outcome::Success;
        experiences.iter_mut().for_each(kept);
    }
    Ok((experiences, object.into_film()))
}

/// What is seen and felt now. Whether the object is kept shows at the end of the babble.
fn experience(task: &GraspTask, object: &InHand, diameter: f64) -> Experience {
    let mut fovea = Box::new([0.0; FOVEA_NEURONS]);
    let gaze = object.see(task, &mut fovea);
    let posture = object.posture(task);
    let share = task.robot.normalised(posture);
    Experience {
        eye: gaze.map_or([f32::NAN; 2], |gaze| {
            task.eye.normalised(gaze).map(|x| x as f32)
        }),
        fovea,
        arm: [share[0], share[1]].map(|x| x.clamp(0.0, 1.0) as f32),
        hand: [posture[2], posture[3]].map(|flexion| (90.0 - flexion.to_degrees()) as f32),
        pregrasp: None,
        diameter,
        outcome: Outcome::Lost,
    }
}
