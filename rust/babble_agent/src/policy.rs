//! How agents act: senses in, actions out, for any number of environments.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use babble_env::{Executor, Purpose, Stream};

use crate::chain::plan::ChainPlan;
use crate::error::AgentError;

/// What an agent has decided to do in an episode, and how far it has come.
#[derive(Debug, Clone, PartialEq)]
pub enum Plan {
    /// Nothing: each step is decided by itself.
    Steps,
    /// A whole movement, which one action plays: the action.
    Movement([f32; 2]),
    /// Equilibrium points of the arm, one a control step, as shares of the joint ranges.
    Trajectory {
        /// The equilibrium points.
        shares: Arc<[[f32; 2]]>,
        /// Steps made.
        step: usize,
    },
    /// A grasp.
    Grasp(Grasp),
    /// A chain that ends in a grasp.
    Chain(ChainPlan),
}

/// A grasp under way: the arm goes to a posture with the hand open, and the hand closes once it
/// touches the object.
#[derive(Debug, Clone, PartialEq)]
pub struct Grasp {
    /// Shoulder and elbow to head for on the way, one after the other \[rad\].
    pub via: Arc<[[f64; 2]]>,
    /// Control steps made.
    pub step: usize,
    /// Shoulder, elbow, and flexions of thumb and finger once the hand closes \[rad\].
    pub posture: [f64; 4],
    /// Whether the hand has touched the object.
    pub touched: bool,
}

/// Control steps for which the arm heads for a posture on its way.
const VIA_STEPS: usize = 40;

impl Grasp {
    /// A grasp with the arm and, once it closes, the hand in a posture \[rad\], straight.
    #[must_use]
    pub fn straight(arm: [f64; 2], hand: [f64; 2]) -> Self {
        Self {
            via: Arc::default(),
            step: 0,
            posture: [arm[0], arm[1], hand[0], hand[1]],
            touched: false,
        }
    }

    /// Shoulder and elbow to head for now \[rad\].
    #[must_use]
    pub fn arm(&self) -> [f64; 2] {
        let target = [self.posture[0], self.posture[1]];
        if self.touched {
            return target;
        }
        self.via
            .get(self.step / VIA_STEPS)
            .copied()
            .unwrap_or(target)
    }
}

/// An agent that can act. It learns nothing while it acts.
pub trait Policy: fmt::Debug + Send + Sync {
    /// Numbers in a flat observation.
    fn senses_len(&self) -> usize;

    /// Numbers in an action.
    fn action_len(&self) -> usize;

    /// What to do in episodes that begin with these flat observations, one after the other: unless given,
    /// to decide at each step.
    ///
    /// # Errors
    /// [`AgentError`] for senses that are not finite or point nowhere, or an error of the executor.
    fn plan(&self, senses: &[f32], _executor: &mut Executor) -> Result<Vec<Plan>, AgentError> {
        Ok(vec![Plan::Steps; senses.len() / self.senses_len()])
    }

    /// What is chosen for each of these flat observations: parameters (b1, b2) of a movement; shoulder,
    /// elbow, and flexions of thumb and finger of a grasp \[rad\].
    ///
    /// # Errors
    /// As [`plan`](Self::plan); [`AgentError::Config`] for an agent that chooses nothing beforehand, which
    /// all are unless this is given.
    fn decide(
        &self,
        _senses: &[f32],
        _executor: &mut Executor,
    ) -> Result<Vec<Vec<f64>>, AgentError> {
        Err(AgentError::Config {
            field: "agent",
            problem: "it decides each step by itself, and chooses nothing beforehand".to_owned(),
        })
    }

    /// The next action of an episode.
    ///
    /// # Errors
    /// As [`plan`](Self::plan), of an agent that looks again on its way.
    fn act(&self, plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError>;
}

/// Chooses at random: choice k depends on the seed and k alone.
#[derive(Debug)]
pub struct Random {
    seed: u64,
    choices: AtomicU64,
}

impl Random {
    /// The choices of a seed, from the `choices`-th on.
    #[must_use]
    pub const fn new(seed: u64, choices: u64) -> Self {
        Self {
            seed,
            choices: AtomicU64::new(choices),
        }
    }

