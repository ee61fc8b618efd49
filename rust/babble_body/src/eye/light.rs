//! Light and colour: how bright a surface is, and which colours are red.

use nalgebra::{Matrix3, Vector3};

use super::Material;
use super::piece::Quadric;

/// Direction towards the key light, in world coordinates: from behind the body, left and above.
pub const TOWARDS_KEY: [f64; 3] = [-0.22, -0.42, 0.88];

/// Light on a surface in the dark, turned downwards.
const AMBIENT: f32 = 0.42;
/// What a surface that faces upwards gets from the sky above that.
const SKY: f32 = 0.20;
/// What a surface that faces the key light gets above that.
const KEY: f32 = 0.50;
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

    /// Brightness of a flat surface with the given unit normal.
    pub(super) fn on_flat(&self, normal: &Vector3<f64>) -> f32 {
        let facing = |direction: &Vector3<f64>| normal.dot(direction) as f32;
        brightness(facing(&self.towards_key), facing(&self.up))
    }
}

/// Brightness from the cosines of the normal with the key light and the vertical.
fn brightness(key: f32, up: f32) -> f32 {
    AMBIENT + SKY * (0.5 + 0.5 * up) + KEY * positive(key)
}

fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// The cosine of the normal of a quadric with a fixed direction, which at the
/// point d / w is (along · d) / w − offset.
#[derive(Debug, Clone)]
pub(super) struct Cosine {
    pub(super) along: Vector3<f64>,
    pub(super) offset: f32,
}

impl Cosine {
    fn new(quadric: &Quadric, direction: &Vector3<f64>) -> Self {
        let along = quadric.across * direction / quadric.radius;
        Self {
            offset: along.dot(&quadric.centre) as f32,
            along,
        }
    }
}

/// Light on a ball or on the side of a cylinder.
#[derive(Debug, Clone)]
pub(super) struct Shaded {
    pub(super) colour: [f32; 3],
    gloss: f32,
    /// With the key light, the vertical and the highlight's direction.
    pub(super) cosines: [Cosine; 3],
}

impl Shaded {
    pub(super) fn new(quadric: &Quadric, material: Material, light: &Light) -> Self {
        // One direction to the camera for the whole surface: that of its middle.
        let to_camera = -(quadric.across * quadric.centre).normalize();
        let halfway = (light.towards_key + to_camera).normalize();
        Self {
            colour: pigment(material),
            gloss: GLOSS[usize::from(!material.target)],
            cosines: [&light.towards_key, &light.up, &halfway]
                .map(|direction| Cosine::new(quadric, direction)),
        }
    }

    /// Brightness and highlight for the cosines of a point.
    pub(super) fn at(&self, [key, up, halfway]: [f32; 3]) -> [f32; 2] {
        let h2 = positive(halfway) * positive(halfway);
        let h4 = h2 * h2;
        let h8 = h4 * h4;
        let h16 = h8 * h8;
        [brightness(key, up), self.gloss * h16 * h8]
    }
}

/// Colour of the background in a direction with the given sine of elevation.
pub(super) fn background(sine: f64) -> [f32; 3] {
    const HORIZON: [f32; 3] = [238.0, 240.0, 242.0];
    const ZENITH: [f32; 3] = [176.0, 200.0, 226.0];
    const NADIR: [f32; 3] = [206.0, 212.0, 219.0];
    let end = if sine > 0.0 { ZENITH } else { NADIR };
    let share = sine.abs() as f32;
    std::array::from_fn(|k| HORIZON[k] + share * (end[k] - HORIZON[k]))
}
