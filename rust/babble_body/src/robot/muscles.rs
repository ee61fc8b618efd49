//! What moves the joints.

use serde::{Deserialize, Serialize};

use super::Robot;

/// Angles of shoulder, elbow, thumb and virtual finger \[rad\]: of the arm's joints, and flexions of
/// the hand's.
pub type Posture = [f64; 4];

/// What moves a joint, or every joint of a digit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum MuscleCommand {
    /// Muscles with this equilibrium point \[rad\], Eq. 2.
    EquilibriumPoint(f64),
    /// This torque on top of the muscles' damping \[N·m\].
    Torque(f64),
}

/// What moves shoulder, elbow, thumb and virtual finger.
pub type MuscleCommands = [MuscleCommand; 4];

/// Muscles that pull towards a posture.
#[must_use]
pub fn towards(posture: Posture) -> MuscleCommands {
    posture.map(MuscleCommand::EquilibriumPoint)
}

/// What a joint feels beside its damping: `stiffness (rest − q) + torque`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spring {
    /// \[N·m/rad\]
    pub(super) stiffness: f64,
    /// \[rad\]
    pub(super) rest: f64,
    /// \[N·m\]
    pub(super) torque: f64,
}

impl Robot {
    /// What `drive` does to a joint at `q` \[rad\]. A torque ends at a stop behind the joint range,
    /// which is as stiff as the muscles.
    pub(super) fn spring(&self, drive: &MuscleCommands, joint: usize, q: f64) -> Spring {
        let muscle = self.links[joint].muscle;
        let kp = muscle.settings(&self.body).kp;
        let [low, high] = self.ranges[muscle.index()];
        match drive[muscle.index()] {
            MuscleCommand::EquilibriumPoint(point) => Spring {
                stiffness: kp,
                rest: point,
                torque: 0.0,
            },
            MuscleCommand::Torque(torque)
                if (q > high && torque > 0.0) || (q < low && torque < 0.0) =>
            {
                Spring {
                    stiffness: kp,
                    rest: q.clamp(low, high),
                    torque: 0.0,
                }
            }
            MuscleCommand::Torque(torque) => Spring {
                stiffness: 0.0,
                rest: q,
                torque,
            },
        }
    }
}
