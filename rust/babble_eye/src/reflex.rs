//! The reflex that turns the eye to the red object, Eq. 1:
//!
//! Δpt = (120° / 630) (E − O)
//!
//! with E the middle of the image and O the centroid of the red pixels, both
//! \[pixel\]. A central pixel of a pinhole image spans 0.315°, so one step
//! takes away 0.605 of a small error.

use crate::centroid::red_centroid;
use crate::error::EyeError;
use crate::gaze::{Eye, Gaze};
use crate::scene::Primitive;

/// The reflex rests once a step turns pan and tilt by less than this \[rad\]:
/// 0.02°, a tenth of a pixel of offset, about what counting pixels resolves.
const RESTING_STEP: f64 = 3.5e-4;

/// Steps after which the reflex rests in any case.
const STEPS: usize = 100;

impl Eye {
    /// One step of Eq. 1, clipped to the ranges; `None` if no red is seen.
    #[must_use]
    pub fn reflex_step(&self, scene: &[Primitive], gaze: Gaze) -> Option<Gaze> {
        let [x, y] = red_centroid(scene, &self.camera(gaze))?;
        let middle = 0.5 * self.config().pixels as f64;
        let per_pixel = self.config().field_deg.to_radians() / self.config().pixels as f64;
        // Rows count downwards, tilt upwards.
        Some(self.clipped(Gaze {
            pan: gaze.pan + per_pixel * (x - middle),
            tilt: gaze.tilt + per_pixel * (middle - y),
        }))
    }

    /// The gaze at which the reflex of Eq. 1 comes to rest. It begins at the start gaze or, if no red
    /// is seen from there, at the first gaze of a short list that sees red.
    ///
    /// It rests when a step is below 0.02°, when it is back where it was two steps ago, or after 100
    /// steps. If the target lies outside of the ranges, it rests at their edge.
    ///
    /// # Errors
    /// [`EyeError::TargetNotSeen`] if all of those images have no red pixel.
    pub fn foveate(&self, scene: &[Primitive], start: Gaze) -> Result<Gaze, EyeError> {
        let start = self.clipped(start);
        std::iter::once(start)
            .chain(self.search_gazes())
            .find_map(|gaze| self.settle(scene, gaze))
            .ok_or(EyeError::TargetNotSeen {
                searched: self.search_gazes().count(),
            })
    }

    /// Repeats the reflex until it rests; `None` if the red gets out of sight.
    fn settle(&self, scene: &[Primitive], start: Gaze) -> Option<Gaze> {
        let mut before = start;
        let mut gaze = start;
        for _ in 0..STEPS {
            let next = self.reflex_step(scene, gaze)?;
            if step(gaze, next) < RESTING_STEP || next == before {
                return Some(next);
            }
            before = gaze;
            gaze = next;
        }
        Some(gaze)
    }
}

/// The larger of the two turns.
fn step(from: Gaze, to: Gaze) -> f64 {
    (to.pan - from.pan).abs().max((to.tilt - from.tilt).abs())
}
