//! The window rasteriser: surfaces drawn row by row into a depth buffer.

use nalgebra::Vector3;

use super::piece::{Cutter, Ends, Flat, Piece, Quadric, Surface, cut_scene};
use super::row::{Cone, Lens, NOWHERE, along_row, clip};
use super::window::Window;
use super::{Pinhole, Primitive};

/// No surface at a pixel.
pub(super) const NOTHING: u32 = u32::MAX;

/// What is seen at each pixel of a window, as pieces and inverse depths.
pub(super) struct Buffer {
    pub(super) window: Window,
    /// Index of the piece or [`NOTHING`], row-major.
    pub(super) piece: Vec<u32>,
    /// 1 / depth \[1/m\], 0 where there is nothing.
    pub(super) inverse_depth: Vec<f32>,
}

impl Buffer {
    pub(super) fn new(window: Window) -> Self {
        let pixels = window.width() * window.height();
        Self {
            window,
            piece: vec![NOTHING; pixels],
            inverse_depth: vec![0.0; pixels],
        }
    }

    /// Empties the buffer and moves it to rows from `first` on.
    pub(super) fn move_to(&mut self, rows: (usize, usize)) {
        self.window.rows = rows;
        self.piece.fill(NOTHING);
        self.inverse_depth.fill(0.0);
    }

    /// Draws a piece, keeping what is nearer.
    pub(super) fn draw(&mut self, id: u32, piece: &Piece, lens: &Lens) {
        let part = piece.window.overlap(&self.window);
        if part.is_empty() {
            return;
        }
        for j in part.rows.0..part.rows.1 {
            match &piece.surface {
                Surface::Ball(ball) => self.ball_row(id, ball, j, part.columns, lens),
                Surface::Side(side, ends) => self.side_row(id, (side, ends), j, part.columns, lens),
                Surface::Rectangle(flat) => {
                    let interval = rectangle_interval(flat, lens.y(j));
                    self.flat_row(id, (&flat.w, interval), j, part.columns, lens);
                }
                Surface::Ellipse(flat, cone) => {
                    let interval = ellipse_interval(cone, lens.y(j));
                    self.flat_row(id, (&flat.w, interval), j, part.columns, lens);
                }
            }
        }
    }

    /// The pixels of a row, from the first column in `interval` on.
    pub(super) fn span(&mut self, j: usize, columns: (usize, usize)) -> (&mut [u32], &mut [f32]) {
        let row = (j - self.window.rows.0) * self.window.width();
        let first = row + columns.0 - self.window.columns.0;
        let range = first..first + (columns.1 - columns.0);
        (
            &mut self.piece[range.clone()],
            &mut self.inverse_depth[range],
        )
    }

    fn ball_row(&mut self, id: u32, ball: &Quadric, j: usize, within: (usize, usize), lens: &Lens) {
        if let Some((row, columns)) = quadric_row(&ball.cone, j, within, lens) {
            self.keep_nearer(id, j, columns, row.origin, |delta| row.inverse_depth(delta));
        }
    }

    fn side_row(
        &mut self,
        id: u32,
        (side, ends): (&Quadric, &Ends),
        j: usize,
        within: (usize, usize),
        lens: &Lens,
    ) {
        let Some((row, columns)) = quadric_row(&side.cone, j, within, lens) else {
            return;
        };
        let [along, along_step] = lens.linear_about(&ends.along, lens.y(j), row.origin);
        let start = ends.start as f32;
        self.keep_nearer(id, j, columns, row.origin, |delta| {
            let w = row.inverse_depth(delta);
            let place = along + along_step * delta - start * w;
            if place >= 0.0 && place <= w { w } else { 0.0 }
        });
    }

    fn flat_row(
        &mut self,
        id: u32,
        (w, interval): (&Vector3<f64>, [f64; 2]),
        j: usize,
        within: (usize, usize),
        lens: &Lens,
    ) {
        let columns = meet(lens.columns(interval), within);
        if columns.0 < columns.1 {
            let [start, step] = lens.linear_about(w, lens.y(j), 0);
            self.keep_nearer(id, j, columns, 0, |delta| start + step * delta);
        }
    }

    /// Draws a surface into columns of row j where it is nearer than what is
    /// there. `inverse_depth` takes the number of columns from `origin`.
    #[inline]
    fn keep_nearer(
        &mut self,
        id: u32,
        j: usize,
        columns: (usize, usize),
        origin: usize,
        inverse_depth: impl Fn(f32) -> f32,
    ) {
        let (pieces, depths) = self.span(j, columns);
        let first = columns.0 as f32 - origin as f32;
        for (k, (piece, depth)) in (0_i32..).zip(pieces.iter_mut().zip(depths)) {
            // Selected, not branched on, so that the loop runs in vectors.
            let w = inverse_depth(first + k as f32);
            let nearer = w > *depth;
            *depth = if nearer { w } else { *depth };
            *piece = if nearer { id } else { *piece };
        }
    }
}

