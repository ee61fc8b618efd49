//! Runs of pixels of one colour.

/// Sixteen pixels of one colour.
pub(crate) type Swatch = [u8; 48];

/// A swatch of a colour at a brightness.
pub(crate) fn swatch(colour: [f32; 3], brightness: f32) -> Swatch {
    let [red, green, blue] = colour.map(|level| (level * brightness) as u8);
    std::array::from_fn(|k| [red, green, blue][k % 3])
}

/// Fills whole pixels with a swatch's colour.
pub(crate) fn fill(pixels: &mut [u8], swatch: &Swatch) {
    let length = pixels.len();
    if length < swatch.len() {
        pixels.copy_from_slice(&swatch[..length]);
        return;
    }
    for block in pixels.chunks_exact_mut(swatch.len()) {
        block.copy_from_slice(swatch);
    }
    pixels[length - swatch.len()..].copy_from_slice(swatch);
}
