//! What pixels are painted with.

use super::light::{Swatch, fill};

/// Pixels shaded at a time, as one vector.
pub(super) const LANES: usize = 4;

/// A pixel of a picture.
pub(super) trait Ink: Copy {
    /// Paints pixels in the colour of a swatch.
    fn fill(pixels: &mut [Self], swatch: &Swatch);

    /// Pixels of one colour at some brightnesses and highlights.
    fn blend(colour: [f32; 3], brightness: [f32; LANES], highlight: [f32; LANES]) -> [Self; LANES];
}

/// (red, green, blue)
impl Ink for [u8; 3] {
    fn fill(pixels: &mut [Self], swatch: &Swatch) {
        fill(pixels.as_flattened_mut(), swatch);
    }

    #[inline]
    fn blend(colour: [f32; 3], brightness: [f32; LANES], highlight: [f32; LANES]) -> [Self; LANES] {
        std::array::from_fn(|k| {
            colour.map(|level| (level_bits(level * brightness[k] + highlight[k]) >> 15) as u8)
        })
    }
}

/// The bits of 256 + x, with x from 0 on cut at 255: the eight above the lowest
/// fifteen are the whole part of x. Compilers turn this into vectors.
#[inline]
fn level_bits(x: f32) -> u32 {
    let x = if x < 255.0 { x } else { 255.0 };
    (x + 256.0).to_bits()
}