/// Where a parallelogram's row lies: |u| ≤ w, |v| ≤ w.
pub(super) fn rectangle_interval(flat: &Flat, y: f64) -> [f64; 2] {
    let [w, u, v] = [&flat.w, &flat.u, &flat.v].map(|form| along_row(form, y));
    let all = [NOWHERE[1], NOWHERE[0]];
    [u, v].into_iter().fold(all, |interval, edge| {
        let interval = clip(interval, [w[0] - edge[0], w[1] - edge[1]]);
        clip(interval, [w[0] + edge[0], w[1] + edge[1]])
    })
}

/// Where an ellipse's row lies: u² + v² ≤ w², w > 0.
pub(super) fn ellipse_interval(cone: &Cone, y: f64) -> [f64; 2] {
    cone.interval(y, cone.discriminant(y))
}

/// A row of a quadric: w = l₀ + l₁ δ + √(D₀ + D₁ δ + D₂ δ²), δ counted from
/// `origin`, a column near the middle of the row's visible part.
struct QuadricRow {
    origin: usize,
    linear: [f32; 2],
    discriminant: [f32; 3],
}

impl QuadricRow {
    fn inverse_depth(&self, delta: f32) -> f32 {
        let [l0, l1] = self.linear;
        let [d0, d1, d2] = self.discriminant;
        let square = (d2 * delta + d1) * delta + d0;
        l0 + l1 * delta + (if square > 0.0 { square } else { 0.0 }).sqrt()
    }
}

/// The row of a quadric and the columns in which it is seen.
fn quadric_row(
    cone: &Cone,
    j: usize,
    within: (usize, usize),
    lens: &Lens,
) -> Option<(QuadricRow, (usize, usize))> {
    let y = lens.y(j);
    let discriminant = cone.discriminant(y);
    let seen = lens.columns(cone.interval(y, discriminant));
    let columns = meet(seen, within);
    if columns.0 >= columns.1 {
        return None;
    }
    // Independent of the window, so that a pixel has the same depth in each.
    let origin = usize::midpoint(seen.0, seen.1);
    let row = QuadricRow {
        origin,
        linear: lens.linear_about(&cone.linear, y, origin),
        discriminant: lens.quadratic_about(discriminant, origin),
    };
    Some((row, columns))
}

/// Columns of a row in which a ball is seen.
pub(super) fn ball_columns(ball: &Quadric, j: usize, lens: &Lens) -> (usize, usize) {
    let y = lens.y(j);
    lens.columns(ball.cone.interval(y, ball.cone.discriminant(y)))
}

pub(super) fn meet(a: (usize, usize), b: (usize, usize)) -> (usize, usize) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// The primitive and the depth seen at every pixel of a camera's image.
pub struct Raster {
    width: usize,
    /// Of each piece.
    primitives: Vec<usize>,
    buffer: Buffer,
}

impl Raster {
    /// Index in the scene of the primitive seen at column i, row j; `None`
    /// for the background and for pixels outside of the image.
    #[must_use]
    pub fn primitive(&self, i: usize, j: usize) -> Option<usize> {
        let piece = *self.buffer.piece.get(self.index(i, j)?)?;
        self.primitives.get(piece as usize).copied()
    }

    /// Depth along the camera's axis \[m\] at column i, row j; infinite for the
    /// background and for pixels outside of the image.
    #[must_use]
    pub fn depth(&self, i: usize, j: usize) -> f32 {
        self.index(i, j)
            .and_then(|index| self.buffer.inverse_depth.get(index))
            .map_or(f32::INFINITY, |w| 1.0 / w)
    }

    fn index(&self, i: usize, j: usize) -> Option<usize> {
        (i < self.width).then_some(j * self.width + i)
    }
}

/// What a camera sees of a scene.
#[must_use]
pub fn rasterise(scene: &[Primitive], camera: &Pinhole) -> Raster {
    let Cutter { lens, pieces, .. } = cut_scene(scene, camera);
    let mut buffer = Buffer::new(Window::frame(&lens));
    for (id, piece) in (0..).zip(&pieces) {
        buffer.draw(id, piece, &lens);
    }
    Raster {
        width: camera.width,
        primitives: pieces.iter().map(|piece| piece.primitive).collect(),
        buffer,
    }
}
