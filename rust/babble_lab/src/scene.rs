//! The world of an episode, and what the eye has to do with Eq. 1, for views that the page draws.

use std::collections::BTreeMap;

use babble_env::picture::{View, Visible};
use babble_eye::{Primitive, Shape as EyeShape};
use serde::Serialize;

use crate::fault::Fault;
use crate::lab::Lab;

/// The world of one agent's episode. Lengths are in metres; x right, y ahead, z up.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Scene {
    /// The same solids in the same order during an episode; only places change.
    pub solids: Vec<Solid>,
    /// The line of sight.
    pub gaze: GazeLine,
    /// Axes of the eye's image: right and down.
    pub camera_frame: [[f64; 3]; 2],
    /// Angle of view of the eye \[rad\].
    pub field_of_view: f64,
    /// What is to come to the red object: the fingertip, or the middle of the palm.
    pub fingertip: [f64; 3],
}

/// From the eye to where it looks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GazeLine {
    /// Centre of the eye.
    pub eye: [f64; 3],
    /// Where it looks.
    pub at: [f64; 3],
}

/// A solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solid {
    /// What it belongs to.
    pub part: &'static str,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Form and place.
    pub shape: Shape,
}

/// Form and place of a solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(
    tag = "kind",
    rename_all = "snake_case",
    rename_all_fields = "camelCase"
)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Centre.
        centre: [f64; 3],
        /// Radius.
        radius: f64,
    },
    /// A cylinder with round ends.
    Capsule {
        /// One end of the axis.
        a: [f64; 3],
        /// The other end.
        b: [f64; 3],
        /// Radius.
        radius: f64,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Centre of one end.
        a: [f64; 3],
        /// Centre of the other end.
        b: [f64; 3],
        /// Radius.
        radius: f64,
    },
    /// A box.
    Cuboid {
        /// Centre.
        centre: [f64; 3],
        /// Rows of the matrix that turns the box.
        rotation: [[f64; 3]; 3],
        /// Half the edges.
        half_extents: [f64; 3],
    },
    /// A checkered rectangle.
    Ground {
        /// Its height.
        height: f64,
        /// Middle (x, y).
        centre: [f64; 2],
        /// Half the edges.
        half_extents: [f64; 2],
        /// Edge of a square of the checker.
        cell: f64,
    },
}

/// What the eye has to do with Eq. 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Sight {
    /// Turn to the right \[rad\].
    pub pan: f64,
    /// Turn upwards in the image \[rad\].
    pub tilt: f64,
    /// Centroid of the red pixels from the middle of the image, right and down, in half edges of the
    /// image; none if no red is seen.
    pub centroid: Option<[f64; 2]>,
    /// How many red pixels there are.
    pub red_pixels: u64,
    /// The observation by name.
    pub senses: BTreeMap<&'static str, Vec<f32>>,
}

impl Lab {
    /// The world of an agent's episode.
    ///
    /// # Errors
    /// A [`Fault`] for an agent that does not exist.
    pub fn scene(&self, agent: usize) -> Result<Scene, Fault> {
        Ok(self.scene_of(&self.visible(agent)?))
    }

    /// The world that can be seen.
    pub(crate) fn scene_of(&self, visible: &Visible) -> Scene {
        let body = &self.task.config().body;
        let around = [
            ("eye", babble_body::visual::eye_ball(body)),
            ("ground", babble_body::visual::ground(body)),
        ];
        let solid = |(part, thing): &(&'static str, Primitive)| Solid {
            part,
            colour: thing.material.colour,
            shape: shape(&thing.shape),
        };
        let [right, up] =
            [0, 1].map(|i| -> [f64; 3] { visible.camera.rotation.row(i).transpose().into() });
        Scene {
            solids: visible.parts.iter().chain(&around).map(solid).collect(),
            gaze: GazeLine {
                eye: body.eye.position_m,
                at: visible.looks_at,
            },
            camera_frame: [right, up.map(|x| 0.0 - x)],
            field_of_view: visible.field,
            fingertip: visible.tip,
        }
    }

    /// What the eye of an agent has to do with Eq. 1.
    ///
    /// # Errors
    /// As [`Self::scene`].
    pub fn sight(&self, agent: usize) -> Result<Sight, Fault> {
        let visible = self.visible(agent)?;
        let half = 0.5 * visible.camera.width as f64;
        let red = visible.red;
        Ok(Sight {
            pan: visible.gaze.pan,
            tilt: visible.gaze.tilt,
            centroid: red.map(|red| red.centroid.map(|x| (x - half) / half)),
            red_pixels: red.map_or(0, |red| red.pixels),
            senses: self.senses(agent)?.into_iter().collect(),
        })
    }

    /// A picture of an agent's episode as red, green, blue and 255 for each pixel, rows from the top;
    /// `view` is `eye`, `fovea`, `edges` or `third_person`.
    ///
    /// # Errors
    /// A [`Fault`] for an unknown view or an edge that is out of bounds.
    pub fn picture(&self, agent: usize, view: &str, size: [u32; 2]) -> Result<Vec<u8>, Fault> {
        self.agent(agent)?;
        let view: View = view.parse()?;
        let image = self.stage.seen(agent).picture(0, view, size, None)?;
        let pixels = image.pixels();
        Ok(pixels
            .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
            .collect())
    }

    fn visible(&self, agent: usize) -> Result<Visible, Fault> {
        self.agent(agent)?;
        let visible = self.stage.seen(agent).visible(0)?;
        let nothing = || Fault::config("env", "there is nothing to see in this environment");
        visible.ok_or_else(nothing)
    }
}

fn shape(shape: &EyeShape) -> Shape {
    match *shape {
        EyeShape::Sphere { centre, radius } => Shape::Sphere {
            centre: centre.into(),
            radius,
        },
        EyeShape::Capsule { a, b, radius } => Shape::Capsule {
            a: a.into(),
            b: b.into(),
            radius,
        },
        EyeShape::Cylinder { a, b, radius } => Shape::Cylinder {
            a: a.into(),
            b: b.into(),
            radius,
        },
        EyeShape::Cuboid {
            centre,
            rotation,
            half_extents,
        } => Shape::Cuboid {
            centre: centre.into(),
            rotation: [0, 1, 2].map(|i| rotation.row(i).transpose().into()),
            half_extents: half_extents.into(),
        },
        EyeShape::Ground {
            height,
            centre,
            half_extents,
            cell,
        } => Shape::Ground {
            height,
            centre,
            half_extents,
            cell,
        },
    }
}
