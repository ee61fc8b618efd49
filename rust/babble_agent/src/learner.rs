//! A network and the babbling that it learns from.

use std::iter;

use babble_env::picture::Visible;
use babble_env::{Config, Executor, Outcome, Task};
use serde::{Deserialize, Serialize};

use crate::babbling::{Babble, Babbling};
use crate::error::AgentError;
use crate::network::{Activities, Network};
use crate::rule::RuleOfOnesOwn;
use crate::tensors::{self, whole_config};

/// Version of the files.
const VERSION: u32 = 4;
/// Babbles that are remembered until they are learnt from together.
const BABBLES: usize = 128;
/// Experiences that are encoded and learnt together.
const CHUNK: usize = 256;
/// Trials of a round: they are made with the same weights, and then learnt from.
pub const ROUND: usize = 50;
/// More babbles than anybody makes: at 1 ms each they take 30 years.
const MOST_BABBLES: u64 = 1_000_000_000_000;

/// More steps than anybody makes.
const MOST_STEPS: u64 = 1_000 * MOST_BABBLES;

type ExperienceOf<N> = <<N as Network>::Task as Babble>::Experience;

/// A network that learns by babbling.
#[derive(Debug)]
pub struct Learner<N: Network> {
    /// The network.
    pub network: N,
    /// The sequence of babbles that it learns from.
    pub babbling: Babbling<N::Task>,
    /// Body and task that it babbles with.
    config: Config,
    /// Whether percepts are paired with the action of the babble before.
    shuffled: bool,
    /// What it has tried.
    practice: Practice,
}

/// Trials that a network has learnt from by their reward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Practice {
    /// How many.
    pub trials: u64,
    /// Control steps that they took.
    pub steps: u64,
}

impl Practice {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

// Derived, it would ask for a task that can be copied.
impl<N: Network> Clone for Learner<N> {
    fn clone(&self) -> Self {
        Self {
            network: self.network.clone(),
            babbling: self.babbling,
            config: self.config.clone(),
            shuffled: self.shuffled,
            practice: self.practice,
        }
    }
}

/// A babble for people to look at.
#[derive(Debug, Clone, PartialEq)]
pub struct BabbleFilm {
    /// What there was to see at its beginning, and at the end of each control period.
    pub frames: Vec<Visible>,
    /// Moments in which the rule is applied if the babble can be learnt from.
    pub moments: Vec<FilmMoment>,
    /// Whether it can be learnt from.
    pub learnable: bool,
    /// How it ended.
    pub outcome: Outcome,
}

impl BabbleFilm {
    /// Adds a moment. There is none where the eye does not see the object, or the hand did not get so far: maps
    /// have no activity then.
    fn push(&mut self, moment: FilmMoment) {
        let finite = |all: &[f32]| all.iter().all(|x| x.is_finite());
        let known = |maps: &Activities| finite(&maps.g) && finite(&maps.a);
        if moment.activities.iter().all(known) {
            self.moments.push(moment);
        }
    }
}

/// Activities of all maps in a frame of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMoment {
    /// Number of the frame.
    pub frame: usize,
    /// What was seen and what was done, for each association.
    pub activities: Vec<Activities>,
}

/// What is known of a learner beside its weights.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Metadata<C, O> {
    /// Version of this format.
    version: u32,
    /// Numbers of maps and rule.
    brain: C,
    /// Body and task that it babbled with.
    #[serde(deserialize_with = "whole_config")]
    config: Config,
    /// Seed of its babbling.
    seed: u64,
    /// How babbles are simulated.
    babbling: O,
    /// Whether percepts are paired with the action of the babble before.
    #[serde(default, skip_serializing_if = "is_false")]
    shuffled: bool,
    /// Babbles made.
    babbled: u64,
    /// How many of them were learnt from.
    learnt: u64,
    /// What it has tried.
    #[serde(default, skip_serializing_if = "Practice::is_none")]
    practice: Practice,
}

impl<N: Network> Learner<N> {
    /// A learner that has not babbled yet, of `brain`, in the config of a task.
    ///
    /// # Errors
    /// [`AgentError`] naming the number of the brain that is out of bounds.
    pub fn new(
        brain: N::Config,
        task: &N::Task,
        seed: u64,
        options: <N::Task as Babble>::Options,
    ) -> Result<Self, AgentError> {
        let network = N::new(brain)?;
        let options = network.babbling(options);
        let babbling = Babbling::new(seed, options).every(network.learning_period_s())?;
        let config = task.config().clone();
        Ok(Self {
            network,
            babbling,
            config,
            shuffled: false,
            practice: Practice::default(),
        })
    }

