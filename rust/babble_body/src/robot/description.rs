//! Arm and hand as plain data.

use super::links::{ContactRegion, Link, Muscle};
use super::model::Robot;
use crate::config::Fingers;
use crate::description::{LinkDescription, NamedSolid};
use crate::geometry::solid::Solid;
use crate::joints::ARM_JOINTS;

/// From the lowest to the highest, as the links have them.
const FINGERS: [&str; 4] = ["little", "ring", "middle", "index"];

impl Robot {
    /// Arm and hand as they grasp, each link after the one that it hangs on.
    ///
    /// Contacts can push a joint out of its range, which only its equilibrium point keeps.
    #[must_use]
    pub fn description(&self) -> Vec<LinkDescription> {
        let joints = self.joint_names();
        self.links
            .iter()
            .zip(joints)
            .map(|(link, joint)| self.describe(link, joint))
            .collect()
    }

    fn describe(&self, link: &Link, joint: String) -> LinkDescription {
        let name = match link.muscle {
            Muscle::Shoulder => "upper_arm".to_owned(),
            Muscle::Elbow => "forearm".to_owned(),
            Muscle::Thumb | Muscle::Finger => joint.clone(),
        };
        LinkDescription {
            parent: link.parent,
            origin: link.origin.into(),
            direction: link.direction,
            clockwise: link.clockwise,
            range: self.ranges()[link.muscle.index()],
            stops: false,
            muscles: link.muscle.settings(&self.body),
            inertia: link.inertia(self.body.arm.density_kg_m3),
            solids: named(&name, &link.solids),
            name,
            joint,
        }
    }

    /// Names of the joints, as the config has them; a virtual finger's are its own.
    fn joint_names(&self) -> impl Iterator<Item = String> {
        let finger = |name: &str| [1, 2, 3].map(|i| format!("{name}_{i}"));
        let fingers: Vec<String> = match self.body.grip.fingers {
            Fingers::Virtual => finger("finger").into(),
            Fingers::Independent => FINGERS.iter().flat_map(|name| finger(name)).collect(),
        };
        let thumb = ["thumb_pivot", "thumb_1", "thumb_2", "thumb_3"];
        ARM_JOINTS
            .map(str::to_owned)
            .into_iter()
            .chain(fingers)
            .chain(thumb.map(str::to_owned))
    }
}

/// The solids of a link; a virtual finger's link carries one of each finger.
fn named(link: &str, solids: &[(ContactRegion, Solid)]) -> Vec<NamedSolid> {
    let of_digits = solids.len() == FINGERS.len();
    let name = |i: usize, region: ContactRegion| match region {
        ContactRegion::Palm => "palm".to_owned(),
        ContactRegion::Fingers if of_digits => link.replace("finger", FINGERS[i]),
        _ => link.to_owned(),
    };
    solids
        .iter()
        .enumerate()
        .map(|(i, &(region, solid))| NamedSolid {
            name: name(i, region),
            solid,
        })
        .collect()
}
