//! Laws of the arm's motion, Eq. 2.

use babble_body::arm::PlanarArm;
use babble_body::config::Muscles;
use babble_body::skeleton::{self, BoneKind};
use babble_body::{ArmState, Body, Dynamics, Pull};
use proptest::prelude::*;

const DT: f64 = 0.005;
type Vec4 = [f64; 4];

fn body(kp: f64, kd: f64, density: f64) -> Body {
    let mut body = Body::paper();
    body.arm.density_kg_m3 = density;
    body.muscles = Muscles {
        kp,
        kd,
        ..body.muscles
    };
    body
}

fn dynamics(body: &Body) -> (PlanarArm, Dynamics) {
    let arm = PlanarArm::new(body);
    let dynamics = Dynamics::new(body, &arm);
    (arm, dynamics)
}

fn run(dynamics: &Dynamics, from: ArmState, q_des: [f64; 2], dt: f64, time: f64) -> ArmState {
    let steps = (time / dt).round() as usize;
    (0..steps).fold(from, |state, _| {
        dynamics.step(state, Pull::Towards(q_des), dt)
    })
}

/// Eq. 2 and the arm's inertia, integrated to fourth order:
///
/// ```text
/// M(q) q̈ = K_P (q_des − q) − K_D q̇ − C
/// C_i = Σ_jk (∂M_ij/∂q_k − ½ ∂M_jk/∂q_i) q̇_j q̇_k
/// ```
///
/// with M read off the kinetic energy ½ q̇ᵀ M q̇, and its slopes from differences.
struct Reference<'a> {
    dynamics: &'a Dynamics,
    kp: f64,
    kd: f64,
}

impl Reference<'_> {
    fn mass(&self, q: [f64; 2]) -> [[f64; 2]; 2] {
        let energy = |v| self.dynamics.kinetic_energy(ArmState { q, v });
        let (m11, m22) = (2.0 * energy([1.0, 0.0]), 2.0 * energy([0.0, 1.0]));
        let m12 = energy([1.0, 1.0]) - 0.5 * (m11 + m22);
        [[m11, m12], [m12, m22]]
    }

    fn acceleration(&self, [q1, q2, v1, v2]: Vec4, q_des: [f64; 2]) -> [f64; 2] {
        const H: f64 = 1e-4;
        let (q, v) = ([q1, q2], [v1, v2]);
        let shifted = |k: usize, by: f64| {
            let mut at = q;
            at[k] += by;
            self.mass(at)
        };
        let slope = [0, 1].map(|k| {
            let (above, below) = (shifted(k, H), shifted(k, -H));
            [0, 1].map(|i| [0, 1].map(|j| (above[i][j] - below[i][j]) / (2.0 * H)))
        });
        let mut rhs = [0.0; 2];
        for i in 0..2 {
            rhs[i] = self.kp * (q_des[i] - q[i]) - self.kd * v[i];
            for j in 0..2 {
                for k in 0..2 {
                    rhs[i] -= (slope[k][i][j] - 0.5 * slope[i][j][k]) * v[j] * v[k];
                }
            }
        }
        let m = self.mass(q);
        let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        [
            (m[1][1] * rhs[0] - m[0][1] * rhs[1]) / determinant,
            (m[0][0] * rhs[1] - m[1][0] * rhs[0]) / determinant,
        ]
    }

    fn run(&self, from: ArmState, q_des: [f64; 2], dt: f64, time: f64) -> ArmState {
        let slope = |x: Vec4| {
            let [a1, a2] = self.acceleration(x, q_des);
            [x[2], x[3], a1, a2]
        };
        let mut x = [from.q[0], from.q[1], from.v[0], from.v[1]];
        for _ in 0..(time / dt).round() as usize {
            let along = |k: Vec4, h: f64| [0, 1, 2, 3].map(|i| x[i] + h * k[i]);
            let k1 = slope(x);
            let k2 = slope(along(k1, dt / 2.0));
            let k3 = slope(along(k2, dt / 2.0));
            let k4 = slope(along(k3, dt));
            x = [0, 1, 2, 3].map(|i| x[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        ArmState {
            q: [x[0], x[1]],
            v: [x[2], x[3]],
        }
    }
}

fn error(a: ArmState, b: ArmState) -> f64 {
    (a.q[0] - b.q[0]).abs().max((a.q[1] - b.q[1]).abs())
}

/// The scheme is of first order: half the step, half the error, towards an independent integration
/// of Eq. 2. One body is ruled by the muscles, one swings. Catches a term taken at the wrong time,
/// which leaves an error that no step makes smaller, and a wrong C, which the muscles hide.
#[test]
fn converges_to_fine_integration_with_order_one() {
    // The reference is stable below 2.8 M / K_D.
    for (kp, kd, density, fine) in [(50.0, 40.0, 1100.0, 2e-5), (1.0, 0.3, 10_000.0, 5e-4)] {
        let (_, dynamics) = dynamics(&body(kp, kd, density));
        let reference = Reference {
            dynamics: &dynamics,
            kp,
            kd,
        };
        let start = ArmState {
            q: [0.8, 0.9],
            v: [1.0, -0.5],
        };
        let q_des = [1.6, 1.5];
        let exact = reference.run(start, q_des, fine, 0.4);
        let errors =
            [DT, DT / 2.0, DT / 4.0].map(|dt| error(run(&dynamics, start, q_des, dt, 0.4), exact));
        assert!(errors[0] < 5e-3, "kp {kp}: {errors:?}");
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.85..1.15).contains(&order), "kp {kp}: {errors:?}");
        }
    }
}

