//! An agent of a session: what it knows, how it learns, how it acts.

use std::collections::BTreeSet;
use std::sync::Arc;

use babble_agent::erased::{self, AnyLearner};
use babble_agent::{AgentError, Plan, Policy, PolicyNetwork, Random, Rule, predict, reference};
use babble_brain::Association;
use babble_env::batch::Record;
use babble_env::{AnyTask, Executor};
use serde_json::Value;

use crate::command::MapName;
use crate::cost::{self, Cost};
use crate::expression::RuleExpression;
use crate::fault::Fault;
use crate::hash::{self, Hash};
use crate::making;
use crate::policies::Policies;
use crate::setup::{AgentSetup, Setup};
use crate::state::{AgentState, Outcomes};

/// Babbles that are learnt from before the cost is looked at again.
const SLICE: u64 = 128;

/// An agent.
#[derive(Debug, Clone)]
pub(crate) struct Agent {
    pub(crate) setup: AgentSetup,
    pub(crate) mind: Mind,
    /// How its episodes on the stage ended.
    pub(crate) recalls: Outcomes,
}

/// What an agent acts by.
#[derive(Debug, Clone)]
pub(crate) enum Mind {
    /// Maps that learn.
    Learner(LearnerMind),
    /// An agent that needs no learning, by name, and how many random choices it has made.
    Reference { name: &'static str, choices: u64 },
    /// Bends the elbow until the palm touches, and closes the hand.
    Approach,
    /// A network that was trained elsewhere.
    Policy(Arc<PolicyNetwork>),
}

/// A learner; those of snapshots are shared.
#[derive(Debug, Clone)]
pub(crate) struct LearnerMind {
    pub(crate) learner: Arc<dyn AnyLearner>,
    /// The rule that a user wrote, if it learns by one.
    pub(crate) rule: Option<RuleExpression>,
    pub(crate) lesions: BTreeSet<Lesion>,
    /// Hash of weights and counts.
    pub(crate) hash: u64,
}

/// A silenced neuron: which association, which map, which neuron.
pub(crate) type Lesion = (usize, MapName, usize);

impl Agent {
    /// An agent that has learnt nothing.
    pub(crate) fn new(
        agent: &AgentSetup,
        setup: &Setup,
        task: &Arc<dyn AnyTask>,
        place: usize,
        policies: &Policies,
    ) -> Result<Self, Fault> {
        let mind = match agent {
            AgentSetup::Hebb {
                variant,
                brain,
                rule,
            } => {
                let rule = rule.as_deref().map(RuleExpression::parse);
                let rule = rule.transpose().map_err(|fault| {
                    Fault::config(&format!("agents[{place}].rule"), fault.to_string())
                })?;
                let brain = making::brain(task_name(setup)?, variant, brain, rule.is_some())?;
                cost::check_weights(&brain)?;
                let learner = erased::learner(task, brain, setup.seed, Value::Null)?;
                Mind::Learner(LearnerMind::new(learner, rule))
            }
            AgentSetup::Random {} => Mind::reference("random"),
            AgentSetup::Scripted {} => Mind::reference("scripted"),
            AgentSetup::Oracle {} => Mind::reference("oracle"),
            AgentSetup::Approach {} => Mind::Approach,
            AgentSetup::Policy { name } => Mind::Policy(policies.get(name, setup)?),
        };
        let mut made = Self {
            setup: agent.clone(),
            mind,
            recalls: Outcomes::new(),
        };
        // Refuses a control in which it cannot act.
        made.with_policy(setup.seed, task, |_| Ok(()))?;
        Ok(made)
    }

    /// The learner, if it has one.
    pub(crate) fn learner(&self) -> Option<&LearnerMind> {
        match &self.mind {
            Mind::Learner(mind) => Some(mind),
            Mind::Reference { .. } | Mind::Approach | Mind::Policy(_) => None,
        }
    }

    /// Goes on in another body.
    pub(crate) fn move_to(&mut self, task: &Arc<dyn AnyTask>) -> Result<(), Fault> {
        if let Mind::Learner(mind) = &mut self.mind {
            let mut learner = mind.learner.copied();
            learner.move_to(task)?;
            mind.learner = learner.into();
        }
        Ok(())
    }

