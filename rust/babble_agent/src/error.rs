use babble_brain::BrainError;
use babble_env::EnvError;

/// What can go wrong with an agent.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AgentError {
    /// A field of the agent's config is unknown or out of bounds.
    #[error("agent config: {field}: {problem}")]
    Config {
        /// Name of the field.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// The file is not an agent of this package.
    #[error("agent file: {problem}")]
    File {
        /// What is wrong with it.
        problem: String,
    },
    /// No legal movement was found.
    #[error(
        "only {legal} of {movements} babbled movements were legal; nothing can be learnt on this body"
    )]
    NothingLegal {
        /// Legal movements found.
        legal: u64,
        /// Movements babbled.
        movements: u64,
    },
    /// The hand kept hardly any object.
    #[error("the hand kept the object in only {kept} of {babbles} babbles; nothing can be learnt")]
    NothingHeld {
        /// Objects kept.
        kept: u64,
        /// Babbles made.
        babbles: u64,
    },
    /// The maps or their weights.
    #[error(transparent)]
    Brain(#[from] BrainError),
    /// The environment.
    #[error(transparent)]
    Env(#[from] EnvError),
}
