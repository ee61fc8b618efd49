//! What the eye can see: solid shapes, each with a material.

use nalgebra::{Matrix3, Vector3};

/// A visible shape in world coordinates \[m\]. Solids are seen from outside
/// only: one that holds the camera is invisible.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Centre \[m\].
        centre: Vector3<f64>,
        /// Radius \[m\].
        radius: f64,
    },
    /// A cylinder with round ends: all points within `radius` of the segment.
    Capsule {
        /// One end of the segment \[m\].
        a: Vector3<f64>,
        /// The other end of the segment \[m\].
        b: Vector3<f64>,
        /// Radius \[m\].
        radius: f64,
    },
    /// A solid cylinder with flat ends.
    Cylinder {
        /// Centre of one end \[m\].
        a: Vector3<f64>,
        /// Centre of the other end \[m\].
        b: Vector3<f64>,
        /// Radius \[m\].
        radius: f64,
    },
    /// A box.
    Cuboid {
        /// Centre \[m\].
        centre: Vector3<f64>,
        /// Columns: the box's axes in world coordinates.
        rotation: Matrix3<f64>,
        /// Half the edges along those axes \[m\].
        half_extents: Vector3<f64>,
    },
    /// A horizontal, checkered rectangle, seen from above. Shadows fall on it; a solid that reaches
    /// through it casts that of its part below, too.
    Ground {
        /// Height of the plane \[m\].
        height: f64,
        /// Middle of the rectangle (x, y) \[m\].
        centre: [f64; 2],
        /// Half the edges along x and y \[m\].
        half_extents: [f64; 2],
        /// Edge of a square of the checker \[m\].
        cell: f64,
    },
}

/// How a shape looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Material {
    /// Colour under full light (red, green, blue).
    pub colour: [u8; 3],
    /// Whether its pixels are the red ones of Eq. 1. A target is painted
    /// red whatever its colour; nothing else is.
    pub target: bool,
}

impl Material {
    /// The red of a target.
    pub const TARGET: Self = Self {
        colour: [226, 38, 34],
        target: true,
    };

    /// A material that is no target.
    #[must_use]
    pub const fn plain(colour: [u8; 3]) -> Self {
        Self {
            colour,
            target: false,
        }
    }
}

/// A shape and its material. A scene is a slice of these; where two surfaces
/// lie at the same depth to the last bit, the earlier one is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Primitive {
    /// Form and place.
    pub shape: Shape,
    /// Look.
    pub material: Material,
}

impl Primitive {
    /// A shape with its material.
    #[must_use]
    pub const fn new(shape: Shape, material: Material) -> Self {
        Self { shape, material }
    }

    /// A ball that the reflex of Eq. 1 looks for.
    #[must_use]
    pub const fn target(centre: Vector3<f64>, radius: f64) -> Self {
        Self::new(Shape::Sphere { centre, radius }, Material::TARGET)
    }
}
