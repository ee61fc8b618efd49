//! Pictures: what the rasteriser sees, lit and coloured.

use image::RgbImage;
use nalgebra::Vector3;

use super::ground::Checker;
use super::light::{Light, SHADOW, Shaded, Swatch, background, fill, pigment, swatch};
use super::piece::{Cutter, Piece, Surface, cut_scene};
use super::raster::Buffer;
use super::row::Lens;
use super::shadow::{Shadow, cast};
use super::window::Window;
use super::{EyeError, Pinhole, Primitive, Shape};

/// Rows drawn at a time, few enough for their buffers to stay in the cache.
const BAND: usize = 8;

/// Picture of a scene, one ray a pixel. Exactly the pixels in which a target
/// is seen are [red](super::is_red).
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

fn draw(scene: &[Primitive], camera: &Pinhole, pixels: &mut [u8]) {
    if pixels.is_empty() {
        return;
    }
    let mut painter = Painter::new(scene, camera);
    let mut first = 0;
    for band in pixels.chunks_mut(3 * camera.width * BAND) {
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
    let mut painter = Painter::new(scene, &fine);
    let mut band = vec![0; 3 * fine.width * BAND];
    let rows = camera.width * 3;
    for (k, coarse) in image.chunks_mut(rows * BAND / 2).enumerate() {
        let fine_rows = &mut band[..4 * coarse.len()];
        painter.paint(k * BAND, fine_rows);
        for (mean, pair) in coarse
            .chunks_exact_mut(rows)
            .zip(fine_rows.chunks_exact(4 * rows))
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

/// How a piece is coloured.
enum Paint {
    Even(Swatch),
    Shaded(Box<Shaded>),
    Checker(Box<Checker>),
}

/// Shadows on a piece of ground: ids of its lit and of its dark paint.
struct Shade {
    lit: u32,
    dark: u32,
    shadows: Vec<Shadow>,
}

/// Draws a picture band by band.
struct Painter {
    lens: Lens,
    pieces: Vec<Piece>,
    /// Of the pieces, then of grounds in the shadow.
    paints: Vec<Paint>,
    shades: Vec<Shade>,
    /// Vertical in the camera frame.
    up: Vector3<f64>,
    buffer: Buffer,
}

impl Painter {
    fn new(scene: &[Primitive], camera: &Pinhole) -> Self {
        let cutter = cut_scene(scene, camera);
        let light = Light::new(&camera.rotation);
        let mut paints: Vec<Paint> = cutter
            .pieces
            .iter()
            .map(|piece| paint(piece, &scene[piece.primitive], &light, 1.0))
            .collect();
        let mut shades = Vec::new();
        for (lit, piece) in (0..).zip(&cutter.pieces) {
            let primitive = &scene[piece.primitive];
            if let Shape::Ground { height, .. } = primitive.shape {
                shades.push(Shade {
                    lit,
                    dark: paints.len() as u32,
                    shadows: cast(scene, height, &cutter),
                });
                paints.push(paint(piece, primitive, &light, SHADOW));
            }
        }
        let Cutter { lens, pieces, .. } = cutter;
        let window = Window {
            columns: (0, lens.width),
            rows: (0, BAND.min(lens.height)),
        };
        Self {
            lens,
            pieces,
            paints,
            shades,
            up: camera.rotation.column(2).into_owned(),
            buffer: Buffer::new(window),
        }
    }

    /// Paints whole rows from `first` on.
    fn paint(&mut self, first: usize, rows: &mut [u8]) {
        let length = 3 * self.lens.width;
        let end = first + rows.len() / length;
        self.buffer.move_to((first, end));
        for (id, piece) in (0..).zip(&self.pieces) {
            self.buffer.draw(id, piece, &self.lens);
        }
        for shade in &self.shades {
            for shadow in &shade.shadows {
                shadow.draw(&mut self.buffer, shade.lit, shade.dark, &self.lens);
            }
        }
        for (j, row) in (first..).zip(rows.chunks_exact_mut(length)) {
            self.paint_row(j, row);
        }
    }

    fn paint_row(&mut self, j: usize, row: &mut [u8]) {
        let y = self.lens.y(j);
        let end = self.lens.width;
        let sky = self.background(y);
        let (pieces, depths) = self.buffer.span(j, (0, end));
        let mut first = 0;
        while first < end {
            let next = first + run_length(&pieces[first..]);
            let pixels = &mut row[3 * first..3 * next];
            match self.paints.get(pieces[first] as usize) {
                None => fill(pixels, &sky),
                Some(Paint::Even(swatch)) => fill(pixels, swatch),
                Some(Paint::Checker(checker)) => checker.paint(pixels, first, next, y, &self.lens),
                Some(Paint::Shaded(shaded)) => {
                    shade(pixels, shaded, &depths[first..next], first, y, &self.lens);
                }
            }
            first = next;
        }
    }

    /// The background of a row: that in the direction of its middle.
    fn background(&self, y: f64) -> Swatch {
        let sine = (self.up.y * y + self.up.z) / (y * y + 1.0).sqrt();
        swatch(background(sine), 1.0)
    }
}

fn paint(piece: &Piece, primitive: &Primitive, light: &Light, brightness: f32) -> Paint {
    let colour = pigment(primitive.material);
    match (&piece.surface, &primitive.shape) {
        (Surface::Ball(quadric) | Surface::Side(quadric, _), _) => {
            Paint::Shaded(Box::new(Shaded::new(quadric, primitive.material, light)))
        }
        (
            Surface::Rectangle(flat),
            Shape::Ground {
                centre,
                half_extents,
                cell,
                ..
            },
        ) => {
            let brightness = brightness * light.on_flat(&flat.normal);
            let checker = Checker::new(flat, *centre, *half_extents, *cell, colour, brightness);
            Paint::Checker(Box::new(checker))
        }
        (Surface::Rectangle(flat) | Surface::Ellipse(flat, _), _) => {
            Paint::Even(swatch(colour, light.on_flat(&flat.normal)))
        }
    }
}

/// How many pixels from the first on show the same piece.
fn run_length(pieces: &[u32]) -> usize {
    let id = pieces[0];
    let same = |block: &&[u32]| block.iter().fold(0, |all, piece| all | (piece ^ id)) == 0;
    let whole = 8 * pieces.chunks_exact(8).take_while(same).count();
    let rest = pieces[whole..].iter().take_while(|piece| **piece == id);
    whole + rest.count()
}

/// Shades a run of pixels of a ball or of a cylinder's side.
fn shade(pixels: &mut [u8], shaded: &Shaded, depths: &[f32], first: usize, y: f64, lens: &Lens) {
    const BLOCK: usize = 32;
    let cosines = shaded.cosines.each_ref().map(|cosine| {
        let [start, step] = lens.linear_about(&cosine.along, y, first);
        move |delta: f32, depth: f32| (start + step * delta) * depth - cosine.offset
    });
    let mut light = [[0.0; 2]; BLOCK];
    let mut columns = 0_i32..;
    for (pixels, depths) in pixels.chunks_mut(3 * BLOCK).zip(depths.chunks(BLOCK)) {
        for ((light, w), delta) in light.iter_mut().zip(depths).zip(&mut columns) {
            let depth = 1.0 / w;
            *light = shaded.at(cosines.each_ref().map(|cosine| cosine(delta as f32, depth)));
        }
        for (pixel, [brightness, gloss]) in pixels.chunks_exact_mut(3).zip(light) {
            for (level, colour) in pixel.iter_mut().zip(shaded.colour) {
                *level = (colour * brightness + gloss) as u8;
            }
        }
    }
}
