//! Shading of round surfaces: balls and the sides of cylinders.

use nalgebra::Vector3;

use super::light::{EVEN, GLOSS, KEY, Light, SKY, pigment, positive};
use super::pixel_format::{LANES, PixelFormat};
use crate::raster::image_plane::offset;
use crate::raster::inverse_depth::LinearForm;
use crate::raster::origin::Origin;
use crate::raster::surface::Quadric;
use crate::scene::Material;

/// c cos + e, with the cosine of the normal of a quadric with a fixed direction.
/// At the point d / w it is (along · d) / w − offset.
#[derive(Debug, Clone)]
struct CosineTerm {
    along: LinearForm,
    offset: f32,
}

impl CosineTerm {
    fn new(quadric: &Quadric, origin: &Origin, direction: &Vector3<f64>, [c, e]: [f32; 2]) -> Self {
        let along = quadric.across * direction * (f64::from(c) / quadric.radius);
        Self {
            offset: (along.dot(&quadric.centre) - f64::from(e)) as f32,
            along: LinearForm::new(&origin.linear(&along)),
        }
    }

    /// Its values along row y at columns x and depths.
    #[inline]
    fn row(&self, y: f32) -> impl Fn(f32, f32) -> f32 + use<> {
        let (along, offset) = (self.along.row(y), self.offset);
        move |x, depth| along(x) * depth - offset
    }
}

/// Light on a ball or on the side of a cylinder.
#[derive(Debug, Clone)]
pub(crate) struct SmoothShading {
    colour: [f32; 3],
    gloss: f32,
    origin: Origin,
    /// Brightness by the key light, brightness by all else, and the cosine with
    /// the highlight's direction.
    terms: [CosineTerm; 3],
}

impl SmoothShading {
    pub(crate) fn new(
        quadric: &Quadric,
        material: Material,
        light: &Light,
        origin: Origin,
    ) -> Self {
        // One direction to the camera for the whole surface: that of its middle.
        let to_camera = -(quadric.across * quadric.centre).normalize();
        let halfway = (light.towards_key + to_camera).normalize();
        let term = |direction, factors| CosineTerm::new(quadric, &origin, direction, factors);
        Self {
            colour: pigment(material),
            gloss: GLOSS[usize::from(!material.target)],
            terms: [
                term(&light.towards_key, [KEY, 0.0]),
                term(&light.up, [0.5 * SKY, EVEN]),
                term(&halfway, [1.0, 0.0]),
            ],
            origin,
        }
    }

    /// Paints pixels of row j from column `first` on: as many as there are inverse depths, or all. A
    /// pixel's colour does not depend on the run that it is in.
    pub(crate) fn paint<I: PixelFormat>(
        &self,
        pixels: &mut [I],
        inverse_depths: &[[f32; LANES]],
        (first, j): (usize, usize),
    ) {
        let y = offset(j, self.origin.row);
        let mut x = offset(first, self.origin.column);
        let terms = self.terms.each_ref().map(|term| term.row(y));
        let (blocks, rest) = pixels.as_chunks_mut();
        let last = inverse_depths.get(blocks.len());
        for (pixels, inverse_depths) in blocks.iter_mut().zip(inverse_depths) {
            *pixels = self.block(&terms, x, inverse_depths);
            x += LANES as f32;
        }
        if let Some(inverse_depths) = last {
            let painted: [I; LANES] = self.block(&terms, x, inverse_depths);
            for (pixel, painted) in rest.iter_mut().zip(painted) {
                *pixel = painted;
            }
        }
    }

    /// Pixels from column x on, with the inverse depths there.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "in a call, vectors go through memory")]
    fn block<I: PixelFormat>(
        &self,
        terms: &[impl Fn(f32, f32) -> f32; 3],
        x: f32,
        inverse_depths: &[f32; LANES],
    ) -> [I; LANES] {
        let x: [f32; LANES] = std::array::from_fn(|k| x + k as f32);
        let depth = inverse_depths.map(|w| 1.0 / w);
        let [key, sky, halfway] = terms
            .each_ref()
            .map(|term| std::array::from_fn::<_, LANES, _>(|k| term(x[k], depth[k])));
        let brightness = std::array::from_fn(|k| sky[k] + positive(key[k]));
        let highlight = halfway.map(|cosine| self.highlight(cosine));
        I::blend(self.colour, brightness, highlight)
    }

    fn highlight(&self, cosine: f32) -> f32 {
        let h2 = positive(cosine) * positive(cosine);
        let h4 = h2 * h2;
        let h8 = h4 * h4;
        let h16 = h8 * h8;
        self.gloss * h16 * h8
    }
}