    /// Pairs what is seen in a babble with what was done in the one before, of those that can be learnt
    /// from; of the first one nothing is learnt. Such a network learns the same percepts and actions as
    /// another, but not which belong together.
    pub fn shuffle(&mut self) {
        self.shuffled = true;
    }

    /// Whether pairs are shuffled.
    #[must_use]
    pub const fn shuffled(&self) -> bool {
        self.shuffled
    }

    /// What it has tried.
    #[must_use]
    pub const fn practice(&self) -> Practice {
        self.practice
    }

    /// Body and task that it babbles with.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// Goes on in the config of another task: it babbles and learns there from now on.
    pub fn move_to(&mut self, task: &N::Task) {
        self.config = task.config().clone();
    }

    /// Babbles until `n` more babbles can be learnt from, and learns from these.
    ///
    /// # Errors
    /// [`AgentError::OtherConfig`] for a task of another config than the learner's, or as
    /// [`Babbling::experience`] and [`Network::learn`]; the learner is then as it was.
    pub fn learn(
        &mut self,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        self.taught(task, n, executor, |network, experiences, executor| {
            for chunk in experiences.chunks(CHUNK) {
                executor.check()?;
                #[cfg(feature = "threads")]
                executor.run(|| network.learn(chunk))??;
                #[cfg(not(feature = "threads"))]
                network.learn(chunk)?;
            }
            Ok(())
        })
    }

    /// The same, by a rule of the user's own.
    ///
    /// # Errors
    /// As [`Self::learn`] and [`Network::learn_by`]; the learner is then as it was.
    pub fn learn_by(
        &mut self,
        rule: &mut RuleOfOnesOwn<'_>,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        self.taught(task, n, executor, |network, experiences, executor| {
            for chunk in experiences.chunks(CHUNK) {
                executor.check()?;
                network.learn_by(rule, chunk)?;
            }
            Ok(())
        })
    }

    /// Makes `n` more trials, and learns from their reward.
    ///
    /// # Errors
    /// [`AgentError::OtherConfig`] for a task of another config than the learner's,
    /// [`AgentError::Config`] for trials that are no whole rounds, or as [`Network::practise`]; the
    /// learner is then as it was.
    pub fn practise(
        &mut self,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        self.check_config(task)?;
        if !n.is_multiple_of(ROUND) {
            return Err(AgentError::Config {
                field: "trials",
                problem: format!("{n} is not a multiple of {ROUND}"),
            });
        }
        let mut learning = self.clone();
        for _ in 0..n / ROUND {
            let Practice { trials, steps } = &mut learning.practice;
            let seed = learning.babbling.seed();
            *steps += learning.network.practise(task, seed, *trials, executor)?;
            *trials += ROUND as u64;
        }
        *self = learning;
        Ok(())
    }

    /// The babble that comes after `ahead` others from here on, for people to look at. Nothing is learnt
    /// from it.
    ///
    /// # Errors
    /// [`AgentError::OtherConfig`] for a task of another config than the learner's, or an error of the
    /// task.
    pub fn film(&self, task: &N::Task, ahead: u64) -> Result<BabbleFilm, AgentError> {
        self.check_config(task)?;
        let (experiences, film) = self.babbling.film(task, ahead)?;
        let ends = experiences.last().map(N::Task::outcome);
        let mut made = BabbleFilm {
            frames: film.frames,
            moments: Vec::new(),
            learnable: experiences.iter().any(N::Task::is_learnable),
            outcome: ends.unwrap_or(Outcome::Running),
        };
        for (&frame, one) in film.marks.iter().zip(&experiences) {
            let activities = self.network.encode(std::slice::from_ref(one))?;
            made.push(FilmMoment { frame, activities });
        }
        Ok(made)
    }

    fn check_config(&self, task: &N::Task) -> Result<(), AgentError> {
        match task.config().difference(&self.config)? {
            None => Ok(()),
            Some([field, here, there]) => Err(AgentError::OtherConfig { field, here, there }),
        }
    }

    /// Babbles until `n` more babbles can be learnt from, and lets `teach` teach them, some at a time;
    /// all or nothing.
    fn taught(
        &mut self,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
        mut teach: impl FnMut(&mut N, &[ExperienceOf<N>], &mut Executor) -> Result<(), AgentError>,
    ) -> Result<(), AgentError> {
        self.check_config(task)?;
        let mut learning = self.clone();
        let mut left = n;
        let mut before = Vec::new();
        if self.shuffled {
            before = self.babbling.last(task)?;
        }
        while left > 0 {
            let some = left.min(BABBLES);
            let babbles = learning.babbling.by_babble(task, some, executor)?;
            let experiences = if self.shuffled {
                shuffled::<N::Task>(&mut before, babbles)
            } else {
                babbles.concat()
            };
            teach(&mut learning.network, &experiences, executor)?;
            left -= some;
        }
        *self = learning;
        Ok(())
    }

    /// The learner as the bytes of a safetensors file.
    ///
    /// # Errors
    /// [`AgentError::File`] if it cannot be written.
    pub fn save(&self) -> Result<Vec<u8>, AgentError> {
        let metadata = Metadata {
            version: VERSION,
            brain: self.network.config().clone(),
            config: self.config.clone(),
            seed: self.babbling.seed(),
            babbling: self.babbling.options(),
            shuffled: self.shuffled,
            babbled: self.babbling.babbled(),
            learnt: self.babbling.learnt(),
            practice: self.practice,
        };
        let associations = self.network.associations();
        let parts: Vec<_> = N::PREFIXES
            .iter()
            .zip(associations)
            .flat_map(|(prefix, association)| tensors::of(prefix, association))
            .collect();
        tensors::write(N::KEY, &metadata, &parts)
    }

    /// The learner in a file's bytes.
    ///
    /// # Errors
    /// [`AgentError::File`] for bytes that are cut short, altered, no such learner, of another version,
    /// or with a field that no learner has; [`AgentError`] for weights that do not fit the maps.
    pub fn load(bytes: &[u8]) -> Result<Self, AgentError> {
        let names: Vec<String> = N::PREFIXES
            .iter()
            .flat_map(|prefix| tensors::names(prefix))
            .collect();
        let (json, values) = tensors::read(N::KEY, bytes, &names)?;
        check_version(&json)?;
        let metadata: Metadata<N::Config, <N::Task as Babble>::Options> =
            serde_path_to_error::deserialize(tensors::fields(&json)?)
                .map_err(|e| tensors::file(&e))?;
        metadata.check_counts(<N::Task as Babble>::RAREST)?;
        metadata.config.validate()?;
        let mut network = N::new(metadata.brain)?;
        for (i, [weights, a_mean, g_mean]) in values.as_chunks::<3>().0.iter().enumerate() {
            network
                .set(i, &weights.1, &a_mean.1, &g_mean.1)
                .map_err(|error| AgentError::File {
                    problem: format!("{}{error}", N::PREFIXES[i]),
                })?;
        }
        let (babbled, learnt) = (metadata.babbled, metadata.learnt);
        let options = network.babbling(metadata.babbling);
        let babbling = Babbling::resume(metadata.seed, options, babbled, learnt)
            .every(network.learning_period_s())?;
        Ok(Self {
            network,
            babbling,
            config: metadata.config,
            shuffled: metadata.shuffled,
            practice: metadata.practice,
        })
    }
}

