//! Pictures: what the rasteriser sees, lit and coloured.

use image::RgbImage;

use super::light::is_red;
use super::painter::Painter;
use crate::camera::Pinhole;
use crate::error::EyeError;
use crate::raster::decompose::decompose;
use crate::scene::Primitive;

/// Rows drawn at a time, few enough for their buffers to stay in the cache.
const BAND: usize = 8;

/// Picture of a scene, one ray a pixel. Exactly the pixels in which a target
/// is seen are [red](crate::is_red).
#[must_use]
pub fn render_rgb(scene: &[Primitive], camera: &Pinhole) -> RgbImage {
    let mut image = RgbImage::new(camera.width as u32, camera.height as u32);
    draw(scene, camera, &mut image);
    image
}

/// Picture of a scene as [`render_rgb`], into height × width × 3 bytes.
///
/// # Errors
/// [`EyeError::BufferSize`] if the buffer has another length.
pub fn render_rgb_into(
    scene: &[Primitive],
    camera: &Pinhole,
    pixels: &mut [u8],
) -> Result<(), EyeError> {
    let expected = 3 * camera.width * camera.height;
    if pixels.len() != expected {
        let found = pixels.len();
        return Err(EyeError::BufferSize { found, expected });
    }
    draw(scene, camera, pixels);
    Ok(())
}

/// Draws a scene's targets over a picture of that camera, whatever was in front of them: exactly the
/// pixels that are [red](crate::is_red) in a picture of the scene alone.
pub fn draw_red_over(image: &mut RgbImage, scene: &[Primitive], camera: &Pinhole) {
    let surfaces = decompose(scene, camera, None).surfaces;
    let windows = surfaces.iter().map(|surface| surface.window);
    let window = windows.reduce(|all, window| all.hull(&window));
    let Some(window) = window.filter(|window| !window.is_empty()) else {
        return;
    };
    let mut drawn = vec![[0; 3]; window.width() * window.height()];
    Painter::new(scene, camera, Some(window)).paint(window.rows.0, &mut drawn);
    let rows = image.chunks_exact_mut(3 * camera.width);
    let rows = rows
        .skip(window.rows.0)
        .zip(drawn.chunks_exact(window.width()));
    for (row, drawn) in rows {
        let (pixels, _) = row[3 * window.columns.0..].as_chunks_mut::<3>();
        for (pixel, red) in pixels.iter_mut().zip(drawn).filter(|(_, p)| is_red(**p)) {
            *pixel = *red;
        }
    }
}

fn draw(scene: &[Primitive], camera: &Pinhole, pixels: &mut [u8]) {
    if pixels.is_empty() {
        return;
    }
    let mut painter = Painter::new(scene, camera, None);
    let mut first = 0;
    let (pixels, _) = pixels.as_chunks_mut::<3>();
    for band in pixels.chunks_mut(camera.width * BAND) {
        painter.paint(first, band);
        first += BAND;
    }
}

/// Picture of a scene with smooth edges: the mean of 2 × 2 rays a pixel.
#[must_use]
pub fn render_smooth(scene: &[Primitive], camera: &Pinhole) -> RgbImage {
    let mut image = RgbImage::new(camera.width as u32, camera.height as u32);
    if image.is_empty() {
        return image;
    }
    let fine = camera.scaled(2);
    let mut painter = Painter::new(scene, &fine, None);
    let mut band = vec![[0; 3]; fine.width * BAND];
    let rows = camera.width * 3;
    for (k, coarse) in image.chunks_mut(rows * BAND / 2).enumerate() {
        let fine_rows = &mut band[..4 * coarse.len() / 3];
        painter.paint(k * BAND, fine_rows);
        for (mean, pair) in coarse
            .chunks_exact_mut(rows)
            .zip(fine_rows.as_flattened().chunks_exact(4 * rows))
        {
            halve(mean, pair);
        }
    }
    image
}

/// Means of 2 × 2 pixels; `pair` holds two rows of twice the length.
fn halve(mean: &mut [u8], pair: &[u8]) {
    let (upper, lower) = pair.split_at(pair.len() / 2);
    let blocks = upper.chunks_exact(6).zip(lower.chunks_exact(6));
    for (pixel, (a, b)) in mean.chunks_exact_mut(3).zip(blocks) {
        for c in 0..3 {
            let sum = [a[c], a[c + 3], b[c], b[c + 3]].map(u16::from);
            pixel[c] = ((sum.iter().sum::<u16>() + 2) / 4) as u8;
        }
    }
}
