//! Where the impulses of contacts are kept.

/// Solids of arm and hand: two of the arm, the palm, and those of four fingers and a thumb.
pub(super) const SOLIDS: usize = 19;
/// Slot of the support.
pub(super) const SUPPORT: usize = SOLIDS;
/// Slot of the obstacle.
pub(super) const OBSTACLE: usize = SOLIDS + 1;
/// All that can touch the object: the solids of arm and hand in the order of the links, the support,
/// the obstacle.
pub(super) const SLOTS: usize = SOLIDS + 2;
