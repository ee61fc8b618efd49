//! A network and the babbling that it learns from.

use babble_env::{Config, Executor};
use serde::{Deserialize, Serialize};

use crate::babbling::{Babble, Babbling};
use crate::error::AgentError;
use crate::network::Network;
use crate::rule::RuleOfOnesOwn;
use crate::tensors;

/// Version of the files.
const VERSION: u32 = 2;
/// Experiences that are encoded and learnt together.
const CHUNK: usize = 256;

/// A network that learns by babbling.
#[derive(Debug)]
pub struct Learner<N: Network> {
    /// The network.
    pub network: N,
    /// The sequence of babbles that it learns from.
    pub babbling: Babbling<N::Task>,
}

// Derived, it would ask for a task that can be copied.
impl<N: Network> Clone for Learner<N> {
    fn clone(&self) -> Self {
        Self {
            network: self.network.clone(),
            babbling: self.babbling,
        }
    }
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
    config: Config,
    /// Seed of its babbling.
    seed: u64,
    /// How babbles are simulated.
    babbling: O,
    /// Babbles made.
    babbled: u64,
    /// How many of them were learnt from.
    learnt: u64,
}

impl<N: Network> Learner<N> {
    /// A learner that has not babbled yet.
    ///
    /// # Errors
    /// [`AgentError`] naming the number of the config that is out of bounds.
    pub fn new(
        config: N::Config,
        seed: u64,
        options: <N::Task as Babble>::Options,
    ) -> Result<Self, AgentError> {
        Ok(Self {
            network: N::new(config)?,
            babbling: Babbling::new(seed, options),
        })
    }

    /// Babbles until `n` more babbles can be learnt from, and learns from these.
    ///
    /// # Errors
    /// As [`Babbling::experience`] and [`Network::learn`]; the learner is then as it was.
    pub fn learn(
        &mut self,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        let mut babbling = self.babbling;
        let experiences = babbling.experience(task, n, executor)?;
        let network = &mut self.network;
        let taught = || {
            let mut chunks = experiences.chunks(CHUNK);
            chunks.try_for_each(|chunk| network.learn(chunk))
        };
        #[cfg(feature = "threads")]
        executor.run(taught)??;
        #[cfg(not(feature = "threads"))]
        {
            let mut taught = taught;
            taught()?;
        }
        self.babbling = babbling;
        Ok(())
    }

    /// The same, by a rule of the user's own.
    ///
    /// # Errors
    /// As [`Babbling::experience`] and [`Network::learn_by`]; the learner is then as it was.
    pub fn learn_by(
        &mut self,
        rule: &mut RuleOfOnesOwn<'_>,
        task: &N::Task,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        let mut learning = self.clone();
        let experiences = learning.babbling.experience(task, n, executor)?;
        for chunk in experiences.chunks(CHUNK) {
            learning.network.learn_by(rule, chunk)?;
        }
        *self = learning;
        Ok(())
    }

    /// The learner as the bytes of a safetensors file; `config` is that of its task.
    ///
    /// # Errors
    /// [`AgentError::File`] if it cannot be written.
    pub fn save(&self, config: Config) -> Result<Vec<u8>, AgentError> {
        let metadata = Metadata {
            version: VERSION,
            brain: self.network.config().clone(),
            config,
            seed: self.babbling.seed(),
            babbling: self.babbling.options(),
            babbled: self.babbling.babbled(),
            learnt: self.babbling.learnt(),
        };
        let associations = self.network.associations();
        let parts: Vec<_> = N::PREFIXES
            .iter()
            .zip(associations)
            .flat_map(|(prefix, association)| tensors::of(prefix, association))
            .collect();
        tensors::write(N::KEY, &metadata, &parts)
    }

    /// The learner in a file's bytes, and the config of its task.
    ///
    /// # Errors
    /// [`AgentError::File`] for bytes that are cut short, altered, no such learner, or of another
    /// version; [`AgentError`] for weights that do not fit the maps.
    pub fn load(bytes: &[u8]) -> Result<(Self, Config), AgentError> {
        let names: Vec<String> = N::PREFIXES
            .iter()
            .flat_map(|prefix| tensors::names(prefix))
            .collect();
        let (json, values) = tensors::read(N::KEY, bytes, &names)?;
        check_version(&json)?;
        let metadata: Metadata<N::Config, <N::Task as Babble>::Options> =
            serde_json::from_str(&json).map_err(|e| tensors::file(&e))?;
        metadata.config.validate()?;
        let mut network = N::new(metadata.brain)?;
        for (i, [weights, a_mean, g_mean]) in values.as_chunks::<3>().0.iter().enumerate() {
            network
                .set(i, weights, a_mean, g_mean)
                .map_err(|error| AgentError::File {
                    problem: format!("{}{error}", N::PREFIXES[i]),
                })?;
        }
        let (babbled, learnt) = (metadata.babbled, metadata.learnt);
        let babbling = Babbling::resume(metadata.seed, metadata.babbling, babbled, learnt);
        Ok((Self { network, babbling }, metadata.config))
    }
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
