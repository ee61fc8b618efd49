#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

mod camera;
mod centroid;
mod config;
mod depth;
mod error;
mod fovea;
mod gaze;
mod ground;
mod ink;
mod light;
mod outline;
mod piece;
mod raster;
mod reflex;
mod row;
mod scene;
mod shading;
mod shadow;
mod surface;
mod view;
mod window;

pub use camera::Pinhole;
pub use centroid::red_centroid;
pub use config::{EyeConfig, GazeFrame};
pub use error::EyeError;
pub use fovea::{
    FOVEA_BLOCK, FOVEA_BLOCKS, FOVEA_PIXELS, SHAPE_LEN, foveal_edges, foveal_picture, foveal_shape,
    shape_picture,
};
pub use gaze::{Eye, Gaze};
pub use light::{TOWARDS_KEY, is_red};
pub use raster::{Raster, rasterise};
pub use scene::{Material, Primitive, Shape};
pub use shading::{draw_red_over, render_rgb, render_rgb_into, render_smooth};
pub use view::third_person;
