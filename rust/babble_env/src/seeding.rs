//! The seeds of Gymnasium's `reset`, so that one seed draws the same cases in every language.

use rand::Rng;
use rand_pcg::Pcg64;

/// Words of the pool that a seed is spread over.
const POOL: usize = 4;
const SPREAD: u32 = 0x43b0_d7e5;
const SPREAD_FACTOR: u32 = 0x931e_8875;
const DRAW: u32 = 0x8b51_f9dd;
const DRAW_FACTOR: u32 = 0x58f3_8ded;
const MIX_LEFT: u32 = 0xca01_f9dd;
const MIX_RIGHT: u32 = 0x4973_f715;
const SHIFT: u32 = 16;

/// Seed of the stream of cases for the seed of a `reset`: the first whole number below 2⁶³ of NumPy's
/// generator that Gymnasium makes from it, `np_random(seed)[0].integers(2**63)`.
#[must_use]
pub fn stream_seed(seed: u64) -> u64 {
    let [state, stream] = spread(seed);
    // Of a range of 2⁶³ NumPy takes the upper bits of one draw.
    Pcg64::new(state, stream).next_u64() >> 1
}

/// State and stream of PCG64, as NumPy's `SeedSequence` makes them (after O'Neill's `seed_seq`).
fn spread(seed: u64) -> [u128; 2] {
    let words = [seed as u32, (seed >> 32) as u32];
    let mut constant = SPREAD;
    let mut pool = [0; POOL];
    for (i, slot) in pool.iter_mut().enumerate() {
        let word = words.get(i).copied().unwrap_or(0);
        *slot = hashed(word, &mut constant, SPREAD_FACTOR);
    }
    for from in 0..POOL {
        for to in 0..POOL {
            if from != to {
                let word = hashed(pool[from], &mut constant, SPREAD_FACTOR);
                pool[to] = mixed(pool[to], word);
            }
        }
    }
    let mut constant = DRAW;
    let mut drawn = pool.iter().cycle();
    let mut word = || {
        let next = drawn.next().copied().unwrap_or(0);
        u128::from(hashed(next, &mut constant, DRAW_FACTOR))
    };
    // The low word of each pair comes first, the low pair last.
    let mut pair = || word() | word() << 32;
    let mut quad = || pair() << 64 | pair();
    [quad(), quad()]
}

fn hashed(value: u32, constant: &mut u32, factor: u32) -> u32 {
    let value = value ^ *constant;
    *constant = constant.wrapping_mul(factor);
    let value = value.wrapping_mul(*constant);
    value ^ value >> SHIFT
}

fn mixed(x: u32, y: u32) -> u32 {
    let sum = MIX_LEFT
        .wrapping_mul(x)
        .wrapping_sub(MIX_RIGHT.wrapping_mul(y));
    sum ^ sum >> SHIFT
}

#[cfg(test)]
mod tests {
    use super::stream_seed;

    #[test]
    fn as_numpy_draws_them() {
        for (seed, drawn) in [
            (0, 5_874_934_615_388_537_135),
            (1, 4_720_721_261_117_928_063),
            (123, 6_293_585_094_778_680_550),
            (4_294_967_295, 2_323_769_260_371_640_015),
            (4_294_967_296, 8_206_391_887_579_712_274),
            (9_223_372_036_854_775_808, 7_483_331_053_097_795_198),
            (18_446_744_073_709_551_615, 6_272_139_055_050_500_935),
        ] {
            assert_eq!(stream_seed(seed), drawn, "{seed}");
        }
    }
}
