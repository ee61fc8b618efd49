//! babble_env
