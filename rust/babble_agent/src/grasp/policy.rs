//! Agents that choose what posture to reach and to grasp with, and how they act in each control.

use std::fmt;
use std::sync::Arc;

use babble_env::tasks::grasp::{SENSES, at};
use babble_env::{Control, Executor, GraspTask, Task};

use crate::error::AgentError;
use crate::policy::{Decisions, Grasp, Plan, Policy, Random};

/// Where shoulder, elbow, thumb and finger stand in a flat observation.
pub(super) const POSTURE: [usize; 4] = [at::ARM, at::ARM + 1, at::HAND, at::HAND + 1];

/// What an agent sees at the beginning of an episode.
#[derive(Debug, Clone, Copy)]
pub struct Sight<'a> {
    /// The whole flat observation.
    pub senses: &'a [f32; SENSES],
    /// Pan and tilt on the object, over their ranges.
    pub eye: [f32; 2],
    /// Edges in the fovea.
    pub fovea: &'a [f32],
    /// Shoulder, elbow, thumb and finger, over their ranges.
    pub posture: [f32; 4],
}

/// How an agent chooses a grasp.
pub trait ChooseGrasp: fmt::Debug + Send + Sync {
    /// The grasp for what is seen.
    ///
    /// # Errors
    /// [`AgentError`] for percepts that are no activities.
    fn choose(&self, task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError>;
}

impl<'a> Sight<'a> {
    /// What a flat observation shows.
    fn of(senses: &'a [f32; SENSES]) -> Self {
        Self {
            senses,
            eye: [senses[at::EYE], senses[at::EYE + 1]],
            fovea: &senses[at::FOVEA..at::HAND],
            posture: POSTURE.map(|at| senses[at]),
        }
    }
}

/// Goes straight to where the palm meets the object, and closes as the reflex does.
///
/// It knows the arm's geometry and the eye's: where the eye looks the object is. The fovea's edges,
/// which tell the size, it does not read: it aims the palm's surface at the object's middle, and the
/// hand stops where it touches.
#[derive(Debug, Clone, Copy)]
pub struct Scripted;

impl ChooseGrasp for Scripted {
    fn choose(&self, task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        let gaze = task.eye.from_normalised(sight.eye.map(f64::from));
        let point = task.eye.target_in_plane(gaze, 0.0);
        let arm = point.and_then(|object| task.grasp_posture(object, 0.0));
        let ranges = task.robot.ranges();
        let middle = [0, 1].map(|i| f64::midpoint(ranges[i][0], ranges[i][1]));
        Ok(Grasp::straight(arm.unwrap_or(middle), task.reflex()))
    }
}

/// A random posture of the arm, uniform in its joint ranges, whatever is seen; the hand closes as the
/// reflex does.
impl ChooseGrasp for Random {
    fn choose(&self, task: &GraspTask, _sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        let mut stream = self.next();
        let share = [0, 1].map(|_| stream.uniform(0.0, 1.0));
        Ok(Grasp::straight(task.arm.denormalised(share), task.reflex()))
    }
}

impl ChooseGrasp for Decisions<'_> {
    fn choose(&self, _task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        let [shoulder, elbow, thumb, finger] = self.of(sight.senses, 1)?[0];
        Ok(Grasp::straight([shoulder, elbow], [thumb, finger]))
    }
}

impl<C: ChooseGrasp> ChooseGrasp for &C {
    fn choose(&self, task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        (*self).choose(task, sight)
    }
}

/// An agent that chooses once what posture to reach and to grasp with (Sect. IV).
///
/// The arm moves there at once, with the hand open; the hand closes when it touches the object.
#[derive(Debug)]
pub struct GraspPolicy<C> {
    task: Arc<GraspTask>,
    choice: C,
}

impl<C: ChooseGrasp> GraspPolicy<C> {
    /// An agent for a task.
    ///
    /// # Errors
    /// [`AgentError::Config`] for `torque` control, in which there are no postures to plan.
    pub fn new(task: Arc<GraspTask>, choice: C) -> Result<Self, AgentError> {
        if task.options.control == Control::Torque {
            return Err(AgentError::Config {
                field: "control",
                problem: "'torque': this agent plans postures; use posture or delta_posture"
                    .to_owned(),
            });
        }
        Ok(Self { task, choice })
    }

    /// The grasp for each flat observation of `senses`.
    fn choose(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Grasp>, AgentError> {
        // The senses that an option adds come last.
        let all: Vec<&[f32; SENSES]> = senses
            .chunks_exact(self.senses_len())
            .filter_map(|senses| senses.first_chunk())
            .collect();
        let choose = |senses: &[f32; SENSES]| self.choice.choose(&self.task, &Sight::of(senses));
        if let [one] = all[..] {
            return Ok(vec![choose(one)?]);
        }
        executor.map(0..all.len(), |i, _| choose(all[i]))
    }
}

/// The action of a posture \[rad\] that the equilibrium points are to take.
pub(crate) fn towards(task: &GraspTask, wanted: [f64; 4], senses: &[f32], action: &mut [f32]) {
    let unit = task.config.grasp.delta_posture_deg.to_radians();
    for (i, &[low, high]) in task.robot.ranges().iter().enumerate() {
        let asked = if task.options.control == Control::Posture {
            2.0 * (wanted[i] - low) / (high - low) - 1.0
        } else {
            // The equilibrium point is angle plus stretch.
            let angle = low + f64::from(senses[POSTURE[i]]) * (high - low);
            (wanted[i] - (angle + f64::from(senses[at::STRETCH + i]))) / unit
        };
        action[i] = asked.clamp(-1.0, 1.0) as f32;
    }
}

impl<C: ChooseGrasp> Policy for GraspPolicy<C> {
    fn senses_len(&self) -> usize {
        self.task.senses_len()
    }

    fn action_len(&self) -> usize {
        4
    }

    fn plan(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Plan>, AgentError> {
        let chosen = self.choose(senses, executor)?;
        Ok(chosen.into_iter().map(Plan::Grasp).collect())
    }

    fn decide(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Vec<f64>>, AgentError> {
        let chosen = self.choose(senses, executor)?;
        Ok(chosen.iter().map(|grasp| grasp.posture.to_vec()).collect())
    }

    fn act(&self, plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        let Plan::Grasp(grasp) = plan else {
            action.fill(0.0);
            return Ok(());
        };
        grasp.touched |= senses[at::TOUCH..SENSES].iter().any(|&force| force > 0.0);
        let mut wanted = grasp.posture;
        if !grasp.touched {
            let ranges = self.task.robot.ranges();
            wanted[2..].copy_from_slice(&[ranges[2][0], ranges[3][0]]);
            wanted[..2].copy_from_slice(&grasp.arm());
        }
        grasp.step += 1;
        towards(&self.task, wanted, senses, action);
        Ok(())
    }
}

/// An agent that draws each action uniformly from [−1, 1]⁴, whatever it sees.
#[derive(Debug)]
pub struct RandomActions<'a> {
    task: Arc<GraspTask>,
    random: &'a Random,
}

impl<'a> RandomActions<'a> {
    /// An agent for a task, which goes on with the choices of `random`.
    #[must_use]
    pub const fn new(task: Arc<GraspTask>, random: &'a Random) -> Self {
        Self { task, random }
    }
}

impl Policy for RandomActions<'_> {
    fn senses_len(&self) -> usize {
        self.task.senses_len()
    }

    fn action_len(&self) -> usize {
        4
    }

    fn act(&self, _plan: &mut Plan, _senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        let mut stream = self.random.next();
        action.fill_with(|| stream.uniform(-1.0, 1.0) as f32);
        Ok(())
    }
}
