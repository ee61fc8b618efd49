//! Light and colour: how bright a surface is, and which colours are red.

use nalgebra::{Matrix3, Vector3};

use super::Material;
use super::depth::Linear;
use super::ink::{Ink, LANES};
use super::row::{Origin, offset};
use super::surface::Quadric;

/// Direction towards the key light, in world coordinates: from behind the body, left and above.
pub const TOWARDS_KEY: [f64; 3] = [-0.22, -0.42, 0.88];

/// Light on a surface in the dark, turned downwards.
const AMBIENT: f32 = 0.42;
/// What a surface that faces upwards gets from the sky above that.
const SKY: f32 = 0.20;
/// What a surface that faces the key light gets above that.
const KEY: f32 = 0.50;
/// What all surfaces get: that of one that the sky is beside.
const EVEN: f32 = AMBIENT + 0.5 * SKY;
/// Highlight of a target and of everything else, in levels of 255.
const GLOSS: [f32; 2] = [28.0, 40.0];
/// Brightness of the ground in a shadow.
pub(super) const SHADOW: f32 = 0.86;

/// Whether a rendered pixel is red in the sense of Eq. 1. Pixels of targets
/// are, and no others.
#[must_use]
pub fn is_red([red, green, blue]: [u8; 3]) -> bool {
    let twice = 2 * u16::from(green.max(blue));
    red >= 60 && u16::from(red) >= twice
}

/// The colour a material is painted with: targets clearly red, others clearly not.
pub(super) fn pigment(material: Material) -> [f32; 3] {
    let [red, green, blue] = material.colour.map(f32::from);
    if material.target {
        let red = red.max(200.0);
        [red, green.min(red / 5.0), blue.min(red / 5.0)]
    } else if green.max(blue) < 0.6 * red {
        [red, 0.6 * red, blue]
    } else {
        [red, green, blue]
    }
}

/// Sixteen pixels of one colour, to fill rows with.
pub(super) type Swatch = [u8; 48];

/// A swatch of a colour at a brightness.
pub(super) fn swatch(colour: [f32; 3], brightness: f32) -> Swatch {
    let [red, green, blue] = colour.map(|level| (level * brightness) as u8);
    std::array::from_fn(|k| [red, green, blue][k % 3])
}

/// Fills whole pixels with a swatch's colour.
pub(super) fn fill(pixels: &mut [u8], swatch: &Swatch) {
    let length = pixels.len();
    if length < swatch.len() {
        pixels.copy_from_slice(&swatch[..length]);
        return;
    }
    for block in pixels.chunks_exact_mut(swatch.len()) {
        block.copy_from_slice(swatch);
    }
    pixels[length - swatch.len()..].copy_from_slice(swatch);
}

/// The light in the camera frame.
#[derive(Debug, Clone)]
pub(super) struct Light {
    towards_key: Vector3<f64>,
    up: Vector3<f64>,
}

impl Light {
    pub(super) fn new(camera_from_world: &Matrix3<f64>) -> Self {
        Self {
            towards_key: camera_from_world * Vector3::from(TOWARDS_KEY).normalize(),
            up: camera_from_world.column(2).into_owned(),
        }
    }

    /// The background of row Y: that in the direction of its middle.
    pub(super) fn sky(&self, y: f64) -> Swatch {
        let sine = (self.up.y * y + self.up.z) / (y * y + 1.0).sqrt();
        swatch(background(sine), 1.0)
    }

    /// Brightness of a flat surface with the given unit normal.
    pub(super) fn on_flat(&self, normal: &Vector3<f64>) -> f32 {
        let facing = |direction: &Vector3<f64>| normal.dot(direction) as f32;
        brightness(facing(&self.towards_key), facing(&self.up))
    }
}

/// Brightness from the cosines of the normal with the key light and the vertical.
fn brightness(key: f32, up: f32) -> f32 {
    EVEN + 0.5 * SKY * up + KEY * positive(key)
}

fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// c cos + e, with the cosine of the normal of a quadric with a fixed direction.
/// At the point d / w it is (along · d) / w − offset.
#[derive(Debug, Clone)]
struct Term {
    along: Linear,
    offset: f32,
}

impl Term {
    fn new(quadric: &Quadric, origin: &Origin, direction: &Vector3<f64>, [c, e]: [f32; 2]) -> Self {
        let along = quadric.across * direction * (f64::from(c) / quadric.radius);
        Self {
            offset: (along.dot(&quadric.centre) - f64::from(e)) as f32,
            along: Linear::new(&origin.linear(&along)),
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
pub(super) struct Shaded {
    colour: [f32; 3],
    gloss: f32,
    origin: Origin,
    /// Brightness by the key light, brightness by all else, and the cosine with
    /// the highlight's direction.
    terms: [Term; 3],
}

impl Shaded {
    pub(super) fn new(
        quadric: &Quadric,
        material: Material,
        light: &Light,
        origin: Origin,
    ) -> Self {
        // One direction to the camera for the whole surface: that of its middle.
        let to_camera = -(quadric.across * quadric.centre).normalize();
        let halfway = (light.towards_key + to_camera).normalize();
        let term = |direction, factors| Term::new(quadric, &origin, direction, factors);
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

    /// Paints a run of pixels of row j from column `first` on. A pixel's colour
    /// does not depend on the run that it is in.
    pub(super) fn paint<I: Ink>(
        &self,
        pixels: &mut [I],
        depths: &[f32],
        (first, j): (usize, usize),
    ) {
        let y = offset(j, self.origin.row);
        let start = offset(first, self.origin.column);
        let terms = self.terms.each_ref().map(|term| term.row(y));
        let mut k = 0;
        while let Some(depths) = depths[k..].first_chunk() {
            pixels[k..k + LANES].copy_from_slice(&self.block(&terms, start + k as f32, depths));
            k += LANES;
        }
        if k == pixels.len() {
            return;
        }
        if let Some(depths) = depths.last_chunk() {
            // Some pixels twice rather than a part of a vector.
            let k = pixels.len() - LANES;
            pixels[k..].copy_from_slice(&self.block(&terms, start + k as f32, depths));
        } else {
            let depths = std::array::from_fn(|k| depths.get(k).copied().unwrap_or(1.0));
            let painted = self.block(&terms, start, &depths);
            for (pixel, painted) in pixels.iter_mut().zip(painted) {
                *pixel = painted;
            }
        }
    }

    /// Pixels from column x on, with the inverse depths there.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "in a call, vectors go through memory")]
    fn block<I: Ink>(
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

/// Colour of the background in a direction with the given sine of elevation.
fn background(sine: f64) -> [f32; 3] {
    const HORIZON: [f32; 3] = [238.0, 240.0, 242.0];
    const ZENITH: [f32; 3] = [176.0, 200.0, 226.0];
    const NADIR: [f32; 3] = [206.0, 212.0, 219.0];
    let end = if sine > 0.0 { ZENITH } else { NADIR };
    let share = sine.abs() as f32;
    std::array::from_fn(|k| HORIZON[k] + share * (end[k] - HORIZON[k]))
}