impl<C, O> Metadata<C, O> {
    /// Checks that babbling can have made and learnt so many babbles.
    fn check_counts(&self, rarest: u64) -> Result<(), AgentError> {
        let Self {
            babbled, learnt, ..
        } = *self;
        let problem = if babbled > MOST_BABBLES {
            format!("babbled = {babbled} is more than {MOST_BABBLES}")
        } else if learnt > babbled {
            format!("learnt = {learnt} is more than babbled = {babbled}")
        } else if self.practice.trials > MOST_BABBLES || self.practice.steps > MOST_STEPS {
            let Practice { trials, steps } = self.practice;
            format!("practice: {trials} trials of {steps} steps are more than possible")
        } else if babbled > rarest * (learnt + 1) {
            format!("babbled = {babbled} is more than possible with learnt = {learnt}")
        } else {
            return Ok(());
        };
        Err(AgentError::File { problem })
    }
}

/// What is seen in each babble with what was done in the one before, moment by moment; `before` is the
/// babble before the first one, and becomes the last.
fn shuffled<T: Babble>(
    before: &mut Vec<T::Experience>,
    babbles: Vec<Vec<T::Experience>>,
) -> Vec<T::Experience> {
    let mut all = Vec::new();
    for babble in babbles {
        if let Some(last) = before.last() {
            let others = before.iter().chain(iter::repeat(last));
            let pairs = babble.iter().zip(others);
            all.extend(pairs.map(|(one, other)| T::with_action_of(one, other)));
        }
        *before = babble;
    }
    all
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
const fn is_false(flag: &bool) -> bool {
    !*flag
}

/// Checks that a file is of the version that this code writes, before anything else of it is read.
fn check_version(json: &str) -> Result<(), AgentError> {
    #[derive(Deserialize)]
    struct Version {
        version: u32,
    }
    let Version { version } = serde_json::from_str(json).map_err(|e| tensors::file(&e))?;
    if version == VERSION {
        return Ok(());
    }
    Err(AgentError::File {
        problem: format!("version {version} is not {VERSION}"),
    })
}