/// The kinetic energy is that of the moving mass: rods cut into pieces, their speeds from the
/// skeleton. Catches a moment about the wrong joint, a rod's ¹⁄₁₂ for ⅓ and a lost cross term.
#[test]
fn kinetic_energy_is_that_of_the_pieces() {
    const PIECES: u32 = 200;
    const H: f64 = 1e-5;
    let mut body = body(50.0, 40.0, 1100.0);
    for (name, angle) in [
        ("wrist_flexion", 25.0),
        ("thumb_1", 70.0),
        ("index_2", 40.0),
    ] {
        body.joints.get_mut(name).unwrap().locked_deg = Some(angle);
    }
    let (_, dynamics) = dynamics(&body);
    let state = ArmState {
        q: [0.4, 1.1],
        v: [1.3, -0.7],
    };
    let at = |t: f64| {
        let q = [0, 1].map(|i| state.q[i] + t * state.v[i]);
        skeleton::bones(&body, &skeleton::joint_angles(&body.joints, q)).0
    };
    let mut energy = 0.0;
    for (before, after) in at(-H).into_iter().zip(at(H)) {
        let length = (before.b - before.a).norm();
        let (section, square, turning) = match before.kind {
            BoneKind::UpperArm => (std::f64::consts::PI * 1e-4, 1e-4 / 4.0, state.v[0]),
            BoneKind::Forearm => (
                std::f64::consts::PI * 1e-4,
                1e-4 / 4.0,
                state.v[0] + state.v[1],
            ),
            BoneKind::Palm => (0.02 * 0.06, 1e-4 / 3.0, state.v[0] + state.v[1]),
            BoneKind::Thumb | BoneKind::Finger => (
                std::f64::consts::PI * 0.006 * 0.006,
                0.006 * 0.006 / 4.0,
                state.v[0] + state.v[1],
            ),
        };
        let piece = 1100.0 * section * length / f64::from(PIECES);
        for k in 0..PIECES {
            let share = (f64::from(k) + 0.5) / f64::from(PIECES);
            let point = |bone: &skeleton::Bone| bone.a + (bone.b - bone.a) * share;
            let speed = (point(&after) - point(&before)) / (2.0 * H);
            energy += 0.5 * piece * (speed.norm_squared() + square * turning * turning);
        }
    }
    let ours = dynamics.kinetic_energy(state);
    assert!(
        (ours / energy - 1.0).abs() < 1e-5,
        "{ours} J, pieces {energy} J"
    );
}

