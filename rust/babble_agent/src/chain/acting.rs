//! How an agent acts on the chain: the arm goes before the object, straight or around it, advances until
//! the palm touches, and the hand closes.

use std::sync::Arc;

use babble_env::tasks::grasp::{SENSES, at};
use babble_env::{Control, Executor, GraspTask};

use super::chunks::ADVANCE_S;
use super::infant::ADVANCE_RAD;
use super::plan::{Carrying, ChainPlan, Phase, Targets};
use super::route::{Detour, RouteChoice, Routes, State};
use super::targets::ChooseTargets;
use crate::error::AgentError;
use crate::grasp::policy::towards;
use crate::policy::{Plan, Policy, observation};

/// Control steps that each part of a detour takes at most.
const DETOUR_STEPS: u32 = 45;
/// A part of a detour is over when the joint is so near \[rad\].
const NEAR_DETOUR: f64 = 8.0 * DEG;
/// Control steps that the arm takes at most to the posture before the grasp.
const REACH_STEPS: u32 = 60;
/// It is there when both joints are so near \[rad\].
const NEAR: f64 = 2.0 * DEG;
/// Control steps that the hand takes at most to open.
const OPEN_STEPS: u32 = 40;
/// It is open below these flexions \[rad\].
const OPEN: f64 = 12.0 * DEG;
/// Control steps that the hand has to close before it gives up.
const CLOSE_STEPS: u32 = 70;
/// It gives up after it has not felt the object for so many control steps.
pub(super) const LOOSE_STEPS: u32 = 10;

const DEG: f64 = std::f64::consts::PI / 180.0;

/// What is felt in a control step.
pub(super) struct Felt {
    pub arm: [f64; 2],
    pub hand: [f64; 2],
    pub palm: bool,
    pub grips: bool,
}

/// An agent that acts on what a network recalls, or on targets from elsewhere.
#[derive(Debug)]
pub struct ChainPolicy<C> {
    task: Arc<GraspTask>,
    choice: C,
}

impl<C: ChooseTargets> ChainPolicy<C> {
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

    /// A plan for a flat observation, by a route that `choose` finds for its state.
    ///
    /// # Errors
    /// [`AgentError`] for senses of another length, or as [`ChooseTargets::targets`].
    pub fn begin(
        &self,
        senses: &[f32],
        choose: impl FnOnce(&State) -> RouteChoice,
    ) -> Result<ChainPlan, AgentError> {
        let carrying = self.choice.at_goal(&self.task, senses)?;
        let targets = self.targets(senses)?;
        let felt = self.felt(senses);
        let choice = choose(&self.state(&felt, &targets));
        let detour = choice.number > 0;
        Ok(ChainPlan {
            phase: if detour { Phase::Fold } else { Phase::Reach },
            step: 0,
            choice,
            targets,
            carrying: carrying.map(|posture| Carrying {
                posture,
                gripped: 0,
            }),
            from: felt.arm,
            fist: detour,
            loose: 0,
        })
    }

    fn state(&self, felt: &Felt, targets: &Targets) -> State {
        let [[s0, s1], [e0, e1], ..] = *self.task.robot.ranges();
        let share = |x: f64, [low, high]: [f64; 2]| (x - low) / (high - low);
        let [shoulder, elbow] = targets.pregrasp;
        State {
            turn: (shoulder - felt.arm[0]) / (s1 - s0),
            elbow: share(felt.arm[1], [e0, e1]),
            pregrasp: [share(shoulder, [s0, s1]), share(elbow, [e0, e1])],
            grip: targets.grip,
        }
    }

    fn targets(&self, senses: &[f32]) -> Result<Targets, AgentError> {
        // The senses that an option adds come last.
        let senses = observation(&senses[..senses.len().min(SENSES)])?;
        self.choice.targets(&self.task, senses)
    }

