//! What the eye, and a person, sees of an episode of any task.

use babble_body::visual::Part;
use babble_eye::{
    Eye, Gaze, Pinhole, Primitive, RedRegion, draw_red_over, foveal_edges, foveal_picture,
    render_rgb, render_smooth, third_person,
};
use image::imageops::{FilterType, resize, thumbnail};
use image::{Rgb, RgbImage};

use crate::error::EnvError;
use crate::named_enum::named_enum;

named_enum!(
    /// Where a picture is taken from.
    View, "camera",
    /// From the front right and above.
    ThirdPerson = "third_person",
    /// Through the eye.
    Eye = "eye",
    /// The middle of the eye's image, which is looked at closely.
    Fovea = "fovea",
    /// The edges in the fovea.
    Edges = "edges"
);

/// Smallest and largest edge of a picture \[pixel\].
const EDGE: std::ops::RangeInclusive<u32> = 16..=4096;

/// Fewest rays along an edge of the eye's image: with fewer the target falls between them, and a
/// pixel is the mean of several rays.
const EYE_RAYS: u32 = 160;

/// What there is to see of an episode, for views that somebody else draws. Lengths are in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Visible {
    /// What is solid, in world coordinates. During an episode only places change.
    pub parts: Vec<Part>,
    /// Pan and tilt.
    pub gaze: Gaze,
    /// The eye's image.
    pub camera: Pinhole,
    /// Its angle of view \[rad\].
    pub field: f64,
    /// Where the line of sight ends: in the arm's plane, or at the length of an arm.
    pub looks_at: [f64; 3],
    /// The red pixels of Eq. 1; none where no red is seen.
    pub red: Option<RedRegion>,
    /// What is to come to the red object: the fingertip, or the middle of the palm.
    pub tip: [f64; 3],
}

impl Visible {
    pub(crate) fn new(
        eye: &Eye,
        gaze: Gaze,
        red: Option<RedRegion>,
        tip: [f64; 3],
        parts: Vec<Part>,
    ) -> Self {
        /// Length of a line of sight that does not meet the plane \[m\].
        const FAR_M: f64 = 0.4;
        let camera = eye.camera(gaze);
        let far = camera.position + camera.ray([0.0, 0.0]) * FAR_M;
        let met = eye.target_in_plane(gaze, 0.0);
        Self {
            parts,
            gaze,
            field: eye.config().field_deg.to_radians(),
            looks_at: met.map_or(far.into(), |[x, y]| [x, y, 0.0]),
            camera,
            red,
            tip,
        }
    }
}

/// What there was to see of a movement, moment by moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Film {
    /// At the beginning, and at the end of each control period.
    pub frames: Vec<Visible>,
    /// Numbers of the frames in which something noteworthy happened.
    pub marks: Vec<usize>,
}

impl Film {
    /// Notes that something noteworthy happens in the last frame.
    pub fn mark(&mut self) {
        self.marks.push(self.frames.len().saturating_sub(1));
    }
}

/// What there is to see.
#[derive(Debug)]
pub(crate) struct Scene<'a> {
    /// All of it.
    pub(crate) things: &'a [Primitive],
    /// What nothing hides from the eye, where it is red.
    pub(crate) on_top: &'a [Primitive],
    /// The eye that looks at it.
    pub(crate) eye: &'a Eye,
    /// Where it looks.
    pub(crate) gaze: Gaze,
}

impl Scene<'_> {
    /// A picture (width, height).
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for an edge that is out of bounds.
    pub(crate) fn picture(
        &self,
        view: View,
        [width, height]: [u32; 2],
    ) -> Result<RgbImage, EnvError> {
        for (option, edge) in [("width", width), ("height", height)] {
            if !EDGE.contains(&edge) {
                return Err(EnvError::OutOfBounds {
                    option,
                    value: edge.to_string(),
                    bound: format!("in [{}, {}] pixels", EDGE.start(), EDGE.end()),
                });
            }
        }
        Ok(match view {
            View::ThirdPerson => {
                render_smooth(self.things, &third_person(width as usize, height as usize))
            }
            View::Eye => self.through_the_eye(width, height),
            View::Fovea => {
                let fovea = foveal_picture(self.things, &self.eye.camera(self.gaze));
                resize(&fovea, width, height, FilterType::Nearest)
            }
            View::Edges => {
                let edges = foveal_edges(self.things, &self.eye.camera(self.gaze));
                let grey = |x, y| Rgb([edges.get_pixel(x, y)[0]; 3]);
                let edges = RgbImage::from_fn(edges.width(), edges.height(), grey);
                resize(&edges, width, height, FilterType::Nearest)
            }
        })
    }

    fn through_the_eye(&self, width: u32, height: u32) -> RgbImage {
        let edge = width.min(height);
        let rays = EYE_RAYS.div_ceil(edge);
        let camera = self
            .eye
            .camera_sized(self.gaze, (edge * rays) as usize)
            .middle((width * rays) as usize, (height * rays) as usize);
        let mut image = render_rgb(self.things, &camera);
        draw_red_over(&mut image, self.on_top, &camera);
        if rays == 1 {
            image
        } else {
            thumbnail(&image, width, height)
        }
    }
}

/// The error for a moment that was not recorded.
pub(crate) fn no_such_frame(frame: usize, moments: usize) -> EnvError {
    EnvError::OutOfBounds {
        option: "frame",
        value: frame.to_string(),
        bound: format!("below {moments}"),
    }
}