    /// Calls `act` with the policy of this agent.
    pub(crate) fn with_policy<R>(
        &mut self,
        seed: u64,
        task: &Arc<dyn AnyTask>,
        act: impl FnOnce(&dyn Policy) -> Result<R, AgentError>,
    ) -> Result<R, Fault> {
        match &mut self.mind {
            Mind::Learner(mind) => Ok(act(&*mind.learner.policy(task)?)?),
            Mind::Reference { name, choices } => {
                let random = Random::new(seed, *choices);
                let done = act(&*reference(name, task, &random)?)?;
                *choices = random.choices();
                Ok(done)
            }
            Mind::Approach => Ok(act(&*erased::approach(task)?)?),
            Mind::Policy(network) => Ok(act(&**network)?),
        }
    }

    /// The next action in an episode that shows `record`.
    pub(crate) fn act(
        &mut self,
        seed: u64,
        task: &Arc<dyn AnyTask>,
        record: &Record,
        plan: (&mut Vec<Plan>, bool),
        executor: &mut Executor,
    ) -> Result<Vec<f32>, Fault> {
        let (plans, starts) = plan;
        self.with_policy(seed, task, |policy| {
            let mut senses = record.senses.clone();
            if policy.senses_len() > senses.len() {
                // The goal comes after the senses.
                senses.extend(&record.desired);
            }
            predict(policy, &senses, &[starts], plans, executor)
        })
    }

    /// How it stands.
    pub(crate) fn state(&self, task_name: &str) -> AgentState {
        let mut state = AgentState {
            learns: false,
            babbled: 0,
            learnt: 0,
            babble_outcomes: Outcomes::new(),
            silenced: 0,
            recalls: self.recalls.clone(),
        };
        if let Some(mind) = self.learner() {
            let (babbled, learnt) = (mind.learner.babbled(), mind.learner.learnt());
            let [taught, not] = match task_name {
                "reach" => ["legal", "illegal"],
                _ => ["kept", "lost"],
            };
            state.learns = true;
            state.babbled = babbled;
            state.learnt = learnt;
            state.babble_outcomes.insert(taught.to_owned(), learnt);
            state
                .babble_outcomes
                .insert(not.to_owned(), babbled - learnt);
            state.silenced = mind.lesions.len();
        }
        state
    }

    /// Adds all that it knows to a hash.
    pub(crate) fn hash(&self, hash: &mut Hash) {
        match &self.mind {
            Mind::Learner(mind) => hash.add(&mind.hash.to_le_bytes()),
            Mind::Reference { choices, .. } => hash.add(&choices.to_le_bytes()),
            Mind::Approach | Mind::Policy(_) => {}
        }
        for (outcome, count) in &self.recalls {
            hash.add(outcome.as_bytes());
            hash.add(&count.to_le_bytes());
        }
    }
}

impl Mind {
    const fn reference(name: &'static str) -> Self {
        Self::Reference { name, choices: 0 }
    }
}

impl LearnerMind {
    pub(crate) fn new(learner: Box<dyn AnyLearner>, rule: Option<RuleExpression>) -> Self {
        Self {
            rule,
            hash: hash::of_learner(&*learner),
            learner: learner.into(),
            lesions: BTreeSet::new(),
        }
    }

    /// Bytes of its weights.
    pub(crate) fn bytes(&self) -> usize {
        let all = self.learner.associations().into_iter();
        all.map(|(_, one)| 4 * one.weights().len()).sum()
    }