    fn felt(&self, senses: &[f32]) -> Felt {
        let ranges = self.task.robot.ranges();
        let angle = |joint: usize, at: usize| {
            let [low, high] = ranges[joint];
            low + f64::from(senses[at]) * (high - low)
        };
        let touch = [0, 1, 2].map(|i| senses[at::TOUCH + i] > 0.0);
        Felt {
            arm: [angle(0, at::ARM), angle(1, at::ARM + 1)],
            hand: [angle(2, at::HAND), angle(3, at::HAND + 1)],
            palm: touch[0],
            grips: touch[2] && (touch[0] || touch[1]),
        }
    }

    /// Moves a plan on by what is felt, and the posture that the muscles are to pull to \[rad\].
    fn wanted(
        &self,
        plan: &mut ChainPlan,
        felt: &Felt,
        senses: &[f32],
    ) -> Result<[f64; 4], AgentError> {
        self.proceed(plan, felt, senses)?;
        plan.step += 1;
        let arm = self.arm_target(plan);
        let ranges = self.task.robot.ranges();
        let hand = match plan.phase {
            Phase::Close | Phase::Carry => plan.targets.hand,
            Phase::Fold | Phase::Turn | Phase::Extend | Phase::Reach if plan.fist => {
                [ranges[2][1], ranges[3][1]]
            }
            _ => [ranges[2][0], ranges[3][0]],
        };
        Ok([arm[0], arm[1], hand[0], hand[1]])
    }

    /// Shoulder and elbow to head for in this control step.
    fn arm_target(&self, plan: &ChainPlan) -> [f64; 2] {
        let targets = &plan.targets;
        let [turn, fold, extend] = self.detour(plan);
        match plan.phase {
            Phase::Fold => [plan.from[0], fold],
            Phase::Turn => [turn, fold],
            Phase::Extend => [turn, extend],
            Phase::Reach | Phase::Open => targets.pregrasp,
            Phase::Advance => {
                let share = self.share(plan);
                [0, 1].map(|i| {
                    targets.pregrasp[i] + share * (targets.contact[i] - targets.pregrasp[i])
                })
            }
            Phase::Close => plan.from,
            Phase::Carry => plan.carrying.as_ref().map_or(plan.from, |c| c.posture),
        }
    }

    /// How far the arm has advanced, as a share of the way from the posture before the grasp to contact.
    fn share(&self, plan: &ChainPlan) -> f64 {
        let share = f64::from(plan.step) * Self::advance_step(plan);
        if self.choice.advance() {
            share
        } else {
            share.min(1.0)
        }
    }

    fn advance_step(plan: &ChainPlan) -> f64 {
        let Targets {
            pregrasp, contact, ..
        } = plan.targets;
        let most = (0..2).map(|i| (contact[i] - pregrasp[i]).abs());
        ADVANCE_RAD / most.fold(ADVANCE_RAD, f64::max)
    }

    /// Shoulder after the turn, and elbow before and after it \[rad\].
    fn detour(&self, plan: &ChainPlan) -> [f64; 3] {
        let Some(Detour {
            fold,
            turn_deg,
            extend,
        }) = Routes::detour(plan.choice.number)
        else {
            return [0.0; 3];
        };
        let [[s0, s1], [e0, e1], ..] = *self.task.robot.ranges();
        let shoulder = plan.targets.pregrasp[0] - turn_deg.to_radians();
        let elbow = |share: f64| e0 + share * (e1 - e0);
        [shoulder.clamp(s0, s1), elbow(fold), elbow(extend)]
    }

