//! How episodes end, in all tasks.

use crate::named_enum::named_enum;

named_enum!(
    /// How an episode stands or ended. Each task lists those that it knows in its spec.
    Outcome, "outcome",
    /// Not ended.
    Running = "running",
    /// The task is done.
    Success = "success",
    /// The arm touched the obstacle.
    Collision = "collision",
    /// The posture asked for left the joint ranges.
    JointLimit = "joint_limit",
    /// The time was up.
    Timeout = "timeout",
    // Snapshots hold the place in this list: new ones are added at its end.
    /// The object is out of reach or was dropped.
    Lost = "lost"
);

impl Outcome {
    /// Whether the task can no longer be done in this episode.
    #[must_use]
    pub const fn is_failure(self) -> bool {
        matches!(self, Self::Collision | Self::JointLimit | Self::Lost)
    }
}
