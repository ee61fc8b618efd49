//! The shape of the foveated object, the grasping model's "what" input: edges
//! that a Sobel filter finds in the middle of the eye's image.

use image::{GrayImage, Luma, RgbImage};

use crate::camera::Pinhole;
use crate::raster::window::Window;
use crate::render::painter::Painter;
use crate::render::pixel_format::{PixelFormat, WHITE};
use crate::scene::Primitive;

/// Edge of the image that the fovea is the middle of \[pixel\], the paper's.
const IMAGE: usize = 630;
/// Edge of the fovea \[pixel\]: "the central 63 × 63 pixel portion".
pub const FOVEA_PIXELS: usize = 63;
/// Edge of the blocks \[pixel\] whose means are the values of a shape: the
/// paper's maps have 21 × 21 neurons.
pub const FOVEA_BLOCK: usize = 3;
/// Blocks along an edge of the fovea.
pub const FOVEA_BLOCKS: usize = FOVEA_PIXELS / FOVEA_BLOCK;
/// Values of a shape.
pub const SHAPE_LEN: usize = FOVEA_BLOCKS * FOVEA_BLOCKS;

/// Edge of what is drawn: a pixel more on each side, so that edges at the
/// fovea's border are those of the image.
const DRAWN: usize = FOVEA_PIXELS + 2;
/// First column and row of the fovea. 630 − 63 is odd: the eye's axis meets the
/// fovea half a pixel to the right of and below its middle.
const FIRST: usize = (IMAGE - FOVEA_PIXELS) / 2;

/// Factor to make edges of luminances up to [`WHITE`] those of luminances up to
/// 1, over 4√2. Neither slope exceeds 4, so 4√2 is a bound; both are not 4 at
/// the same pixel, so edges reach 2√5 / 4√2 = 0.79.
const SCALE: f32 = 1.0 / (4.0 * std::f32::consts::SQRT_2 * WHITE);

/// Magnitudes of the edges along a row of the fovea.
type Row = [f32; FOVEA_PIXELS];

/// The shape of what a camera of the [eye](super::Eye::camera) sees in its
/// fovea: the means of the Sobel filter's magnitude √(gx² + gy²) / 4√2 over
/// blocks of 3 × 3 pixels, 21 × 21 row by row from the upper left, in [0, 1].
///
/// The filter works on the luminance (Rec. 709, 0 to 1) of
/// [`render_rgb`](super::render_rgb)'s 8-bit colours. The fovea is columns and
/// rows 283 to 345 of the eye's 630 × 630 pixels; a camera with another number
/// of pixels is sampled as if its image was 630 pixels wide.
pub fn foveal_shape(scene: &[Primitive], camera: &Pinhole, shape: &mut [f32; SHAPE_LEN]) {
    let luminance: Vec<f32> = draw(scene, camera);
    let (rows, _) = shape.as_chunks_mut::<FOVEA_BLOCKS>();
    for (k, blocks) in rows.iter_mut().enumerate() {
        let [mut sum, second, third] =
            [0, 1, 2].map(|row| edges(&luminance, FOVEA_BLOCK * k + row));
        for (sum, (second, third)) in sum.iter_mut().zip(second.iter().zip(third)) {
            *sum = *sum + second + third;
        }
        for (mean, block) in blocks.iter_mut().zip(sum.as_chunks::<FOVEA_BLOCK>().0) {
            *mean = (block[0] + block[1] + block[2]) / (FOVEA_BLOCK * FOVEA_BLOCK) as f32;
        }
    }
}

/// The window of the image that is drawn, from a camera at the eye's sampling.
fn draw<I: PixelFormat + Default>(scene: &[Primitive], camera: &Pinhole) -> Vec<I> {
    let camera = Pinhole {
        width: IMAGE,
        height: IMAGE,
        focal_px: camera.focal_px * (IMAGE as f64 / camera.width as f64),
        ..camera.clone()
    };
    let drawn = (FIRST - 1, FIRST - 1 + DRAWN);
    let window = Window {
        columns: drawn,
        rows: drawn,
    };
    let mut pixels = vec![I::default(); DRAWN * DRAWN];
    Painter::new(scene, &camera, Some(window)).paint(drawn.0, &mut pixels);
    pixels
}

/// Row j of the fovea through the Sobel filter.
fn edges(luminance: &[f32], j: usize) -> Row {
    let row = |k: usize| luminance[(j + k) * DRAWN..].first_chunk::<DRAWN>();
    let (Some(above), Some(here), Some(below)) = (row(0), row(1), row(2)) else {
        return [0.0; FOVEA_PIXELS];
    };
    // What the filter does along columns, then along rows.
    let smooth: [f32; DRAWN] = std::array::from_fn(|i| above[i] + 2.0 * here[i] + below[i]);
    let slope: [f32; DRAWN] = std::array::from_fn(|i| below[i] - above[i]);
    std::array::from_fn(|i| {
        let gx = smooth[i + 2] - smooth[i];
        let gy = slope[i] + 2.0 * slope[i + 1] + slope[i + 2];
        (gx * gx + gy * gy).sqrt() * SCALE
    })
}

/// The picture of the fovea, 63 × 63.
#[must_use]
pub fn foveal_picture(scene: &[Primitive], camera: &Pinhole) -> RgbImage {
    let drawn = draw::<[u8; 3]>(scene, camera);
    let edge = FOVEA_PIXELS as u32;
    RgbImage::from_fn(edge, edge, |x, y| {
        image::Rgb(drawn[(y as usize + 1) * DRAWN + x as usize + 1])
    })
}

/// The edges in the fovea, 63 × 63, white for 1.
#[must_use]
pub fn foveal_edges(scene: &[Primitive], camera: &Pinhole) -> GrayImage {
    let luminance: Vec<f32> = draw(scene, camera);
    let mut picture = GrayImage::new(FOVEA_PIXELS as u32, FOVEA_PIXELS as u32);
    for (j, row) in picture.chunks_exact_mut(FOVEA_PIXELS).enumerate() {
        for (level, edge) in row.iter_mut().zip(edges(&luminance, j)) {
            *level = grey(edge);
        }
    }
    picture
}

/// A [shape](foveal_shape) as a picture, 21 × 21, white for 1.
#[must_use]
pub fn shape_picture(shape: &[f32; SHAPE_LEN]) -> GrayImage {
    let edge = FOVEA_BLOCKS as u32;
    GrayImage::from_fn(edge, edge, |x, y| {
        Luma([grey(shape[y as usize * FOVEA_BLOCKS + x as usize])])
    })
}

/// The nearest level of 255.
fn grey(x: f32) -> u8 {
    (255.0 * x + 0.5) as u8
}
