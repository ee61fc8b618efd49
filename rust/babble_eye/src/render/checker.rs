//! The checker of the ground: runs of one colour along a row.

use super::pixel_format::PixelFormat;
use super::swatch::{Swatch, swatch};
use crate::raster::image_plane::ImagePlane;
use crate::raster::surface::FlatSurface;

/// A checkered ground in the camera frame.
#[derive(Debug, Clone)]
pub(crate) struct Checker {
    /// Coordinates in squares: (x · d) / (w · d), (y · d) / (w · d).
    x: nalgebra::Vector3<f64>,
    y: nalgebra::Vector3<f64>,
    w: nalgebra::Vector3<f64>,
    /// Colours of the even and the odd squares.
    swatches: [Swatch; 2],
}

/// Darkening of every other square.
const CONTRAST: f32 = 0.955;

impl Checker {
    /// From the rectangle's flat, its middle and half edges \[m\] and the edge
    /// of a square \[m\].
    pub(crate) fn new(
        flat: &FlatSurface,
        centre: [f64; 2],
        half: [f64; 2],
        cell: f64,
        colour: [f32; 3],
        brightness: f32,
    ) -> Self {
        let squares = |form, k: usize| form * (half[k] / cell) + flat.w * (centre[k] / cell);
        Self {
            x: squares(flat.u, 0),
            y: squares(flat.v, 1),
            w: flat.w,
            swatches: [
                swatch(colour, brightness),
                swatch(colour, brightness * CONTRAST),
            ],
        }
    }

    /// Paints the columns [first, end) of a row; `pixels` begins at `first`.
    pub(crate) fn paint<I: PixelFormat>(
        &self,
        pixels: &mut [I],
        first: usize,
        end: usize,
        y: f64,
        plane: &ImagePlane,
    ) {
        let w = along_row(&self.w, y);
        let [mut x, mut y] = [&self.x, &self.y]
            .map(|form| Crossings::from_column(along_row(form, y), w, first, plane));
        let mut column = first;
        let mut odd = (x.square + y.square) & 1 == 1;
        while column < end {
            let next = x.next.min(y.next).min(end);
            let run = column - first..next - first;
            I::fill(&mut pixels[run], &self.swatches[usize::from(odd)]);
            for axis in [&mut x, &mut y] {
                if axis.next == next {
                    axis.advance(plane);
                    odd = !odd;
                }
            }
            column = next;
        }
    }
}

/// A linear form along a row: [slope, offset] in X.
fn along_row(form: &nalgebra::Vector3<f64>, y: f64) -> [f64; 2] {
    [form.x, form.y * y + form.z]
}

/// The edges of squares that a row crosses along one coordinate of the ground.
struct Crossings {
    /// Numerator and denominator of the coordinate as [slope, offset] in X.
    numerator: [f64; 2],
    w: [f64; 2],
    /// The square of the first column.
    square: i64,
    /// Coordinate of the next edge, and from one edge to the one after it.
    edge: f64,
    step: f64,
    /// X of that edge, and the column next to it.
    x: f64,
    next: usize,
}

impl Crossings {
    fn from_column(numerator: [f64; 2], w: [f64; 2], column: usize, plane: &ImagePlane) -> Self {
        let x = plane.x(column);
        let value = (numerator[0] * x + numerator[1]) / (w[0] * x + w[1]);
        let whole = value as i64;
        let square = whole - i64::from((whole as f64) > value);
        let grows = numerator[0] * w[1] > numerator[1] * w[0];
        let mut crossings = Self {
            numerator,
            w,
            square,
            edge: (square + i64::from(grows)) as f64,
            step: if grows { 1.0 } else { -1.0 },
            x,
            next: column,
        };
        crossings.find(plane);
        crossings
    }

    fn advance(&mut self, plane: &ImagePlane) {
        self.edge += self.step;
        self.find(plane);
    }

    /// The next edge; the end of the row if there is none ahead, as beyond
    /// the horizon or along an edge.
    fn find(&mut self, plane: &ImagePlane) {
        let x = (self.edge * self.w[1] - self.numerator[1])
            / (self.numerator[0] - self.edge * self.w[0]);
        if x >= self.x {
            self.x = x;
            self.next = plane.columns([x, f64::INFINITY]).0;
        } else {
            self.x = f64::INFINITY;
            self.next = plane.width;
        }
    }
}
