//! Portable streams of random numbers.

use std::f64::consts::TAU;
use std::str::FromStr;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::error::EnvError;

/// What a stream is drawn for. Streams of different purpose never coincide, so that learning,
/// validation and test cases of the same seed are disjoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Cases of an environment's episodes.
    Environment = 1,
    /// Babbled movements.
    Learning = 2,
    /// Cases on which settings are chosen.
    Validation = 3,
    /// Cases on which results are reported.
    Test = 4,
    /// Random choices of an agent.
    Policy = 5,
    /// Errors of the muscles in a control step.
    Muscles = 6,
    /// Errors of the senses in a control step.
    Senses = 7,
    /// Trials that an agent learns from by their reward.
    Practice = 8,
}

impl FromStr for Purpose {
    type Err = EnvError;

    /// What cases are drawn for: `learning`, `validation` or `test`.
    fn from_str(name: &str) -> Result<Self, EnvError> {
        match name {
            "learning" => Ok(Self::Learning),
            "validation" => Ok(Self::Validation),
            "test" => Ok(Self::Test),
            _ => Err(EnvError::Option {
                option: "split",
                value: name.to_owned(),
                known: "learning, validation, test".to_owned(),
            }),
        }
    }
}

/// A stream of random numbers (PCG64): the same on every platform, small enough for a snapshot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stream(Pcg64);

impl Stream {
    /// The `index`-th stream of a seed.
    #[must_use]
    pub fn new(purpose: Purpose, seed: u64, index: u64) -> Self {
        let mut words = SplitMix(seed);
        words.0 = words.next() ^ (purpose as u64);
        words.0 = words.next() ^ index;
        let mut bytes = [0; 32];
        for chunk in bytes.chunks_exact_mut(8) {
            chunk.copy_from_slice(&words.next().to_le_bytes());
        }
        Self(Pcg64::from_seed(bytes))
    }

    /// Whether it goes on, as all that are made here do; one that somebody else wrote may stand still.
    pub(crate) fn moves(&self) -> bool {
        let mut next = self.clone();
        next.uniform(0.0, 1.0);
        next != *self
    }

    /// Uniform in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform(0.0, 1.0)));
        radius * libm::cos(self.uniform(0.0, TAU))
    }

    /// A stream of its own for a purpose, which the next number decides.
    #[must_use]
    pub(crate) fn branch(&mut self, purpose: Purpose) -> Self {
        Self::new(purpose, self.0.random(), 0)
    }
}

/// `SplitMix64`, the usual way to spread a few seed words over a state (Steele et al. 2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}
