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
    /// Hardly any babble can be learnt from.
    #[error(
        "only {learnt} of {babbled} babbles can be learnt from (legal movements, or objects kept in \
         the hand); nothing can be learnt on this body"
    )]
    NothingToLearn {
        /// Babbles that can be learnt from.
        learnt: u64,
        /// Babbles made.
        babbled: u64,
    },
    /// An agent is to go on learning on another config than it has babbled on.
    #[error(
        "config: {field} = {here} is not the agent's {there}: it goes on learning only on the config \
         that it was made with"
    )]
    OtherConfig {
        /// Path of the field.
        field: String,
        /// Its value now.
        here: String,
        /// Its value in the agent's config.
        there: String,
    },
    /// A rule of the user's own failed.
    #[error("rule: {problem}")]
    Rule {
        /// What is wrong with it.
        problem: String,
    },
    /// The maps or their weights.
    #[error(transparent)]
    Brain(#[from] BrainError),
    /// The environment.
    #[error(transparent)]
    Env(#[from] EnvError),
}
