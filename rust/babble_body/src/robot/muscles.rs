//! The muscles that move the joints, Eq. 2.

use serde::{Deserialize, Serialize};

use super::kinematics::MAX_JOINTS;
use super::links::Link;
use crate::config::Body;

/// Angles of shoulder, elbow, thumb and virtual finger \[rad\]: of the arm's joints, and flexions of
/// the hand's.
pub type Posture = [f64; 4];

/// What the muscles of a joint do, or those of every joint of a digit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum MuscleCommand {
    /// They pull towards this equilibrium point \[rad\], Eq. 2.
    EquilibriumPoint(f64),
    /// They apply this torque, on top of their damping \[N·m\].
    Torque(f64),
}

/// Commands of shoulder, elbow, thumb and virtual finger.
pub type MuscleCommands = [MuscleCommand; 4];

/// Commands that pull towards a posture.
#[must_use]
pub fn towards(posture: Posture) -> MuscleCommands {
    posture.map(MuscleCommand::EquilibriumPoint)
}

/// Torque on a joint besides its damping: `stiffness (rest − q) + torque`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spring {
    /// \[N·m/rad\]
    pub(super) stiffness: f64,
    /// \[rad\]
    pub(super) rest: f64,
    /// \[N·m\]
    pub(super) torque: f64,
}

/// A joint's muscles.
#[derive(Debug, Clone, Copy)]
struct JointMuscles {
    /// Its place in a posture.
    group: usize,
    /// Stiffness \[N·m/rad\].
    kp: f64,
}

/// The muscles of all joints, as params.
#[derive(Debug, Clone)]
pub(super) struct MuscleModel {
    joints: Vec<JointMuscles>,
    /// Lowest and highest equilibrium point of each group \[rad\].
    pub(super) ranges: [[f64; 2]; 4],
}

impl MuscleModel {
    pub(super) fn new(body: &Body, links: &[Link]) -> Self {
        let joint = |link: &Link| JointMuscles {
            group: link.muscle.index(),
            kp: link.muscle.settings(body).kp,
        };
        Self {
            joints: links.iter().map(joint).collect(),
            ranges: ranges(body),
        }
    }

    /// What the commands do to each joint at its angle in `q` \[rad\]. Beyond the last joint the
    /// springs mean nothing.
    pub(super) fn springs(
        &self,
        commands: &MuscleCommands,
        q: &[f64; MAX_JOINTS],
    ) -> [Spring; MAX_JOINTS] {
        let last = self.joints.len() - 1;
        std::array::from_fn(|i| self.spring(commands, i.min(last), q[i]))
    }

    /// A torque ends at a stop behind the joint range, which is as stiff as the muscles.
    fn spring(&self, commands: &MuscleCommands, joint: usize, q: f64) -> Spring {
        let JointMuscles { group, kp } = self.joints[joint];
        let [low, high] = self.ranges[group];
        match commands[group] {
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

/// Lowest and highest equilibrium point of shoulder, elbow, thumb and finger \[rad\].
fn ranges(body: &Body) -> [[f64; 2]; 4] {
    let arm = |name: &str| {
        let joint = &body.joints[name];
        [joint.lower_deg, joint.upper_deg].map(f64::to_radians)
    };
    let hand = body.grip.flexion_deg.map(f64::to_radians);
    [arm("shoulder"), arm("elbow"), hand, hand]
}
