//! Centroid of the red pixels: O of Eq. 1.

use crate::camera::Pinhole;
use crate::raster::decompose::Decomposer;
use crate::raster::depth_buffer::DepthBuffer;
use crate::raster::image_plane::ImagePlane;
use crate::raster::surface::SurfaceKind;
use crate::raster::visible_surface::VisibleSurface;
use crate::raster::window::Window;
use crate::scene::Primitive;

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

    /// Adds some pixels of row j, `sum` of their columns counted from `first`.
    fn add_row(&mut self, [count, sum]: [f64; 2], first: usize, j: usize) {
        self.count += count;
        self.x += count * (first as f64 + 0.5) + sum;
        self.y += count * (j as f64 + 0.5);
    }

    fn region(&self) -> Option<RedRegion> {
        (self.count > 0.0).then(|| RedRegion {
            pixels: self.count as u64,
            centroid: [self.x / self.count, self.y / self.count],
        })
    }
}

/// The visible pixels of the target primitives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RedRegion {
    /// How many there are.
    pub pixels: u64,
    /// Their centroid in pixel coordinates.
    pub centroid: [f64; 2],
}

/// Centroid, in pixel coordinates, of the visible pixels of the target
/// primitives; `None` if there are none.
#[must_use]
pub fn red_centroid(scene: &[Primitive], camera: &Pinhole) -> Option<[f64; 2]> {
    Some(red_region(scene, camera)?.centroid)
}

/// The visible pixels of the target primitives; `None` if there are none. They
/// are those of the whole image, but only the target's window is looked at.
#[must_use]
pub fn red_region(scene: &[Primitive], camera: &Pinhole) -> Option<RedRegion> {
    let mut decomposer = Decomposer::new(camera);
    for (index, primitive) in targets(scene) {
        decomposer.add(index, &primitive.shape);
    }
    let window = decomposer
        .surfaces
        .iter()
        .map(|surface| surface.window)
        .reduce(|all, window| all.hull(&window))?;
    let red = decomposer.surfaces.len();
    let farthest = farthest(&decomposer.surfaces, &decomposer.plane);
    decomposer.set_view(window, farthest);
    for (index, primitive) in scene.iter().enumerate() {
        if !primitive.material.target {
            decomposer.add(index, &primitive.shape);
        }
    }
    let Decomposer {
        plane, surfaces, ..
    } = decomposer;
    let (red, others) = surfaces.split_at(red);
    let mut occluders = others
        .iter()
        .filter(|surface| {
            let part = surface.window.overlap(&window);
            !part.is_empty() && surface.nearest_in(&part, &plane) > farthest
        })
        .peekable();
    match red {
        [surface] if occluders.peek().is_none() => lone(surface, &plane),
        _ => drawn(red, occluders, window, &plane),
    }
}

fn targets(scene: &[Primitive]) -> impl Iterator<Item = (usize, &Primitive)> {
    scene
        .iter()
        .enumerate()
        .filter(|(_, primitive)| primitive.material.target)
}

/// A bound below the inverse depths of what is seen of the surfaces, by far more than rounding.
fn farthest(surfaces: &[VisibleSurface], plane: &ImagePlane) -> f64 {
    const MARGIN: f64 = 1e-3;
    surfaces
        .iter()
        .map(|surface| (1.0 - MARGIN) * surface.farthest(plane))
        .fold(f64::INFINITY, f64::min)
}

/// Pixels of a surface that nothing hides: a ball's rows in closed form.
fn lone(surface: &VisibleSurface, plane: &ImagePlane) -> Option<RedRegion> {
    if !matches!(surface.kind, SurfaceKind::Ball(..)) {
        return drawn(
            std::slice::from_ref(surface),
            [].iter(),
            surface.window,
            plane,
        );
    }
    let mut pixels = Pixels::default();
    surface.rows(&surface.window, plane, |j, columns| pixels.add(columns, j));
    pixels.region()
}

/// Pixels by drawing the window, in the order of the scene: of two surfaces at the same depth, the
/// earlier one is seen.
fn drawn<'a>(
    red: &'a [VisibleSurface],
    others: impl Iterator<Item = &'a VisibleSurface>,
    window: Window,
    plane: &ImagePlane,
) -> Option<RedRegion> {
    let mut surfaces: Vec<_> = red.iter().map(|surface| (0, surface)).collect();
    surfaces.extend(others.map(|surface| (1, surface)));
    surfaces.sort_by_key(|(_, surface)| surface.primitive);
    let mut buffer = DepthBuffer::new(window);
    for (id, surface) in surfaces {
        buffer.draw(id, surface, plane);
    }
    let mut pixels = Pixels::default();
    for j in window.rows.0..window.rows.1 {
        let (row, _) = buffer.span(j, window.columns);
        // Selected, not branched on, so that the loop runs in vectors.
        let (mut count, mut sum) = (0_u32, 0_u32);
        for (k, id) in (0_u32..).zip(row.iter()) {
            count += u32::from(*id == 0);
            sum += if *id == 0 { k } else { 0 };
        }
        pixels.add_row([count, sum].map(f64::from), window.columns.0, j);
    }
    pixels.region()
}
