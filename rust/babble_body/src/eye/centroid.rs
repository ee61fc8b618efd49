//! Centroid of the red pixels: O of Eq. 1.

use super::piece::{Cutter, Piece, Surface};
use super::raster::{Buffer, ball_columns};
use super::row::Lens;
use super::window::Window;
use super::{Pinhole, Primitive};

/// Number and coordinate sums of a set of pixels.
#[derive(Default)]
struct Pixels {
    count: f64,
    x: f64,
    y: f64,
}

impl Pixels {
    /// Adds the columns [first, end) of row j. All sums are multiples of ½
    /// far below 2⁵², so they are exact in any order.
    fn add(&mut self, (first, end): (usize, usize), j: usize) {
        let count = end as f64 - first as f64;
        self.count += count;
        self.x += 0.5 * count * (first + end) as f64;
        self.y += count * (j as f64 + 0.5);
    }

    fn centroid(&self) -> Option<[f64; 2]> {
        (self.count > 0.0).then(|| [self.x / self.count, self.y / self.count])
    }
}

/// Centroid, in pixel coordinates, of the visible pixels of the target
/// primitives; `None` if there are none. It is that of the whole image, but
/// only the target's window is looked at.
#[must_use]
pub fn red_centroid(scene: &[Primitive], camera: &Pinhole) -> Option<[f64; 2]> {
    let mut cutter = Cutter::new(camera);
    for (index, primitive) in targets(scene) {
        cutter.cut(index, &primitive.shape);
    }
    let window = cutter
        .pieces
        .iter()
        .map(|piece| piece.window)
        .reduce(|all, window| all.hull(&window))?;
    let red = cutter.pieces.len();
    let farthest = farthest(&cutter.pieces);
    for (index, primitive) in scene.iter().enumerate() {
        if !primitive.material.target {
            cutter.cut(index, &primitive.shape);
        }
    }
    let Cutter { lens, pieces, .. } = cutter;
    let (red, others) = pieces.split_at(red);
    let mut occluders = others
        .iter()
        .filter(|piece| {
            let part = piece.window.overlap(&window);
            !part.is_empty() && piece.nearest_in(&part, &lens) > farthest
        })
        .peekable();
    match red {
        [piece] if occluders.peek().is_none() => lone(piece, &lens),
        _ => drawn(red, occluders, window, &lens),
    }
}

fn targets(scene: &[Primitive]) -> impl Iterator<Item = (usize, &Primitive)> {
    scene
        .iter()
        .enumerate()
        .filter(|(_, primitive)| primitive.material.target)
}

/// A bound below the inverse depths of the pieces.
fn farthest(pieces: &[Piece]) -> f64 {
    pieces
        .iter()
        .map(|piece| match &piece.surface {
            Surface::Ball(ball) => 1.0 / (ball.centre.z + ball.radius),
            _ => 0.0,
        })
        .fold(f64::INFINITY, f64::min)
}

/// Centroid of a piece that nothing hides: a ball's rows in closed form.
fn lone(piece: &Piece, lens: &Lens) -> Option<[f64; 2]> {
    let Surface::Ball(ball) = &piece.surface else {
        return drawn(std::slice::from_ref(piece), [].iter(), piece.window, lens);
    };
    let mut pixels = Pixels::default();
    for j in piece.window.rows.0..piece.window.rows.1 {
        let columns = ball_columns(ball, j, lens);
        if columns.0 < columns.1 {
            pixels.add(columns, j);
        }
    }
    pixels.centroid()
}

/// Centroid by drawing the window.
fn drawn<'a>(
    red: &[Piece],
    others: impl Iterator<Item = &'a Piece>,
    window: Window,
    lens: &Lens,
) -> Option<[f64; 2]> {
    let mut buffer = Buffer::new(window);
    for piece in others {
        buffer.draw(1, piece, lens);
    }
    for piece in red {
        buffer.draw(0, piece, lens);
    }
    let mut pixels = Pixels::default();
    let rows = buffer.piece.chunks_exact(window.width());
    for (j, row) in (window.rows.0..).zip(rows) {
        for (i, _) in (window.columns.0..).zip(row).filter(|(_, id)| **id == 0) {
            pixels.add((i, i + 1), j);
        }
    }
    pixels.centroid()
}
