//! A hash of bits, the same on every platform.

use babble_agent::AnyLearner;
use xxhash_rust::xxh3::Xxh3;

/// A hash of parts, each of which counts with its length.
#[derive(Default)]
pub(crate) struct Hash(Xxh3);

impl Hash {
    /// Adds bytes.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Adds the bits of numbers.
    fn add_numbers(&mut self, numbers: &[f32]) {
        self.0.update(&(numbers.len() as u64).to_le_bytes());
        let mut bytes = [0; 1024];
        for some in numbers.chunks(bytes.len() / 4) {
            for (to, number) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(some) {
                *to = number.to_le_bytes();
            }
            self.0.update(&bytes[..4 * some.len()]);
        }
    }

    /// The hash.
    pub(crate) fn finish(&self) -> u64 {
        self.0.digest()
    }
}

/// Hash of all that a learner knows.
pub(crate) fn of_learner(learner: &dyn AnyLearner) -> u64 {
    let mut hash = Hash::default();
    hash.add(&learner.seed().to_le_bytes());
    hash.add(&learner.babbled().to_le_bytes());
    hash.add(&learner.learnt().to_le_bytes());
    for (name, association) in learner.associations() {
        hash.add(name.as_bytes());
        hash.add_numbers(association.weights());
        hash.add_numbers(association.a_mean());
        hash.add_numbers(association.g_mean());
    }
    hash.finish()
}
