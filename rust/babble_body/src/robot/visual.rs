//! What the eye and an onlooker can see of the robot and its object.

use nalgebra::Vector3;

use super::kinematics::place;
use super::links::ContactRegion;
use super::model::Robot;
use super::world::World;
use crate::geometry::frame::Frame;
use crate::geometry::solid::Solid;
use crate::visual::{FOREARM, Part, SKIN, SLEEVE};
use babble_eye::{Material, Primitive, Shape};

impl Robot {
    /// Adds arm and hand, the upper arm first.
    pub fn push_visible(&self, world: &World, scene: &mut Vec<Primitive>) {
        let placed = place(&self.links, |i| world.mechanics.q[i]);
        for (i, (link, placed)) in self.links.iter().zip(&placed).enumerate() {
            let frame = placed.frame();
            for (region, solid) in &link.solids {
                scene.push(Primitive::new(shape(solid, &frame), look(*region, i).1));
            }
        }
    }

    /// What [`push_visible`](Self::push_visible) adds, with the name of each part.
    #[must_use]
    pub fn visible_parts(&self, world: &World) -> Vec<Part> {
        let mut scene = Vec::new();
        self.push_visible(world, &mut scene);
        let links = self.links.iter().enumerate();
        let names = links.flat_map(|(i, link)| link.solids.iter().map(move |one| look(one.0, i).0));
        names.zip(scene).collect()
    }

    /// The object, which is the eye's target.
    #[must_use]
    pub fn visible_object(&self, world: &World, radius: f64) -> Primitive {
        Primitive::target(self.object(world), radius)
    }
}

fn look(region: ContactRegion, link: usize) -> (&'static str, Material) {
    match region {
        ContactRegion::Arm if link == 0 => ("upper_arm", SLEEVE),
        ContactRegion::Arm => ("forearm", FOREARM),
        ContactRegion::Palm => ("palm", SKIN),
        ContactRegion::Thumb => ("thumb", SKIN),
        ContactRegion::Fingers => ("finger", SKIN),
    }
}

fn shape(solid: &Solid, frame: &Frame) -> Shape {
    let world = |point: &Vector3<f64>| frame.world_from_local(point);
    match solid {
        Solid::Capsule { a, b, radius } => Shape::Capsule {
            a: world(a),
            b: world(b),
            radius: *radius,
        },
        Solid::Cuboid { centre, half } => Shape::Cuboid {
            centre: world(centre),
            rotation: frame.rotation,
            half_extents: *half,
        },
    }
}
