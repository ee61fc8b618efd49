//! Surfaces that each have a closed form along a row of pixels, in the camera
//! frame: ball, cylinder side, rectangle and ellipse.

use nalgebra::{Matrix3, Vector3};

use super::inverse_depth::{CylinderDepth, InverseDepth, QuadricDepth};
use super::origin::Origin;
use super::outline::{Cone, Edges, Outline};

/// A ball or the side of a cylinder. Its inverse depth is
/// w = l · d + √((l · d)² − dᵀ Q d), the nearer of the two intersections.
#[derive(Debug, Clone)]
pub(crate) struct Quadric {
    /// l
    linear: Vector3<f64>,
    /// Square of the camera's distance, across the axis, to where its lines of
    /// sight touch the surface \[m²\].
    power: f64,
    /// Centre of the ball, or a point on the axis, in the camera frame \[m\].
    pub(crate) centre: Vector3<f64>,
    /// Identity for a ball; projection along the axis for a cylinder.
    pub(crate) across: Matrix3<f64>,
    pub(crate) radius: f64,
}

impl Quadric {
    /// `None` if the camera is inside.
    pub(crate) fn new(centre: Vector3<f64>, across: Matrix3<f64>, radius: f64) -> Option<Self> {
        let nearest = across * centre;
        let power = nearest.norm_squared() - radius * radius;
        (power > 0.0).then(|| Self {
            linear: nearest / power,
            power,
            centre,
            across,
            radius,
        })
    }

    /// Linear forms of d below and above its inverse depth: the plane through
    /// its outline, and the plane across the line of sight that touches it.
    pub(crate) fn bounds(&self) -> [Vector3<f64>; 2] {
        let nearest = self.across * self.centre;
        let distance = nearest.norm();
        let touching = nearest / (distance * (distance - self.radius));
        [self.linear, touching]
    }

    /// l and the matrix l lᵀ − Q of D = (l · d)² − dᵀ Q d at an origin.
    fn at(&self, origin: &Origin) -> (Vector3<f64>, Matrix3<f64>) {
        let square = self.linear * self.linear.transpose() - self.across / self.power;
        (origin.linear(&self.linear), origin.quadratic(&square))
    }

    /// Edges of the image of a cylinder's side: its two outlines, which are
    /// straight, and planes before its ends.
    fn side_edges(&self, ends: &Ends) -> [Vector3<f64>; 4] {
        let bounds = self.bounds();
        let nearest = self.across * self.centre;
        // The tangents from the camera to the circle, in units of its distance.
        let sideways = ends.along.cross(&nearest) * (self.power.sqrt() / ends.along.norm());
        let forwards = nearest * self.radius;
        [
            forwards + sideways,
            forwards - sideways,
            beyond(ends.along, ends.start, bounds),
            beyond(-ends.along, -(ends.start + 1.0), bounds),
        ]
    }

    /// Edge of the image of the half of a ball on the side of the unit vector
    /// `outward`. It lets some more be seen, so that no gap opens at the seam
    /// of two surfaces.
    fn half_edge(&self, outward: &Vector3<f64>) -> Vector3<f64> {
        const SEAM: f64 = 1e-5;
        let [below, above] = self.bounds();
        let start = outward.dot(&self.centre);
        let slack = above * (SEAM * self.centre.norm());
        beyond(*outward, start, [below, above]) + slack
    }
}

/// A form that is ≥ 0 where along · d ≥ start w for a w between two bounds.
fn beyond(along: Vector3<f64>, start: f64, [below, above]: [Vector3<f64>; 2]) -> Vector3<f64> {
    let least = if start > 0.0 { below } else { above };
    along - least * start
}

/// Where a cylinder's side ends: 0 ≤ along · d − start w ≤ w.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    pub(crate) along: Vector3<f64>,
    pub(crate) start: f64,
}

/// A flat surface with inverse depth w · d and two coordinates (u · d) / (w · d)
/// and (v · d) / (w · d), which are ±1 at its edges.
#[derive(Debug, Clone)]
pub(crate) struct FlatSurface {
    pub(crate) w: Vector3<f64>,
    pub(crate) u: Vector3<f64>,
    pub(crate) v: Vector3<f64>,
    /// Unit normal towards the camera, in the camera frame.
    pub(crate) normal: Vector3<f64>,
}

