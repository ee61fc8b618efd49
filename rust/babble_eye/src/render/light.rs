//! Light and colour: how bright a surface is, and which colours are red.

use nalgebra::{Matrix3, Vector3};

use super::swatch::{Swatch, swatch};
use crate::scene::Material;

/// Direction towards the key light, in world coordinates: from behind the body, left and above.
pub const TOWARDS_KEY: [f64; 3] = [-0.22, -0.42, 0.88];

/// Light on a surface in the dark, turned downwards.
const AMBIENT: f32 = 0.42;
/// What a surface that faces upwards gets from the sky above that.
pub(super) const SKY: f32 = 0.20;
/// What a surface that faces the key light gets above that.
pub(super) const KEY: f32 = 0.50;
/// What all surfaces get: that of one that the sky is beside.
pub(super) const EVEN: f32 = AMBIENT + 0.5 * SKY;
/// Highlight of a target and of everything else, in levels of 255.
pub(super) const GLOSS: [f32; 2] = [28.0, 40.0];
/// Brightness of the ground in a shadow.
pub(crate) const SHADOW: f32 = 0.86;

/// Whether a rendered pixel is red in the sense of Eq. 1. Pixels of targets
/// are, and no others.
#[must_use]
pub fn is_red([red, green, blue]: [u8; 3]) -> bool {
    let twice = 2 * u16::from(green.max(blue));
    red >= 60 && u16::from(red) >= twice
}

/// The colour a material is painted with: targets clearly red, others clearly not.
pub(crate) fn pigment(material: Material) -> [f32; 3] {
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

/// The light in the camera frame.
#[derive(Debug, Clone)]
pub(crate) struct Light {
    pub(super) towards_key: Vector3<f64>,
    pub(super) up: Vector3<f64>,
}

impl Light {
    pub(crate) fn new(camera_from_world: &Matrix3<f64>) -> Self {
        Self {
            towards_key: camera_from_world * Vector3::from(TOWARDS_KEY).normalize(),
            up: camera_from_world.column(2).into_owned(),
        }
    }

    /// The background of row Y: that in the direction of its middle.
    pub(crate) fn sky(&self, y: f64) -> Swatch {
        let sine = (self.up.y * y + self.up.z) / (y * y + 1.0).sqrt();
        swatch(background(sine), 1.0)
    }

    /// Brightness of a flat surface with the given unit normal.
    pub(crate) fn on_flat(&self, normal: &Vector3<f64>) -> f32 {
        let facing = |direction: &Vector3<f64>| normal.dot(direction) as f32;
        brightness(facing(&self.towards_key), facing(&self.up))
    }
}

/// Brightness from the cosines of the normal with the key light and the vertical.
fn brightness(key: f32, up: f32) -> f32 {
    EVEN + 0.5 * SKY * up + KEY * positive(key)
}

pub(super) fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
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
