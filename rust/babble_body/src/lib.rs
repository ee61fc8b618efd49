//! babble_body
