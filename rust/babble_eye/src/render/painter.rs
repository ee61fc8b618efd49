//! Draws a scene lit and coloured, some rows at a time.

use super::checker::Checker;
use super::light::{Light, SHADOW, pigment};
use super::pixel_format::{LANES, PixelFormat};
use super::shading::SmoothShading;
use super::shadow::{Shadow, cast};
use super::swatch::{Swatch, swatch};
use crate::camera::Pinhole;
use crate::raster::decompose::{Decomposer, decompose};
use crate::raster::depth_buffer::DepthBuffer;
use crate::raster::image_plane::ImagePlane;
use crate::raster::surface::SurfaceKind;
use crate::raster::visible_surface::VisibleSurface;
use crate::raster::window::Window;
use crate::scene::{Primitive, Shape};

/// How a surface is coloured.
enum Paint {
    Even(Swatch),
    SmoothShading(SmoothShading),
    Checker(Checker),
}

/// Shadows on a surface of ground: ids of its lit and of its dark paint.
struct ShadowedGround {
    lit: u32,
    dark: u32,
    shadows: Vec<Shadow>,
}

/// Draws a picture, or a window of one, band by band.
pub(crate) struct Painter {
    light: Light,
    plane: ImagePlane,
    surfaces: Vec<VisibleSurface>,
    /// One of each surface, then one of each shadowed ground.
    paints: Vec<Paint>,
    shades: Vec<ShadowedGround>,
    buffer: DepthBuffer,
}

impl Painter {
    /// Prepares a window of the picture, or without one all of it.
    pub(crate) fn new(scene: &[Primitive], camera: &Pinhole, view: Option<Window>) -> Self {
        let decomposer = decompose(scene, camera, view);
        let light = Light::new(&camera.rotation);
        let mut paints: Vec<Paint> = decomposer
            .surfaces
            .iter()
            .map(|surface| paint(surface, &scene[surface.primitive], &light, 1.0))
            .collect();
        let mut shades = Vec::new();
        for (lit, surface) in (0..).zip(&decomposer.surfaces) {
            let primitive = &scene[surface.primitive];
            if let Shape::Ground { height, .. } = primitive.shape {
                shades.push(ShadowedGround {
                    lit,
                    dark: paints.len() as u32,
                    shadows: cast(scene, height, &decomposer),
                });
                paints.push(paint(surface, primitive, &light, SHADOW));
            }
        }
        let Decomposer {
            plane, surfaces, ..
        } = decomposer;
        let window = Window {
            rows: (0, 0),
            ..view.unwrap_or(Window::frame(&plane))
        };
        Self {
            light,
            plane,
            surfaces,
            paints,
            shades,
            buffer: DepthBuffer::new(window),
        }
    }

    /// Paints whole rows from `first` on.
    pub(crate) fn paint<I: PixelFormat>(&mut self, first: usize, rows: &mut [I]) {
        let length = self.buffer.window.width();
        let end = first + rows.len() / length;
        self.buffer.move_to((first, end));
        for (id, surface) in (0..).zip(&self.surfaces) {
            self.buffer.draw(id, surface, &self.plane);
        }
        for shade in &self.shades {
            for shadow in &shade.shadows {
                shadow.draw(&mut self.buffer, shade.lit, shade.dark, &self.plane);
            }
        }
        for (k, j) in (first..end).enumerate() {
            self.paint_row(j, &mut rows[k * length..]);
        }
    }

    /// Paints row j into the first pixels. Some of the next row may be painted too, before its turn.
    fn paint_row<I: PixelFormat>(&mut self, j: usize, pixels: &mut [I]) {
        let (left, right) = self.buffer.window.columns;
        let y = self.plane.y(j);
        let (surfaces, depths) = self.buffer.span(j, (left, right + LANES));
        let surfaces = &surfaces[..right - left];
        let mut first = 0;
        while first < surfaces.len() {
            let next = first + run_length(&surfaces[first..]);
            let (run, column) = (first..next, left + first);
            match self.paints.get(surfaces[first] as usize) {
                None => I::fill(&mut pixels[run], &self.light.sky(y)),
                Some(Paint::Even(swatch)) => I::fill(&mut pixels[run], swatch),
                Some(Paint::Checker(checker)) => {
                    checker.paint(&mut pixels[run], column, left + next, y, &self.plane);
                }
                Some(Paint::SmoothShading(shaded)) => {
                    let (depths, _) = depths[first..].as_chunks();
                    let depths = &depths[..(next - first).div_ceil(LANES)];
                    shaded.paint(&mut pixels[first..], depths, (column, j));
                }
            }
            first = next;
        }
    }
}

fn paint(surface: &VisibleSurface, primitive: &Primitive, light: &Light, brightness: f32) -> Paint {
    let colour = pigment(primitive.material);
    match (&surface.kind, &primitive.shape) {
        (SurfaceKind::Ball(quadric, _) | SurfaceKind::Side(quadric, _), _) => Paint::SmoothShading(
            SmoothShading::new(quadric, primitive.material, light, surface.origin),
        ),
        (
            SurfaceKind::Rectangle(flat),
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
        (SurfaceKind::Rectangle(flat) | SurfaceKind::Ellipse(flat), _) => {
            Paint::Even(swatch(colour, light.on_flat(&flat.normal)))
        }
    }
}

/// How many pixels from the first on show the same surface.
#[inline]
fn run_length(surfaces: &[u32]) -> usize {
    // Most runs are short, but some are as long as the row.
    const SHORT: usize = 16;
    let id = surfaces[0];
    let mut length = blocks_of::<LANES>(id, &surfaces[..surfaces.len().min(SHORT)]);
    if length == SHORT {
        length += blocks_of::<{ 2 * SHORT }>(id, &surfaces[length..]);
        length += blocks_of::<LANES>(id, &surfaces[length..]);
    }
    length + blocks_of::<1>(id, &surfaces[length..])
}

/// How many pixels from the first on show a surface, in whole blocks of N.
#[inline]
fn blocks_of<const N: usize>(id: u32, surfaces: &[u32]) -> usize {
    let same = |block: &&[u32; N]| block.iter().fold(0, |all, seen| all | (seen ^ id)) == 0;
    N * surfaces.as_chunks().0.iter().take_while(same).count()
}
