//! Pictures: what the rasteriser sees, lit and coloured.

use image::RgbImage;

use super::ground::Checker;
use super::ink::Ink;
use super::light::{Light, SHADOW, Shaded, Swatch, is_red, pigment, swatch};
use super::piece::{Cutter, Piece, cut_scene};
use super::raster::Buffer;
use super::row::Lens;
use super::shadow::{Shadow, cast};
use super::surface::Surface;
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

/// Draws a scene's targets over a picture of that camera, whatever was in front of them: exactly the
/// pixels that are [red](super::is_red) in a picture of the scene alone.
pub fn draw_red_over(image: &mut RgbImage, scene: &[Primitive], camera: &Pinhole) {
    let pieces = cut_scene(scene, camera, None).pieces;
    let windows = pieces.iter().map(|piece| piece.window);
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

/// How a piece is coloured.
enum Paint {
    Even(Swatch),
    Shaded(Shaded),
    Checker(Checker),
}

/// Shadows on a piece of ground: ids of its lit and of its dark paint.
struct Shade {
    lit: u32,
    dark: u32,
    shadows: Vec<Shadow>,
}

/// Draws a picture, or a window of one, band by band.
pub(super) struct Painter {
    light: Light,
    lens: Lens,
    pieces: Vec<Piece>,
    /// Of the pieces, then of grounds in the shadow.
    paints: Vec<Paint>,
    shades: Vec<Shade>,
    buffer: Buffer,
}

impl Painter {
    /// Of a window, or without one of the whole picture.
    pub(super) fn new(scene: &[Primitive], camera: &Pinhole, view: Option<Window>) -> Self {
        let cutter = cut_scene(scene, camera, view);
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
            rows: (0, 0),
            ..view.unwrap_or(Window::frame(&lens))
        };
        Self {
            light,
            lens,
            pieces,
            paints,
            shades,
            buffer: Buffer::new(window),
        }
    }

    /// Paints whole rows from `first` on.
    pub(super) fn paint<I: Ink>(&mut self, first: usize, rows: &mut [I]) {
        let length = self.buffer.window.width();
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

    fn paint_row<I: Ink>(&mut self, j: usize, row: &mut [I]) {
        let columns = self.buffer.window.columns;
        let y = self.lens.y(j);
        let (pieces, depths) = self.buffer.span(j, columns);
        let mut first = 0;
        while first < row.len() {
            let next = first + run_length(&pieces[first..]);
            let pixels = &mut row[first..next];
            let column = columns.0 + first;
            match self.paints.get(pieces[first] as usize) {
                None => I::fill(pixels, &self.light.sky(y)),
                Some(Paint::Even(swatch)) => I::fill(pixels, swatch),
                Some(Paint::Checker(checker)) => {
                    checker.paint(pixels, column, columns.0 + next, y, &self.lens);
                }
                Some(Paint::Shaded(shaded)) => {
                    shaded.paint(pixels, &depths[first..next], (column, j));
                }
            }
            first = next;
        }
    }
}

fn paint(piece: &Piece, primitive: &Primitive, light: &Light, brightness: f32) -> Paint {
    let colour = pigment(primitive.material);
    match (&piece.surface, &primitive.shape) {
        (Surface::Ball(quadric, _) | Surface::Side(quadric, _), _) => Paint::Shaded(Shaded::new(
            quadric,
            primitive.material,
            light,
            piece.origin,
        )),
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
            Paint::Checker(checker)
        }
        (Surface::Rectangle(flat) | Surface::Ellipse(flat), _) => {
            Paint::Even(swatch(colour, light.on_flat(&flat.normal)))
        }
    }
}

/// How many pixels from the first on show the same piece.
fn run_length(pieces: &[u32]) -> usize {
    let id = pieces[0];
    let same = |block: &&[u32]| block.iter().fold(0, |all, piece| all | (piece ^ id)) == 0;
    let whole = 4 * pieces.chunks_exact(4).take_while(same).count();
    let rest = pieces[whole..].iter().take_while(|piece| **piece == id);
    whole + rest.count()
}
