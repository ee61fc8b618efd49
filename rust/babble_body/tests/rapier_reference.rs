//! The closed form of Eq. 2 against the same robot in rapier3d, whose multibody solver derives the
//! inertia and its coupling from link masses alone.

mod spread;

use babble_body::{ArmState, Body, Dynamics, PlanarArm, Pull};
use rapier3d::prelude::*;
use spread::spread;

const DT: f64 = 0.005;
/// Angular x: the free axis of a revolute joint in its own frame.
const FREE_AXIS: usize = 3;

/// Upper arm and forearm with hand, hinged to a fixed shoulder.
struct Robot {
    world: PhysicsWorld,
    joints: [MultibodyJointHandle; 2],
}

impl Robot {
    fn new(body: &Body, q: [f64; 2]) -> Self {
        let arm = PlanarArm::new(body);
        let inertia = *Dynamics::new(body, &arm).inertia();
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = DT as f32;
        let shoulder = world.insert_body(RigidBodyBuilder::fixed());
        let upper = world.insert_body(link(
            0.0,
            [inertia.upper_centre, 0.0],
            inertia.upper_mass,
            inertia.upper,
        ));
        let fore = world.insert_body(link(
            arm.upper,
            inertia.fore_centre,
            inertia.fore_mass,
            inertia.fore,
        ));
        let hinge = |at: f64| {
            RevoluteJointBuilder::new(Vector::Z).local_anchor1(Vector::new(at as f32, 0.0, 0.0))
        };
        let joints = [
            world.insert_multibody_joint(shoulder, upper, hinge(0.0)),
            world.insert_multibody_joint(upper, fore, hinge(arm.upper)),
        ]
        .map(|joint| joint.expect("the links form a chain"));
        let mut robot = Self { world, joints };
        robot.set_up(body, q);
        robot
    }

    /// The muscles' damping and the posture to start in.
    fn set_up(&mut self, body: &Body, q: [f64; 2]) {
        let PhysicsWorld {
            bodies,
            multibody_joints,
            ..
        } = &mut self.world;
        let (multibody, _) = multibody_joints.get_mut(self.joints[0]).unwrap();
        // Until this call the root counts as free, with six joints of its own.
        multibody.forward_kinematics(bodies, true);
        assert_eq!(multibody.ndofs(), 2);
        multibody.damping_mut().fill(body.muscles.kd as f32);
        multibody.apply_displacements(&q.map(|angle| angle as f32));
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
    }

    fn step(&mut self, q_des: [f64; 2], kp: f64) {
        for (joint, rest) in self.joints.into_iter().zip(q_des) {
            let (multibody, link) = self.world.multibody_joints.get_mut(joint).unwrap();
            let link = multibody.link_mut(link).unwrap();
            link.joint.set_spring(FREE_AXIS, kp as f32, rest as f32);
        }
        self.world.step();
    }

    fn posture(&self) -> [f64; 2] {
        self.joints.map(|joint| {
            let (multibody, link) = self.world.multibody_joints.get(joint).unwrap();
            f64::from(multibody.link(link).unwrap().joint.coords()[FREE_AXIS])
        })
    }
}

/// A link along x from `start`, of a moment about that end.
fn link(start: f64, centre: [f64; 2], mass: f64, moment: f64) -> RigidBodyBuilder {
    let about_centre = moment - mass * (centre[0] * centre[0] + centre[1] * centre[1]);
    let properties = MassProperties::new(
        Vector::new(centre[0] as f32, centre[1] as f32, 0.0),
        mass as f32,
        Vector::splat(about_centre as f32),
    );
    RigidBodyBuilder::dynamic()
        .translation(Vector::new(start as f32, 0.0, 0.0))
        .additional_mass_properties(properties)
        .can_sleep(false)
}

/// Largest difference of a joint angle \[rad\] over 6 s, with a new target every half second from
/// the middle `width` of the joint ranges.
fn difference(body: &Body, seed: usize, width: f64) -> f64 {
    let arm = PlanarArm::new(body);
    let dynamics = Dynamics::new(body, &arm);
    let mut state = ArmState::at_rest(arm.denormalised(spread(1000 * seed + 999)));
    let mut robot = Robot::new(body, state.q);
    let mut worst: f64 = 0.0;
    for step in 0..1200 {
        let share = spread(1000 * seed + step / 100).map(|x| 0.5 + width * (x - 0.5));
        let q_des = arm.denormalised(share);
        state = dynamics.step(state, Pull::Towards(q_des), DT);
        robot.step(q_des, body.muscles.kp);
        for (ours, theirs) in state.q.into_iter().zip(robot.posture()) {
            worst = worst.max((ours - theirs).abs());
        }
    }
    worst
}

/// The two agree to 5 mrad under the paper's muscles. Catches a wrong sign or factor in Eq. 2 and
/// damping or stiffness taken at the wrong end of the step.
#[test]
fn agrees_with_rapier() {
    let worst = (0..8)
        .map(|seed| difference(&Body::paper(), seed, 1.0))
        .fold(0.0, f64::max);
    println!("largest difference: {:.3} mrad", 1e3 * worst);
    assert!(worst < 5e-3, "{worst} rad");
}

/// A heavy arm under weak muscles swings, so that inertia, its coupling and the Coriolis torque
/// decide. Catches errors there, which the paper's damping hides: C = 0 or of the other sign, M12
/// without the elbow's angle, a moment about the wrong point.
#[test]
fn agrees_with_rapier_when_inertia_counts() {
    let mut body = Body::paper();
    body.arm.density_kg_m3 = 20_000.0;
    // A thumb to the side puts the forearm's centre of mass off its line.
    body.joints.get_mut("thumb_1").unwrap().locked_deg = Some(60.0);
    body.muscles.kp = 2.0;
    body.muscles.kd = 0.6;
    body.validate().unwrap();
    // The reference has no stops at the ends of the ranges for an arm that overshoots.
    let worst = (0..4)
        .map(|seed| difference(&body, seed, 0.4))
        .fold(0.0, f64::max);
    println!("largest difference, heavy arm: {:.3} mrad", 1e3 * worst);
    assert!(worst < 20e-3, "{worst} rad");
}
