//! The movements that a babble is made of. Each runs on what was felt and seen before it, and leaves more
//! behind; another list of them is another babble.
//!
//! Newborns close the hand on what touches the palm (the palmar grasp reflex: Futagi, Toribe & Suzuki
//! 2012) and open it when the arm extends (von Hofsten 1984). Infants of two to four months babble with
//! hand and arm, first without a target: fists, pre-precision grips, self-grasps (Wallace & Whishaw 2003).
//! Reaching and grasping develop from touch first, and sight takes them over later (Thomas, Karl &
//! Whishaw 2015; Karl & Whishaw 2013). Early reaches are corrected on contact (Berthier & Keen 2006), and
//! the grip is shaped by the touched object (Newell, Scully, `McDonald` & Baillargeon 1989).

use std::fmt;

use babble_env::{EnvError, Stream};

use super::infant::{ADVANCE_RAD, Infant};

/// A movement, or a look.
pub trait Chunk: fmt::Debug + Sync {
    /// Runs it. False if the babble ends here: nothing can be learnt from it.
    ///
    /// # Errors
    /// An error of the task.
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError>;

    /// Longest time that it takes \[s\].
    fn seconds(&self) -> f64;
}

/// The palmar grasp reflex closes the hand on the object; the arm stays where it is.
#[derive(Debug, Clone, Copy)]
pub struct Close;

impl Chunk for Close {
    fn run(&self, infant: &mut Infant<'_>, _: &mut Stream) -> Result<bool, EnvError> {
        infant.arm = infant.felt();
        infant.hand = infant.task.reflex();
        infant.pull(self.seconds());
        infant.memory.gripped = Some(infant.felt_hand());
        Ok(infant.world.touch(infant.task).encloses())
    }

    fn seconds(&self) -> f64 {
        2.25
    }
}

/// The arm moves to a random posture while the hand holds the object. A babble without a goal: where
/// objects lie later is found so.
#[derive(Debug, Clone, Copy)]
pub struct Carry;

impl Chunk for Carry {
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError> {
        infant.arm = infant.task.draw_free_posture(infant.radius, stream)?;
        infant.pull(self.seconds());
        infant.memory.held = infant.felt();
        Ok(infant.world.touch(infant.task).encloses())
    }

    fn seconds(&self) -> f64 {
        2.5
    }
}

/// The arm stays and the hand opens, as newborns' hands open before the arm extends. The object stays on
/// its support.
#[derive(Debug, Clone, Copy)]
pub struct Open;

impl Chunk for Open {
    fn run(&self, infant: &mut Infant<'_>, _: &mut Stream) -> Result<bool, EnvError> {
        infant.arm = infant.felt();
        infant.hand = infant.open_hand();
        infant.pull(self.seconds());
        infant.memory.held = infant.felt();
        Ok(true)
    }

    fn seconds(&self) -> f64 {
        2.0
    }
}

/// Withdrawal: the elbow extends by a random angle of 10 to 40°, which takes the palm off the object.
#[derive(Debug, Clone, Copy)]
pub struct Withdraw;

/// How far \[deg\].
pub const WITHDRAW_DEG: [f64; 2] = [10.0, 40.0];

impl Chunk for Withdraw {
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError> {
        let [low, high] = WITHDRAW_DEG;
        infant.arm[1] -= stream.uniform(low, high).to_radians();
        infant.withdraw(self.seconds());
        Ok(true)
    }

    fn seconds(&self) -> f64 {
        2.0
    }
}

/// Withdrawal in a random direction of both joints, by 10 to 40°: what an infant would do that knows
/// nothing of its elbow.
#[derive(Debug, Clone, Copy)]
pub struct WithdrawFreely;

impl Chunk for WithdrawFreely {
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError> {
        let [low, high] = WITHDRAW_DEG;
        let length = stream.uniform(low, high).to_radians();
        let direction = stream.uniform(0.0, std::f64::consts::TAU);
        infant.arm[0] += length * libm::cos(direction);
        infant.arm[1] += length * libm::sin(direction);
        infant.withdraw(self.seconds());
        Ok(true)
    }

    fn seconds(&self) -> f64 {
        2.0
    }
}

/// The shoulder turns away to the back of the hand, by a random angle of 30 to 70°: hand and object no
/// longer touch in the image.
#[derive(Debug, Clone, Copy)]
pub struct TurnAway;

impl Chunk for TurnAway {
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError> {
        infant.arm[0] -= stream.uniform(30.0, 70.0).to_radians();
        infant.pull(self.seconds());
        Ok(true)
    }

    fn seconds(&self) -> f64 {
        2.0
    }
}

/// The eye finds the object (Eq. 1), and what it sees is remembered.
#[derive(Debug, Clone, Copy)]
pub struct Look;

impl Chunk for Look {
    fn run(&self, infant: &mut Infant<'_>, _: &mut Stream) -> Result<bool, EnvError> {
        infant.look();
        Ok(infant.memory.seen.is_some())
    }

    fn seconds(&self) -> f64 {
        0.0
    }
}

/// The arm comes back to where it had withdrawn to, the shoulder off by a random angle of at most
/// `jitter_deg`: the posture before the grasp.
#[derive(Debug, Clone, Copy)]
pub struct Return {
    /// Most of the angle \[deg\].
    pub jitter_deg: f64,
}

impl Chunk for Return {
    fn run(&self, infant: &mut Infant<'_>, stream: &mut Stream) -> Result<bool, EnvError> {
        let jitter = stream.uniform(-self.jitter_deg, self.jitter_deg);
        infant.arm = infant.memory.withdrawn_to;
        infant.arm[0] += jitter.to_radians();
        infant.pull(self.seconds());
        infant.memory.pregrasp = Some(infant.felt());
        Ok(true)
    }

    fn seconds(&self) -> f64 {
        2.5
    }
}

/// The arm takes back its withdrawal, slowly and further, until the palm touches something: the posture
/// at contact.
#[derive(Debug, Clone, Copy)]
pub struct Advance;

/// Longest time of an advance \[s\].
pub const ADVANCE_S: f64 = 3.5;

impl Chunk for Advance {
    fn run(&self, infant: &mut Infant<'_>, _: &mut Stream) -> Result<bool, EnvError> {
        let back = [0, 1].map(|i| infant.memory.held[i] - infant.memory.withdrawn[i]);
        let most = back[0].abs().max(back[1].abs()).max(ADVANCE_RAD);
        let start = infant.arm;
        let period = infant.task.config.grasp.control_period_s;
        for step in 1..=(self.seconds() / period).round() as usize {
            let share = step as f64 * ADVANCE_RAD / most;
            infant.arm = [0, 1].map(|i| start[i] + share * back[i]);
            if infant.pull_until_touched(period) {
                infant.memory.contact = Some(infant.felt());
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn seconds(&self) -> f64 {
        ADVANCE_S
    }
}
