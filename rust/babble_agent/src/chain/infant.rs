//! What moves and remembers in a babble, and the babble itself.

use babble_env::picture::Film;
use babble_env::tasks::grasp::{FOVEA_NEURONS, InHand};
use babble_env::{EnvError, GraspTask, Outcome, Stream};

use super::brain::{Sequence, Withdrawal};
use super::chunks::{
    Advance, Carry, Chunk, Close, Look, Open, Return, TurnAway, Withdraw, WithdrawFreely,
};
use crate::grasp::Experience;

/// Change of the arm's equilibrium point in a control step while it feels its way \[rad\]; 1.5°.
pub const ADVANCE_RAD: f64 = 1.5 * std::f64::consts::PI / 180.0;

/// An arm with an object, the muscles' commands, and what was felt and seen before.
#[derive(Debug)]
pub struct Infant<'a> {
    /// The task whose body it has.
    pub task: &'a GraspTask,
    /// Arm, hand, object and its support.
    pub world: InHand,
    /// Radius of the object \[m\].
    pub radius: f64,
    /// Equilibrium points of shoulder and elbow \[rad\].
    pub arm: [f64; 2],
    /// Equilibrium points of thumb and finger \[rad\].
    pub hand: [f64; 2],
    /// What was felt and seen.
    pub memory: Memory,
}

/// What chunks leave behind for later ones and for learning. Postures are shoulder and elbow \[rad\].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    /// Where the arm held the object.
    pub held: [f64; 2],
    /// Where it was after its withdrawal.
    pub withdrawn: [f64; 2],
    /// The equilibrium point that it withdrew to.
    pub withdrawn_to: [f64; 2],
    /// Pan and tilt on the object, over their ranges, and the edges in the fovea.
    pub seen: Option<([f32; 2], Box<[f32; FOVEA_NEURONS]>)>,
    /// Where the arm was before the grasp.
    pub pregrasp: Option<[f64; 2]>,
    /// Where the palm touched.
    pub contact: Option<[f64; 2]>,
    /// Flexions of thumb and finger around the object \[rad\].
    pub gripped: Option<[f64; 2]>,
}

impl<'a> Infant<'a> {
    /// An arm in a random posture with an object at the palm of its open hand.
    ///
    /// # Errors
    /// [`EnvError::NoGraspCase`] if the body has no such posture.
    pub fn draw(task: &'a GraspTask, stream: &mut Stream) -> Result<(Self, f64), EnvError> {
        let diameter = task.draw_diameter(stream);
        let world = InHand::draw(task, diameter, stream)?;
        let infant = Self {
            arm: world.start(),
            hand: [2, 3].map(|i| task.robot.ranges()[i][0]),
            task,
            world,
            radius: diameter / 2.0,
            memory: Memory::default(),
        };
        Ok((infant, diameter))
    }

    /// Angles of shoulder and elbow \[rad\].
    #[must_use]
    pub fn felt(&self) -> [f64; 2] {
        let [shoulder, elbow, ..] = self.world.posture(self.task);
        [shoulder, elbow]
    }

    /// Flexions of thumb and finger \[rad\].
    #[must_use]
    pub fn felt_hand(&self) -> [f64; 2] {
        let [.., thumb, finger] = self.world.posture(self.task);
        [thumb, finger]
    }

    /// Flexions of the open hand \[rad\].
    #[must_use]
    pub fn open_hand(&self) -> [f64; 2] {
        [2, 3].map(|i| self.task.robot.ranges()[i][0])
    }

    /// The muscles pull for some time \[s\]; the arm's equilibrium points stay in the joint ranges.
    pub fn pull(&mut self, seconds: f64) {
        let [shoulder, elbow] = self.arm;
        let [thumb, finger] = self.hand;
        let posture = self.task.robot.clamp([shoulder, elbow, thumb, finger]);
        self.arm = [posture[0], posture[1]];
        self.world.pull(self.task, posture, seconds);
    }