    /// How many choices were made.
    #[must_use]
    pub fn choices(&self) -> u64 {
        self.choices.load(Ordering::Relaxed)
    }

    /// The stream of random numbers of the next choice.
    pub(crate) fn next(&self) -> Stream {
        let index = self.choices.fetch_add(1, Ordering::Relaxed);
        Stream::new(Purpose::Policy, self.seed, index)
    }
}

/// A function that decides for flat observations, one after the other: the numbers of each decision.
pub type Decide<'a> = dyn Fn(&[f32]) -> Result<Vec<f64>, AgentError> + Send + Sync + 'a;

/// Decisions that somebody else makes.
#[derive(Clone, Copy)]
pub struct Decisions<'a>(pub &'a Decide<'a>);

impl fmt::Debug for Decisions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Decisions")
    }
}

impl Decisions<'_> {
    /// The decisions of N numbers for `n` flat observations.
    pub(crate) fn of<const N: usize>(
        &self,
        senses: &[f32],
        n: usize,
    ) -> Result<Vec<[f64; N]>, AgentError> {
        let decided = (self.0)(senses)?;
        let problem = if decided.len() != n * N {
            format!("{} numbers for {n} decisions of {N}", decided.len())
        } else if let Some(x) = decided.iter().find(|x| !x.is_finite()) {
            format!("it has decided {x}")
        } else {
            return Ok(decided.as_chunks::<N>().0.to_vec());
        };
        Err(AgentError::Config {
            field: "decide",
            problem,
        })
    }
}

/// A flat observation, which has N numbers.
pub(crate) fn observation<const N: usize>(senses: &[f32]) -> Result<&[f32; N], AgentError> {
    senses.try_into().map_err(|_| AgentError::Config {
        field: "senses",
        problem: format!("{} numbers, expected {N}", senses.len()),
    })
}

/// Actions (n · [`Policy::action_len`]) for the flat observations of n environments
/// (n · [`Policy::senses_len`]).
///
/// `plans` is what the last call left, empty at first; `starts` says which environments have begun a
/// new episode since. Plans for another number of environments are made anew.
///
/// # Errors
/// [`AgentError::Config`] for senses of a wrong length or that are not finite, or as
/// [`Policy::plan`].
pub fn predict(
    policy: &dyn Policy,
    senses: &[f32],
    starts: &[bool],
    plans: &mut Vec<Plan>,
    executor: &mut Executor,
) -> Result<Vec<f32>, AgentError> {
    let (width, action_len) = (policy.senses_len(), policy.action_len());
    check_senses(senses, width)?;
    let n = senses.len() / width;
    let anew = plans.len() != n;
    let begins = |i: usize, plans: &[Plan]| {
        // A movement that is one action is over.
        anew || starts.get(i) == Some(&true) || matches!(plans[i], Plan::Movement(_))
    };
    let beginning: Vec<usize> = (0..n).filter(|&i| begins(i, plans)).collect();
    if !beginning.is_empty() {
        let first: Vec<f32> = beginning
            .iter()
            .flat_map(|&i| senses[i * width..][..width].iter().copied())
            .collect();
        let made = policy.plan(&first, executor)?;
        plans.resize(n, Plan::Steps);
        for (&i, plan) in beginning.iter().zip(made) {
            plans[i] = plan;
        }
    }
    let mut actions = vec![0.0; n * action_len];
    let each = senses.chunks_exact(width).zip(plans.iter_mut());
    for ((senses, plan), action) in each.zip(actions.chunks_exact_mut(action_len)) {
        policy.act(plan, senses, action)?;
    }
    Ok(actions)
}

fn check_senses(senses: &[f32], width: usize) -> Result<(), AgentError> {
    if !senses.len().is_multiple_of(width) {
        return Err(AgentError::Config {
            field: "senses",
            problem: format!("{} numbers are not rows of {width}", senses.len()),
        });
    }
    match senses.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(AgentError::Config {
            field: "senses",
            problem: format!("number {} is {}", at % width, senses[at]),
        }),
    }
}
