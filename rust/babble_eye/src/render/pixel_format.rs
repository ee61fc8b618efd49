//! Pixel formats of pictures: 8-bit colours, or their luminance.

use super::swatch::{Swatch, fill};
pub(crate) use crate::raster::depth_buffer::LANES;

/// What the painter writes into a pixel.
pub(crate) trait PixelFormat: Copy {
    /// Paints pixels in the colour of a swatch.
    fn fill(pixels: &mut [Self], swatch: &Swatch);

    /// Pixels of one colour at some brightnesses and highlights.
    fn blend(colour: [f32; 3], brightness: [f32; LANES], highlight: [f32; LANES]) -> [Self; LANES];
}

/// (red, green, blue)
impl PixelFormat for [u8; 3] {
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

/// Weights of (red, green, blue) in the luminance of ITU-R BT.709, times 10⁴.
/// Levels are whole numbers to 255, so sums of a few luminances are whole
/// numbers below 2²⁴: exact in f32, in any order.
const BT_709: [f32; 3] = [2126.0, 7152.0, 722.0];

/// The luminance of white.
pub(crate) const WHITE: f32 = 255.0 * 1e4;

/// Luminance of a colour, 0 to [`WHITE`].
#[inline]
fn luminance([red, green, blue]: [f32; 3]) -> f32 {
    let [r, g, b] = BT_709;
    r * red + g * green + b * blue
}

/// Luminance of the colour that is painted with `[u8; 3]`.
impl PixelFormat for f32 {
    fn fill(pixels: &mut [Self], swatch: &Swatch) {
        pixels.fill(luminance([swatch[0], swatch[1], swatch[2]].map(f32::from)));
    }

    #[inline]
    fn blend(colour: [f32; 3], brightness: [f32; LANES], highlight: [f32; LANES]) -> [Self; LANES] {
        let levels = colour.map(|level| {
            std::array::from_fn::<_, LANES, _>(|k| {
                let bits = level_bits(level * brightness[k] + highlight[k]);
                f32::from_bits(bits & !0x7fff)
            })
        });
        let offset = luminance([256.0; 3]);
        std::array::from_fn(|k| luminance(levels.map(|level| level[k])) - offset)
    }
}