impl FlatSurface {
    /// The parallelogram or ellipse with the given centre and half axes in the
    /// camera frame; `None` if its front, the side of `outward`, is hidden.
    pub(crate) fn new(
        centre: Vector3<f64>,
        [a, b]: [Vector3<f64>; 2],
        outward: Vector3<f64>,
    ) -> Option<Self> {
        let distance = outward.dot(&centre);
        let normal = a.cross(&b);
        let area = normal.norm_squared();
        if distance >= 0.0 || area == 0.0 {
            return None;
        }
        let w = outward / distance;
        // Reciprocal vectors of the half axes within the plane.
        let (a_dual, b_dual) = (b.cross(&normal) / area, normal.cross(&a) / area);
        Some(Self {
            w,
            u: a_dual - w * a_dual.dot(&centre),
            v: b_dual - w * b_dual.dot(&centre),
            normal: outward,
        })
    }

    /// The ellipse u² + v² ≤ w².
    pub(crate) fn ellipse(&self, origin: &Origin) -> Outline {
        let form = self.u * self.u.transpose() + self.v * self.v.transpose();
        let square = self.w * self.w.transpose() - form;
        Outline::Round(Cone::new(origin.linear(&self.w), origin.quadratic(&square)))
    }

    fn depth(&self, origin: &Origin) -> InverseDepth {
        InverseDepth::flat(&origin.linear(&self.w))
    }

    /// The parallelogram |u| ≤ w, |v| ≤ w.
    pub(crate) fn parallelogram(&self, origin: &Origin) -> Outline {
        let Self { w, u, v, .. } = self;
        straight([w - u, w + u, w - v, w + v], origin)
    }
}

/// A surface in the camera frame.
#[derive(Debug, Clone)]
pub(crate) enum SurfaceKind {
    /// A ball, or its half on the side of a unit vector, which ends a capsule.
    Ball(Quadric, Option<Vector3<f64>>),
    Side(Quadric, Ends),
    Rectangle(FlatSurface),
    Ellipse(FlatSurface),
}

impl SurfaceKind {
    /// Where it is seen and its inverse depth, in columns and rows from an origin.
    pub(crate) fn forms(&self, origin: &Origin) -> (Outline, InverseDepth) {
        match self {
            Self::Ball(ball, half) => {
                let (linear, square) = ball.at(origin);
                let cone = Cone::new(linear, square);
                let outline = match half {
                    Some(outward) => {
                        let edge = origin.linear(&ball.half_edge(outward));
                        Outline::Half(cone, Edges::new([edge]))
                    }
                    None => Outline::Round(cone),
                };
                (
                    outline,
                    InverseDepth::Ball(QuadricDepth::new(&linear, &square)),
                )
            }
            Self::Side(side, ends) => {
                let (linear, square) = side.at(origin);
                let square = QuadricDepth::new(&linear, &square);
                let along = origin.linear(&ends.along);
                let depth = InverseDepth::Side(CylinderDepth::new(square, &along, ends.start));
                (straight(side.side_edges(ends), origin), depth)
            }
            Self::Rectangle(flat) => (flat.parallelogram(origin), flat.depth(origin)),
            Self::Ellipse(flat) => (flat.ellipse(origin), flat.depth(origin)),
        }
    }

    /// A linear form above its inverse depth.
    pub(crate) fn above(&self) -> Vector3<f64> {
        match self {
            Self::Rectangle(flat) | Self::Ellipse(flat) => flat.w,
            Self::Ball(quadric, _) | Self::Side(quadric, _) => quadric.bounds()[1],
        }
    }

    /// A linear form below its inverse depth.
    pub(crate) fn below(&self) -> Vector3<f64> {
        match self {
            Self::Rectangle(flat) | Self::Ellipse(flat) => flat.w,
            Self::Ball(quadric, _) | Self::Side(quadric, _) => quadric.bounds()[0],
        }
    }
}

fn straight(forms: [Vector3<f64>; 4], origin: &Origin) -> Outline {
    Outline::Straight(Edges::new(forms.each_ref().map(|form| origin.linear(form))))
}