    /// Babbles until `n` more babbles are learnt from; all or nothing.
    pub(crate) fn learn(
        &mut self,
        task: &Arc<dyn AnyTask>,
        n: u64,
        cost: &mut Cost,
        executor: &mut Executor,
    ) -> Result<(), Fault> {
        let brain = self.learner.brain()?;
        let weights = self.bytes() / 4;
        let steps = self.learner.babble_steps(task)? as u64;
        // At least so much, before any of it is done.
        let mut least = *cost;
        least.add_steps(&**task, n * steps);
        least.add_learning(n, weights, &brain);
        least.check()?;
        let mut learner = self.learner.copied();
        let mut left = n;
        while left > 0 {
            let some = left.min(SLICE);
            let before = learner.babbled();
            self.teach(&mut *learner, task, some as usize, executor)?;
            let babbles = learner.babbled() - before;
            cost.add_steps(&**task, babbles * steps);
            cost.add_learning(some, weights, &brain);
            cost.check()?;
            left -= some;
        }
        silence(&mut *learner, &self.lesions)?;
        self.hash = hash::of_learner(&*learner);
        self.learner = learner.into();
        Ok(())
    }

    /// Lets a learner learn from `n` more babbles, by its rule.
    fn teach(
        &self,
        learner: &mut dyn AnyLearner,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), Fault> {
        let Some(rule) = &self.rule else {
            return Ok(learner.learn(task, n, executor)?);
        };
        let Rule::Own(numbers) = serde_json::from_value(learner.brain()?["rule"].take())? else {
            return Err(Fault::config("rule", "this agent has a rule by name"));
        };
        let mut teach = |association: &mut Association, g: &[f32], a: &[f32]| {
            rule.learn(numbers, association, g, a)
        };
        Ok(learner.learn_by(&mut teach, task, n, executor)?)
    }

    /// The association of that number, if it has these neurons.
    pub(crate) fn checked(
        &self,
        association: usize,
        map: MapName,
        neurons: &[usize],
    ) -> Result<&Association, Fault> {
        let associations = self.learner.associations();
        let shown = self.shown();
        let Some(&(_, found)) = associations[..shown].get(association) else {
            let problem = format!("association = {association} is not below {shown}");
            return Err(Fault::config("association", problem));
        };
        let size = match map {
            MapName::Input => found.n_in(),
            MapName::Output => found.n_out(),
        };
        match neurons.iter().find(|&&neuron| neuron >= size) {
            None => Ok(found),
            Some(neuron) => {
                let problem = format!("neuron {neuron} is not below {size}");
                Err(Fault::config("neurons", problem))
            }
        }
    }

    /// How many associations have maps to show: those of the chain's routes have none.
    fn shown(&self) -> usize {
        let shapes = self.learner.input_shapes();
        shapes.iter().filter(|shape| shape.len() > 1).count()
    }

    /// Silences neurons.
    pub(crate) fn lesion(
        &mut self,
        association: usize,
        map: MapName,
        neurons: &[usize],
    ) -> Result<(), Fault> {
        self.checked(association, map, neurons)?;
        let new = neurons.iter().map(|&neuron| (association, map, neuron));
        self.lesions.extend(new);
        let mut learner = self.learner.copied();
        silence(&mut *learner, &self.lesions)?;
        self.hash = hash::of_learner(&*learner);
        self.learner = learner.into();
        Ok(())
    }
}

/// Takes the weights of silenced neurons away. A weight changes by the two neurons that it connects
/// alone, so all others are as if these had never been there.
fn silence(learner: &mut dyn AnyLearner, lesions: &BTreeSet<Lesion>) -> Result<(), Fault> {
    if lesions.is_empty() {
        return Ok(());
    }
    let mut parts = Vec::new();
    for (_, one) in learner.associations() {
        parts.push([one.weights(), one.a_mean(), one.g_mean()].map(<[f32]>::to_vec));
    }
    for &(association, map, neuron) in lesions {
        let [weights, a_mean, g_mean] = &mut parts[association];
        let (n_in, n_out) = (g_mean.len(), a_mean.len());
        match map {
            MapName::Input => (0..n_out).for_each(|j| weights[j * n_in + neuron] = 0.0),
            MapName::Output => weights[neuron * n_in..][..n_in].fill(0.0),
        }
    }
    Ok(learner.set(&parts)?)
}

/// Name of the task of a setup's environment.
pub(crate) fn task_name(setup: &Setup) -> Result<&'static str, Fault> {
    Ok(babble_env::registry::environment(&setup.env)?.0.name)
}
