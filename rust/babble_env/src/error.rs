use babble_body::BodyError;
use babble_brain::BrainError;

/// What can go wrong with a task, an episode or a batch.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvError {
    /// The config has an unknown field, a wrong type or a value out of bounds.
    #[error("config: {field}: {problem}")]
    Config {
        /// Path of the field, as in `body.arm.upper_arm_m`.
        field: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The body of the config is not possible.
    #[error("config: in body: {0}")]
    Body(#[from] BodyError),
    /// An option is not one of its values.
    #[error("{option} = {value:?} is not one of {known}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: String,
        /// The values there are.
        known: String,
    },
    /// An option has another value than the environment's id stands for.
    #[error("{option} = {value:?}: {id} has {own:?} always; use {others}")]
    Fixed {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: String,
        /// The environment's id.
        id: &'static str,
        /// The value that it has.
        own: String,
        /// The environments that can have the value given.
        others: String,
    },
    /// A name is not one of those that there are.
    #[error("unknown {kind} {name:?}{hint}; there are {known}")]
    UnknownName {
        /// What it should name: an environment, an option, a protocol.
        kind: &'static str,
        /// The name given.
        name: String,
        /// The nearest known name, as a question.
        hint: String,
        /// The known names.
        known: String,
    },
    /// The value of an option is of the wrong kind.
    #[error("{option} = {value} is not {expected}")]
    OptionKind {
        /// Name of the option.
        option: &'static str,
        /// The value given, as JSON.
        value: String,
        /// What it must be.
        expected: String,
    },
    /// A part of a case has the wrong count of numbers.
    #[error("{part} = {value}: expected {expected}")]
    CaseValue {
        /// Name of the part.
        part: &'static str,
        /// The value given.
        value: String,
        /// What it must be.
        expected: String,
    },
    /// A number of an option is out of bounds.
    #[error("{option} = {value} is out of bounds: {bound}")]
    OutOfBounds {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: String,
        /// What it must be.
        bound: String,
    },
    /// An action is NaN or infinite. Nothing was stepped.
    #[error("action[{env}][{index}] = {value}: actions must be finite")]
    ActionNotFinite {
        /// Which environment of the batch.
        env: usize,
        /// Which number of its action.
        index: usize,
        /// The value given.
        value: f32,
    },
    /// Actions do not have the shape of the action space. Nothing was stepped.
    #[error("actions hold {got} numbers, expected {expected}")]
    ActionShape {
        /// Numbers given.
        got: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A step before a reset or after the end of the episode. Nothing was stepped.
    #[error("environment {env} needs a reset before it can step")]
    NeedsReset {
        /// Which environment of the batch.
        env: usize,
    },
    /// The case asked for cannot be played.
    #[error("{what}: {problem}")]
    Case {
        /// Which part of the case.
        what: &'static str,
        /// Why not.
        problem: String,
    },
    /// No case could be drawn: the config leaves no room for one.
    #[error(
        "no legal movement: of {drawn} random starts and targets the arm can stand at both ends of \
         {played}, and none of the {played} movements tried between them is legal; this config leaves \
         no room between arm, obstacle and joint ranges"
    )]
    NoLegalCase {
        /// Random starts and targets.
        drawn: u32,
        /// Movements between those that can be posed.
        played: u32,
    },
    /// No case of grasping could be drawn: the config leaves no room for one.
    #[error("no case in {tries} tries that can be played; in the last one, {problem}")]
    NoGraspCase {
        /// How many were tried.
        tries: u32,
        /// Why the last one cannot be played.
        problem: String,
    },
    /// The bytes are not a snapshot of this environment.
    #[error("snapshot: {problem}")]
    Snapshot {
        /// What is wrong with them.
        problem: String,
    },
    /// A parameter of the pattern generators is out of bounds.
    #[error(transparent)]
    Brain(#[from] BrainError),
    /// Whoever waited for it does so no more.
    #[error("interrupted")]
    Interrupted,
    /// Threads could not be started.
    #[error("cannot start {threads} threads: {problem}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        problem: String,
    },
}
