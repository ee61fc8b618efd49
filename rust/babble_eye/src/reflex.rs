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

/// The red object is foveated if the centroid is no further than this from the
/// middle of the image, across and down \[pixel\].
const FOVEATED: f64 = 1.0;

/// A gaze at which the reflex rests.
#[derive(Clone, Copy)]
struct Rest {
    gaze: Gaze,
    /// Offset of the centroid before the last step, the larger of the two \[pixel\].
    offset: f64,
}

impl Eye {
    /// One step of Eq. 1, clipped to the ranges; `None` if no red is seen.
    #[must_use]
    pub fn reflex_step(&self, scene: &[Primitive], gaze: Gaze) -> Option<Gaze> {
        let offset = self.offset(scene, gaze)?;
        Some(self.turned(gaze, offset))
    }

    /// Offset O − E of the centroid to the right and down \[pixel\]; `None` if no red is seen.
    fn offset(&self, scene: &[Primitive], gaze: Gaze) -> Option<[f64; 2]> {
        let middle = 0.5 * self.config().pixels as f64;
        let centroid = red_centroid(scene, &self.camera(gaze))?;
        Some(centroid.map(|coordinate| coordinate - middle))
    }

    fn turned(&self, gaze: Gaze, [right, down]: [f64; 2]) -> Gaze {
        let per_pixel = self.config().field_deg.to_radians() / self.config().pixels as f64;
        self.clipped(Gaze {
            pan: gaze.pan + per_pixel * right,
            tilt: gaze.tilt - per_pixel * down,
        })
    }

    /// The gaze at which the reflex of Eq. 1 comes to rest with the red object in the middle of the
    /// image. It begins at the start gaze. If no red is seen from there, or if the reflex rests
    /// elsewhere, it begins again at each gaze of a short list. If it never gets there, this is the
    /// rest that came nearest, such as one at the edge of the ranges.
    ///
    /// The reflex rests when a step is below 0.02°, when it is back where it was two steps ago, or
    /// after 100 steps. It rests off a visible object at the pole of the Fick frame, straight below the
    /// eye: there pan turns the image about its middle, so the nearer the object is to the pole, the
    /// less a step of pan does, and an object right behind the pole is not turned to at all.
    ///
    /// # Errors
    /// [`EyeError::TargetNotSeen`] if no red pixel is seen from the start gaze nor from the list.
    pub fn foveate(&self, scene: &[Primitive], start: Gaze) -> Result<Gaze, EyeError> {
        let mut nearest: Option<Rest> = None;
        let start = self.clipped(start);
        for gaze in std::iter::once(start).chain(self.search_gazes()) {
            let Some(rest) = self.settle(scene, gaze) else {
                continue;
            };
            if nearest.is_none_or(|nearest| rest.offset < nearest.offset) {
                nearest = Some(rest);
            }
            if rest.offset <= FOVEATED {
                break;
            }
        }
        nearest
            .map(|rest| rest.gaze)
            .ok_or_else(|| EyeError::TargetNotSeen {
                searched: self.search_gazes().count(),
            })
    }

    /// Repeats the reflex until it rests; `None` if the red gets out of sight.
    fn settle(&self, scene: &[Primitive], start: Gaze) -> Option<Rest> {
        let [mut before, mut gaze] = [start; 2];
        let mut offset = f64::INFINITY;
        for _ in 0..STEPS {
            let [right, down] = self.offset(scene, gaze)?;
            let next = self.turned(gaze, [right, down]);
            offset = right.abs().max(down.abs());
            let rests = step(gaze, next) < RESTING_STEP || next == before;
            before = gaze;
            gaze = next;
            if rests {
                break;
            }
        }
        Some(Rest { gaze, offset })
    }
}

/// The larger of the two turns.
fn step(from: Gaze, to: Gaze) -> f64 {
    (to.pan - from.pan).abs().max((to.tilt - from.tilt).abs())
}
