#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

mod camera;
mod centroid;
mod config;
mod error;
mod fovea;
mod gaze;
mod onlooker;
mod raster;
mod reflex;
mod render;
mod scene;

pub use camera::Pinhole;
pub use centroid::{RedRegion, red_centroid, red_region};
pub use config::{EyeConfig, GazeFrame};
pub use error::EyeError;
pub use fovea::{
    FOVEA_BLOCK, FOVEA_BLOCKS, FOVEA_PIXELS, SHAPE_LEN, foveal_edges, foveal_picture, foveal_shape,
    shape_picture,
};
pub use gaze::{Eye, Gaze};
pub use onlooker::third_person;
pub use raster::depth_buffer::{Raster, rasterise};
pub use render::light::{TOWARDS_KEY, is_red};
pub use render::picture::{draw_red_over, render_rgb, render_rgb_into, render_smooth};
pub use scene::{Material, Primitive, Shape};
