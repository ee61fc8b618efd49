//! babble_agent