/// Without muscles the energy stays, but for an error that shrinks with the step. Catches a C of
/// the wrong size, which pumps or drains at any step.
#[test]
fn energy_is_conserved_without_muscles() {
    let (_, dynamics) = dynamics(&body(0.0, 0.0, 1100.0));
    let start = ArmState {
        q: [0.5, 1.2],
        v: [2.0, 1.0],
    };
    let drift = |dt: f64| {
        let end = run(&dynamics, start, [0.0, 0.0], dt, 0.3);
        (dynamics.kinetic_energy(end) / dynamics.kinetic_energy(start) - 1.0).abs()
    };
    let [coarse, fine] = [drift(1e-3), drift(1e-4)];
    assert!(
        coarse < 0.01 && (7.0..13.0).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}

/// A step response: after n steps of a massless arm `(1 + dt K_P/K_D)⁻ⁿ` of the way is left, which is
/// exp(−t/τ) with τ = `K_D/K_P` to first order. Catches `dt² K_P` left out on either side of Eq. 2.
#[test]
fn massless_arm_follows_the_closed_form() {
    let (kp, kd) = (50.0, 40.0);
    let (_, dynamics) = dynamics(&body(kp, kd, 1e-6));
    let tau = kd / kp;
    let (start, q_des) = (ArmState::at_rest([0.2, 0.5]), [1.2, 1.5]);
    for n in [1, 20, 160, 640] {
        let time = f64::from(n) * DT;
        let end = run(&dynamics, start, q_des, DT, time);
        let scheme = (1.0 + DT / tau).powi(-n);
        for i in 0..2 {
            let left = q_des[i] - end.q[i];
            assert!(
                (left - scheme).abs() < 1e-7,
                "{n} steps: {left}, scheme {scheme}"
            );
            assert!(
                (left - (-time / tau).exp()).abs() < 1.5e-3,
                "{n} steps: {left}"
            );
        }
    }
}

/// The paper's arm is light beside its muscles: a time constant after a jump 1/e of the way is left,
/// and after 20 it rests at the equilibrium point. Catches a spring or damper on one joint alone.
#[test]
fn arm_reaches_its_equilibrium_point() {
    let (_, dynamics) = dynamics(&Body::paper());
    let (start, q_des) = (ArmState::at_rest([0.2, 0.5]), [1.2, 1.5]);
    let after_tau = run(&dynamics, start, q_des, DT, 0.8);
    for i in 0..2 {
        let left = q_des[i] - after_tau.q[i];
        assert!(
            (left - (-1.0_f64).exp()).abs() < 0.01,
            "{left} of the way left"
        );
    }
    let rest = run(&dynamics, start, q_des, DT, 16.0);
    for i in 0..2 {
        assert!(
            (rest.q[i] - q_des[i]).abs() < 1e-6 && rest.v[i].abs() < 1e-6,
            "{rest:?}"
        );
    }
}

/// Under a constant torque T a joint comes to the speed `T/K_D`. Catches a spring that still pulls in
/// torque control, and damping applied twice.
#[test]
fn torque_meets_damping_at_its_terminal_speed() {
    let (_, dynamics) = dynamics(&Body::paper());
    for torque in [[4.0, 0.0], [0.0, 4.0], [-3.0, 6.0]] {
        let mut state = ArmState::at_rest([1.0, 1.0]);
        for _ in 0..200 {
            state = dynamics.step(state, Pull::Torques(torque), DT);
        }
        for i in 0..2 {
            assert!(
                (state.v[i] - torque[i] / 40.0).abs() < 1e-4,
                "{torque:?}: {state:?}"
            );
        }
    }
}

/// An arm driven beyond a joint's range stands at its end, and leaves it when driven back. Catches
/// a stop that keeps the speed, and one that holds the other joint as well.
#[test]
fn joints_stop_at_the_ends_of_their_ranges() {
    let (arm, dynamics) = dynamics(&Body::paper());
    for (q_des, ends) in [([9.0, 9.0], arm.upper_limit), ([-9.0, -9.0], arm.lower)] {
        let stopped = run(&dynamics, ArmState::at_rest([1.0, 1.0]), q_des, DT, 4.0);
        assert_eq!(stopped, ArmState::at_rest(ends));
        let back = run(&dynamics, stopped, [1.0, 1.0], DT, 16.0);
        assert!((back.q[0] - 1.0).abs() < 1e-6 && (back.q[1] - 1.0).abs() < 1e-6);
    }
    let free = run(
        &dynamics,
        ArmState::at_rest([1.0, 1.0]),
        [9.0, 1.5],
        DT,
        16.0,
    );
    assert_eq!((free.q[0], free.v[0]), (arm.upper_limit[0], 0.0));
    assert!((free.q[1] - 1.5).abs() < 1e-6);
}

proptest! {
    /// Damping takes energy and never gives any, at any step and speed. Catches an explicit damper,
    /// which throws a light arm to infinity at half a millisecond.
    #[test]
    fn damping_never_adds_energy(
        kd in 1.0..1000.0, dt in 1e-4..0.05,
        q in prop::array::uniform2(0.3..2.0), v in prop::array::uniform2(-5.0..5.0),
    ) {
        let (_, dynamics) = dynamics(&body(0.0, kd, 1100.0));
        let mut state = ArmState { q, v };
        let mut energy = dynamics.kinetic_energy(state);
        for _ in 0..50 {
            state = dynamics.step(state, Pull::Towards([0.0; 2]), dt);
            let now = dynamics.kinetic_energy(state);
            prop_assert!(now <= energy * (1.0 + 1e-12), "{energy} J to {now} J at {state:?}");
            energy = now;
        }
    }

    /// Stable at any step: an arm in range stays there with finite speeds under any equilibrium
    /// points. Catches an explicit spring.
    #[test]
    fn stays_finite_and_in_range(
        share in prop::array::uniform2(0.0..=1.0),
        targets in prop::collection::vec(prop::array::uniform2(-10.0..10.0), 1..20),
        dt in 1e-4..1.0,
    ) {
        let (arm, dynamics) = dynamics(&Body::paper());
        let mut state = ArmState::at_rest(arm.clamp(arm.denormalised(share)));
        for q_des in targets {
            state = dynamics.step(state, Pull::Towards(q_des), dt);
            prop_assert!(arm.in_range(state.q));
            prop_assert!(state.v.iter().all(|v| v.is_finite()));
        }
    }
}