    /// Goes over to the next link once this one is done.
    fn proceed(&self, plan: &mut ChainPlan, felt: &Felt, senses: &[f32]) -> Result<(), AgentError> {
        let reflex = self.choice.reflex();
        let [turn, fold, extend] = self.detour(plan);
        let near = |joint: usize, target: f64| (felt.arm[joint] - target).abs() < NEAR_DETOUR;
        match plan.phase {
            Phase::Fold if plan.is_over(near(1, fold), DETOUR_STEPS) => {
                plan.enter(Phase::Turn, felt.arm);
            }
            Phase::Turn if plan.is_over(near(0, turn), DETOUR_STEPS) => {
                plan.enter(Phase::Extend, felt.arm);
            }
            Phase::Extend if plan.is_over(near(1, extend), DETOUR_STEPS) => {
                self.look(plan, senses)?;
                plan.enter(Phase::Reach, felt.arm);
            }
            Phase::Reach if reflex && felt.palm && !plan.fist => {
                plan.enter(Phase::Close, felt.arm);
            }
            Phase::Reach if plan.is_over(Self::is_there(plan, felt), REACH_STEPS) => {
                let next = if plan.fist {
                    Phase::Open
                } else {
                    Phase::Advance
                };
                plan.enter(next, felt.arm);
            }
            Phase::Open if plan.is_over(felt.hand.iter().all(|&x| x < OPEN), OPEN_STEPS) => {
                plan.fist = false;
                plan.enter(Phase::Advance, felt.arm);
            }
            Phase::Advance if reflex && felt.palm => plan.enter(Phase::Close, felt.arm),
            Phase::Advance => self.end_advance(plan, felt, senses)?,
            Phase::Close => {
                plan.loose = if felt.grips { 0 } else { plan.loose + 1 };
                Self::lift(plan, felt);
                if plan.step >= CLOSE_STEPS && plan.loose > LOOSE_STEPS {
                    self.look(plan, senses)?;
                    plan.enter(Phase::Reach, felt.arm);
                }
            }
            Phase::Carry => self.keep(plan, felt, senses)?,
            _ => {}
        }
        Ok(())
    }

    /// What an advance without a touch ends in: another try, or a hand that closes on what may be there.
    fn end_advance(
        &self,
        plan: &mut ChainPlan,
        felt: &Felt,
        senses: &[f32],
    ) -> Result<(), AgentError> {
        let seconds = f64::from(plan.step) * self.task.config.grasp.control_period_s;
        if seconds < ADVANCE_S {
            return Ok(());
        }
        if self.choice.reflex() && self.choice.advance() {
            self.look(plan, senses)?;
            plan.enter(Phase::Reach, felt.arm);
        } else {
            plan.enter(Phase::Close, felt.arm);
        }
        Ok(())
    }

    fn is_there(plan: &ChainPlan, felt: &Felt) -> bool {
        (0..2).all(|i| (felt.arm[i] - plan.targets.pregrasp[i]).abs() < NEAR)
    }

    /// Looks again; what is seen now recalls the postures from now on.
    ///
    /// # Errors
    /// As [`ChooseTargets::targets`].
    pub(super) fn look(&self, plan: &mut ChainPlan, senses: &[f32]) -> Result<(), AgentError> {
        plan.targets = self.targets(senses)?;
        Ok(())
    }
}

impl<C: ChooseTargets> Policy for ChainPolicy<C> {
    fn senses_len(&self) -> usize {
        self.choice.senses_len(&self.task)
    }

    fn action_len(&self) -> usize {
        4
    }

    fn plan(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Plan>, AgentError> {
        let all: Vec<&[f32]> = senses.chunks_exact(self.senses_len()).collect();
        let plan = |senses: &[f32]| {
            let plan = self.begin(senses, |state| self.choice.route(state))?;
            Ok(Plan::Chain(plan))
        };
        if let [one] = all[..] {
            return Ok(vec![plan(one)?]);
        }
        executor.map(0..all.len(), |i, _| plan(all[i]))
    }

    fn decide(&self, senses: &[f32], _: &mut Executor) -> Result<Vec<Vec<f64>>, AgentError> {
        let all = senses.chunks_exact(self.senses_len());
        let flat = |targets: Targets| [targets.pregrasp, targets.contact, targets.hand].concat();
        all.map(|senses| self.targets(senses).map(flat)).collect()
    }

    fn act(&self, plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        let Plan::Chain(plan) = plan else {
            action.fill(0.0);
            return Ok(());
        };
        let felt = self.felt(senses);
        let wanted = self.wanted(plan, &felt, senses)?;
        towards(&self.task, wanted, senses, action);
        Ok(())
    }
}
