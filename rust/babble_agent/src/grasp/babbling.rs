//! Babbling with the object in the hand: the enclosure reflex closes the hand, the arm moves.

use babble_env::tasks::grasp::{FOVEA_NEURONS, InHand};
use babble_env::{EnvError, GraspTask, Outcome, Stream};

use crate::babbling::{Babble, Column, ColumnKind};

/// Time that the reflex closes the hand before the arm moves, and time that it moves \[s\]; 2 and 2
/// \[C\], in which the arm makes 86 % of its way.
const CLOSING_S: f64 = 2.0;
const MOVING_S: f64 = 2.0;
/// Time that one babble takes \[s\].
const BABBLE_S: f64 = CLOSING_S + MOVING_S;

/// Equilibrium points of thumb and virtual finger as the paper counts them: opening angles,
/// EP = 90° − flexion \[deg\].
pub type HandPosture = [f32; 2];

/// What a babble with the object in the hand leaves behind.
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
    /// Diameter of the object \[m\].
    pub diameter: f64,
    /// Success if the hand kept the object, lost if not.
    pub outcome: Outcome,
}

impl Experience {
    /// Whether the hand kept the object, and the eye sees it.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.outcome == Outcome::Success && !self.eye[0].is_nan()
    }
}

impl Babble for GraspTask {
    type Options = ();
    type Experience = Experience;

    const TRIES: usize = 1;
    const RAREST: u64 = 500;

    /// From a random posture to another. It can be learnt from if the hand kept the object, in sight
    /// of the eye.
    fn babble(
        &self,
        (): (),
        stream: &mut Stream,
        all: bool,
    ) -> Result<Option<Experience>, EnvError> {
        let diameter = self.draw_diameter(stream);
        let mut object = InHand::draw(self, diameter, stream)?;
        let to = self.draw_free_posture(diameter / 2.0, stream)?;
        object.carry(self, object.start(), CLOSING_S);
        object.carry(self, to, MOVING_S);
        let outcome = if object.is_held(self) {
            Outcome::Success
        } else if all {
            Outcome::Lost
        } else {
            return Ok(None);
        };
        let mut fovea = Box::new([0.0; FOVEA_NEURONS]);
        let gaze = object.see(self, &mut fovea);
        let posture = object.posture(self);
        let share = self.robot.normalised(posture);
        let experience = Experience {
            eye: gaze.map_or([f32::NAN; 2], |gaze| {
                self.eye.normalised(gaze).map(|x| x as f32)
            }),
            fovea,
            arm: [share[0], share[1]].map(|x| x.clamp(0.0, 1.0) as f32),
            hand: [posture[2], posture[3]].map(|flexion| (90.0 - flexion.to_degrees()) as f32),
            diameter,
            outcome,
        };
        Ok((all || experience.is_kept()).then_some(experience))
    }

    fn babble_steps(&self) -> usize {
        (BABBLE_S / self.config.grasp.control_period_s).round() as usize
    }

    fn is_learnable(experience: &Experience) -> bool {
        experience.is_kept()
    }

    fn outcome(experience: &Experience) -> Outcome {
        experience.outcome
    }

    fn columns(all: &[Experience]) -> Vec<Column> {
        vec![
            Column::of("eye", ColumnKind::Percept, all, |e| e.eye),
            Column::of("fovea", ColumnKind::Percept, all, |e| *e.fovea),
            Column::of("arm", ColumnKind::Action, all, |e| e.arm),
            Column::of("hand", ColumnKind::Action, all, |e| e.hand),
            Column::of("diameter", ColumnKind::Case, all, |e| [e.diameter as f32]),
        ]
    }
}
