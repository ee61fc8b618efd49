//! Solids that links are made of.

use nalgebra::Vector3;
use serde::Serialize;

/// A solid in the frame of its link \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "shape", rename_all = "snake_case")]
pub enum Solid {
    /// A capsule from `a` to `b`.
    Capsule {
        /// One end of its axis.
        a: Vector3<f64>,
        /// The other end.
        b: Vector3<f64>,
        /// Its radius.
        radius: f64,
    },
    /// A box along the axes.
    Cuboid {
        /// Its centre.
        centre: Vector3<f64>,
        /// Half its edges.
        half: Vector3<f64>,
    },
}

impl Solid {
    /// Its projection into the plane of motion.
    pub(crate) fn projected(&self) -> Self {
        let level = |v: &Vector3<f64>| Vector3::new(v.x, v.y, 0.0);
        match self {
            Self::Capsule { a, b, radius } => Self::Capsule {
                a: level(a),
                b: level(b),
                radius: *radius,
            },
            Self::Cuboid { centre, half } => Self::Cuboid {
                centre: level(centre),
                half: *half,
            },
        }
    }

    /// The box along the axes that holds it.
    pub(crate) fn bounds(&self) -> Bounds {
        match self {
            Self::Capsule { a, b, radius } => {
                let around = Vector3::repeat(*radius);
                Bounds {
                    low: a.inf(b) - around,
                    high: a.sup(b) + around,
                }
            }
            Self::Cuboid { centre, half } => Bounds {
                low: centre - half,
                high: centre + half,
            },
        }
    }

    /// Signed distance from its surface to a point of its link's frame \[m\]; negative inside.
    pub(crate) fn distance(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Capsule { a, b, radius } => {
                let along = b - a;
                let share = (along.dot(&(point - a)) / along.norm_squared()).clamp(0.0, 1.0);
                (point - a - along * share).norm() - radius
            }
            Self::Cuboid { centre, half } => {
                let beyond = (point - centre).abs() - half;
                let inside = beyond.max().min(0.0);
                beyond.map(|x| x.max(0.0)).norm() + inside
            }
        }
    }
}

/// A box along the axes of a link's frame \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    /// Its lowest corner.
    pub(crate) low: Vector3<f64>,
    /// Its highest corner.
    pub(crate) high: Vector3<f64>,
}

impl Bounds {
    /// Whether a point is further than a distance from the box along one of the axes.
    pub(crate) fn are_beyond(&self, point: &Vector3<f64>, distance: f64) -> bool {
        (0..3).any(|k| point[k] < self.low[k] - distance || point[k] > self.high[k] + distance)
    }
}