    /// The same, and whether the palm touched the object meanwhile.
    pub fn pull_until_touched(&mut self, seconds: f64) -> bool {
        let step = self.task.config.grasp.physics_step_s();
        let mut touched = false;
        for _ in 0..(seconds / step).round() as usize {
            self.pull(step);
            touched |= self.world.touch(self.task).palm > 0.0;
        }
        touched
    }

    /// Pulls as a withdrawal, and remembers where to and how far.
    pub fn withdraw(&mut self, seconds: f64) {
        self.pull(seconds);
        self.memory.withdrawn_to = self.arm;
        self.memory.withdrawn = self.felt();
    }

    /// Remembers what the eye sees of the object; nothing where all of it is hidden.
    pub fn look(&mut self) {
        let mut fovea = Box::new([0.0; FOVEA_NEURONS]);
        let gaze = self.world.see(self.task, &mut fovea);
        self.memory.seen = gaze.map(|gaze| {
            let eye = self.task.eye.normalised(gaze).map(|x| x as f32);
            (eye, fovea)
        });
    }
}

/// The chunks of a babble, one after the other.
#[must_use]
pub fn chain(sequence: &Sequence) -> Vec<Box<dyn Chunk>> {
    let mut chunks: Vec<Box<dyn Chunk>> = vec![Box::new(Close), Box::new(Carry)];
    if sequence.opening {
        chunks.push(Box::new(Open));
    }
    chunks.push(match sequence.withdrawal {
        Withdrawal::Elbow => Box::new(Withdraw),
        Withdrawal::Free => Box::new(WithdrawFreely),
    });
    chunks.push(Box::new(TurnAway));
    chunks.push(Box::new(Look));
    chunks.push(Box::new(Return {
        jitter_deg: sequence.jitter_deg,
    }));
    chunks.push(Box::new(Advance));
    chunks.push(Box::new(Close));
    chunks
}

/// Time that a babble takes at most, and is counted with \[s\].
#[must_use]
pub fn seconds(sequence: &Sequence) -> f64 {
    chain(sequence).iter().map(|chunk| chunk.seconds()).sum()
}

/// One babble: what was seen and felt. It is kept if the hand feels the object between its sides at the
/// end.
///
/// # Errors
/// An error of the task.
pub fn babble(
    task: &GraspTask,
    sequence: &Sequence,
    stream: &mut Stream,
) -> Result<Experience, EnvError> {
    Ok(made(task, sequence, stream, false)?.0)
}

/// The same, with its film if it is to be filmed.
pub(crate) fn made(
    task: &GraspTask,
    sequence: &Sequence,
    stream: &mut Stream,
    filmed: bool,
) -> Result<(Experience, Film), EnvError> {
    let (mut infant, diameter) = Infant::draw(task, stream)?;
    if filmed {
        infant.world.start_film(task);
    }
    let mut kept = true;
    for chunk in chain(sequence) {
        kept = chunk.run(&mut infant, stream)?;
        if !kept {
            break;
        }
    }
    infant.world.mark();
    Ok((
        experience(&infant, diameter, kept),
        infant.world.into_film(),
    ))
}

fn experience(infant: &Infant<'_>, diameter: f64, kept: bool) -> Experience {
    let memory = &infant.memory;
    let (eye, fovea) = memory
        .seen
        .clone()
        .unwrap_or_else(|| ([f32::NAN; 2], Box::new([0.0; FOVEA_NEURONS])));
    let share = |arm: Option<[f64; 2]>| {
        let [shoulder, elbow] = arm.unwrap_or([f64::NAN; 2]);
        let [shoulder, elbow, ..] = infant.task.robot.normalised([shoulder, elbow, 0.0, 0.0]);
        [shoulder, elbow].map(|x| x.clamp(0.0, 1.0) as f32)
    };
    let hand = memory.gripped.unwrap_or([f64::NAN; 2]);
    Experience {
        eye,
        fovea,
        arm: share(memory.contact),
        hand: hand.map(|flexion| (90.0 - flexion.to_degrees()) as f32),
        pregrasp: Some(share(memory.pregrasp)),
        diameter,
        outcome: if kept {
            Outcome::Success
        } else {
            Outcome::Lost
        },
    }
}
