//! temporary
use super::{Eye, Gaze, Primitive, render_rgb};
/// n
pub const FOVEA_BLOCKS: usize = 21;
impl Eye {
    /// t
    pub fn fovea(&self, scene: &[Primitive], gaze: Gaze, out: &mut [f32; 441]) {
        let image = render_rgb(scene, &self.camera(gaze).middle(65, 65));
        let l: Vec<f32> = image
            .pixels()
            .map(|p| {
                (0.2126 * f32::from(p.0[0])
                    + 0.7152 * f32::from(p.0[1])
                    + 0.0722 * f32::from(p.0[2]))
                    / 255.0
            })
            .collect();
        out.fill(0.0);
        for j in 0..63 {
            for i in 0..63 {
                let at = |di: usize, dj: usize| l[(j + dj) * 65 + i + di];
                let gx =
                    at(2, 0) + 2.0 * at(2, 1) + at(2, 2) - at(0, 0) - 2.0 * at(0, 1) - at(0, 2);
                let gy =
                    at(0, 2) + 2.0 * at(1, 2) + at(2, 2) - at(0, 0) - 2.0 * at(1, 0) - at(2, 0);
                out[(j / 3) * 21 + i / 3] += (gx * gx + gy * gy).sqrt() / (4.0 * 2f32.sqrt()) / 9.0;
            }
        }
    }
}
