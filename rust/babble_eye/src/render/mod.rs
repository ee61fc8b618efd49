//! Pictures: what the rasteriser sees, lit and coloured.

mod checker;
pub(crate) mod light;
pub(crate) mod painter;
pub(crate) mod picture;
pub(crate) mod pixel_format;
mod shading;
mod shadow;
mod swatch;
