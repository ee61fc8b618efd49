//! The rasteriser: which surface each pixel sees, and how far away it is.

pub(crate) mod decompose;
pub(crate) mod depth_buffer;
pub(crate) mod image_plane;
pub(crate) mod inverse_depth;
pub(crate) mod origin;
pub(crate) mod outline;
pub(crate) mod surface;
pub(crate) mod visible_surface;
pub(crate) mod window;
