//! The window rasteriser: surfaces drawn row by row into a depth buffer.

use super::decompose::{Decomposer, decompose};
use super::image_plane::{ImagePlane, offset};
use super::inverse_depth::InverseDepth;
use super::visible_surface::VisibleSurface;
use super::window::Window;
use crate::camera::Pinhole;
use crate::scene::Primitive;

/// No surface at a pixel.
pub(crate) const NOTHING: u32 = u32::MAX;

/// Pixels drawn or shaded at a time, as one vector. The last ones of a run that is drawn may be beyond
/// its end and are left as they are.
pub(crate) const LANES: usize = 4;

/// What is seen at each pixel of a window, as surfaces and inverse depths.
pub(crate) struct DepthBuffer {
    pub(crate) window: Window,
    /// Index of the surface or [`NOTHING`], row-major; [`LANES`] more at the end.
    pub(crate) surface: Vec<u32>,
    /// 1 / depth \[1/m\], 0 where there is nothing.
    pub(crate) inverse_depth: Vec<f32>,
}

impl DepthBuffer {
    pub(crate) fn new(window: Window) -> Self {
        let mut buffer = Self {
            window,
            surface: Vec::new(),
            inverse_depth: Vec::new(),
        };
        buffer.move_to(window.rows);
        buffer
    }

    /// Empties the buffer and moves it to other rows.
    pub(crate) fn move_to(&mut self, rows: (usize, usize)) {
        self.window.rows = rows;
        let pixels = self.window.width() * self.window.height() + LANES;
        self.surface.clear();
        self.surface.resize(pixels, NOTHING);
        self.inverse_depth.clear();
        self.inverse_depth.resize(pixels, 0.0);
    }

    /// Draws a surface, keeping what is nearer.
    pub(crate) fn draw(&mut self, id: u32, surface: &VisibleSurface, plane: &ImagePlane) {
        let part = surface.window.overlap(&self.window);
        if part.is_empty() {
            return;
        }
        match &surface.depth {
            InverseDepth::Flat(flat) => self.rows(id, surface, part, plane, |y| flat.row(y)),
            InverseDepth::Ball(ball) => self.rows(id, surface, part, plane, |y| ball.row(y)),
            InverseDepth::Side(side) => self.rows(id, surface, part, plane, |y| side.row(y)),
        }
    }

    /// Draws the rows of a part, whose inverse depths `row` gives.
    #[inline]
    fn rows<Row: Fn(f32) -> f32>(
        &mut self,
        id: u32,
        surface: &VisibleSurface,
        part: Window,
        plane: &ImagePlane,
        row: impl Fn(f32) -> Row,
    ) {
        surface.rows(&part, plane, |j, columns| {
            let y = offset(j, surface.origin.row);
            self.keep_nearer(id, j, columns, surface.origin.column, row(y));
        });
    }

    /// The pixels of a row, from the first column in `interval` on.
    pub(crate) fn span(&mut self, j: usize, columns: (usize, usize)) -> (&mut [u32], &mut [f32]) {
        let row = (j - self.window.rows.0) * self.window.width();
        let first = row + columns.0 - self.window.columns.0;
        let range = first..first + (columns.1 - columns.0);
        (
            &mut self.surface[range.clone()],
            &mut self.inverse_depth[range],
        )
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
        let count = columns.1 - columns.0;
        let whole = (columns.0, columns.0 + count.next_multiple_of(LANES));
        let mut x = offset(columns.0, origin);
        let (surfaces, depths) = self.span(j, whole);
        let (surfaces, _) = surfaces.as_chunks_mut();
        let (depths, _) = depths.as_chunks_mut();
        let mut blocks = surfaces.iter_mut().zip(depths);
        for (surfaces, depths) in blocks.by_ref().take(count / LANES) {
            draw_block(id, surfaces, depths, lanes(x).map(&inverse_depth));
            x += LANES as f32;
        }
        if let Some((surfaces, depths)) = blocks.next() {
            let (w, limit) = (lanes(x).map(&inverse_depth), WITHIN[count % LANES]);
            let w = std::array::from_fn(|k| if limit[k] < w[k] { limit[k] } else { w[k] });
            draw_block(id, surfaces, depths, w);
        }
    }
}

/// Bounds of inverse depths in a block of which the first 0 to 3 pixels count.
const WITHIN: [[f32; LANES]; LANES] = {
    const ALL: f32 = f32::INFINITY;
    [
        [0.0; LANES],
        [ALL, 0.0, 0.0, 0.0],
        [ALL, ALL, 0.0, 0.0],
        [ALL, ALL, ALL, 0.0],
    ]
};

/// x, x + 1 and so on.
#[inline]
fn lanes(x: f32) -> [f32; LANES] {
    std::array::from_fn(|k| x + k as f32)
}

/// Draws a surface of inverse depths w into a block where it is nearer.
#[inline]
fn draw_block(id: u32, surfaces: &mut [u32; LANES], depths: &mut [f32; LANES], w: [f32; LANES]) {
    // All is read before anything is written, and selected, not branched on,
    // so that the lanes are a vector.
    let (ids, old) = (*surfaces, *depths);
    *depths = std::array::from_fn(|k| if w[k] > old[k] { w[k] } else { old[k] });
    *surfaces = std::array::from_fn(|k| if w[k] > old[k] { id } else { ids[k] });
}

/// The primitive and the depth seen at every pixel of a camera's image.
pub struct Raster {
    width: usize,
    /// Of each surface.
    primitives: Vec<usize>,
    buffer: DepthBuffer,
}

impl Raster {
    /// Index in the scene of the primitive seen at column i, row j; `None`
    /// for the background and for pixels outside of the image.
    #[must_use]
    pub fn primitive(&self, i: usize, j: usize) -> Option<usize> {
        let surface = *self.buffer.surface.get(self.index(i, j)?)?;
        self.primitives.get(surface as usize).copied()
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
    let Decomposer {
        plane, surfaces, ..
    } = decompose(scene, camera, None);
    let mut buffer = DepthBuffer::new(Window::frame(&plane));
    for (id, surface) in (0..).zip(&surfaces) {
        buffer.draw(id, surface, &plane);
    }
    Raster {
        width: camera.width,
        primitives: surfaces.iter().map(|surface| surface.primitive).collect(),
        buffer,
    }
}
