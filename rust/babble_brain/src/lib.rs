//! babble_brain
