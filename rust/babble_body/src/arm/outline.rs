//! The arm's outline: straight segments in the plane of motion.

use nalgebra::Vector2;

/// Points closer than this are one point.
pub(super) const TOLERANCE_M: f64 = 1e-9;

/// A straight segment of the arm's outline in the plane of motion, in the frame of its link \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Near end.
    pub a: Vector2<f64>,
    /// Far end.
    pub b: Vector2<f64>,
}

impl Segment {
    /// Squared distance to a point \[m²\].
    pub(super) fn distance_squared(&self, point: Vector2<f64>) -> f64 {
        let along = self.b - self.a;
        let to_point = point - self.a;
        let share = (to_point.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (to_point - along * share).norm_squared()
    }
}

/// Joins segments that lie on one line and touch; the stretched arm becomes one segment a link.
pub(super) fn merge(mut segments: Vec<Segment>) -> Vec<Segment> {
    let mut merged: Vec<Segment> = Vec::new();
    while let Some(mut segment) = segments.pop() {
        while let Some(i) = segments
            .iter()
            .position(|other| union(&segment, other).is_some())
        {
            let other = segments.swap_remove(i);
            segment = union(&segment, &other).unwrap_or(segment);
        }
        merged.push(segment);
    }
    merged
}

/// The segment that covers both, if they are collinear and touch.
fn union(s: &Segment, t: &Segment) -> Option<Segment> {
    let direction = (s.b - s.a).normalize();
    let off_line = |p: Vector2<f64>| direction.perp(&(p - s.a)).abs() > TOLERANCE_M;
    if off_line(t.a) || off_line(t.b) {
        return None;
    }
    let at = |p: Vector2<f64>| direction.dot(&(p - s.a));
    let (s_low, s_high) = (0.0, at(s.b));
    let (t_low, t_high) = (at(t.a).min(at(t.b)), at(t.a).max(at(t.b)));
    if t_low > s_high + TOLERANCE_M || t_high < s_low - TOLERANCE_M {
        return None;
    }
    Some(Segment {
        a: s.a + direction * s_low.min(t_low),
        b: s.a + direction * s_high.max(t_high),
    })
}
