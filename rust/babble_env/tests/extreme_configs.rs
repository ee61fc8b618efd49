//! Whatever numbers a config may have, what is shown is finite, and each state can be saved and loaded.

mod playing;

use std::sync::Arc;

use babble_env::tasks::grasp::{GraspRequest, ObjectPlace};
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{Autoreset, Batch, Config, Control, EnvError, GraspTask, ReachTask, Task};
use playing::control;
use playing::grasping::{CONTROLS, with_control};
use proptest::prelude::*;

/// A number between two bounds: often one of them, else uniform in its logarithm.
fn between(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(low),
        1 => Just(high),
        4 => (0.0..1.0_f64).prop_map(move |x| low * (high / low).powf(x)),
    ]
}

/// A config as light, heavy, stiff, weak, fast or slow as may be.
fn configs() -> impl Strategy<Value = Config> {
    let lengths = [between(0.01, 1.0), between(0.01, 1.0), between(1e-4, 1.0)];
    let muscles = prop::array::uniform9(between(1e-3, 1e6));
    let object = (
        between(1.0, 1e5),
        between(1e-3, 10.0),
        between(1e-3, 1e3),
        between(1e-3, 1e3),
        between(0.005, 0.2),
    );
    let contact = (between(10.0, 1e7), between(1e-4, 1.0), between(1e-6, 0.1));
    let time = (between(1e-3, 1.0), between(1.0, 250.0));
    (lengths, between(1.0, 1e5), muscles, object, contact, time).prop_filter_map(
        "not a config",
        |(lengths, density, muscles, object, contact, (period, steps))| {
            let mut config = Config::profile("paper").unwrap();
            let body = &mut config.body;
            [
                body.arm.upper_arm_m,
                body.arm.forearm_m,
                body.arm.half_width_m,
            ] = lengths;
            body.arm.density_kg_m3 = density;
            let grip = &mut body.grip;
            let each = [
                &mut body.muscles,
                &mut grip.arm_muscles,
                &mut grip.hand_muscles,
            ];
            for (own, &[kp, kd, torque]) in each.into_iter().zip(muscles.as_chunks().0) {
                (own.kp, own.kd) = (kp, kd);
                own.torque_max = torque.min(1e3 * kd);
            }
            let diameter;
            (
                body.object.density_kg_m3,
                body.object.friction,
                body.object.linear_damping,
                body.object.angular_damping,
                diameter,
            ) = object;
            config.grasp.diameters_m = vec![diameter];
            (
                body.contact.stiffness_n_m,
                body.contact.relaxation_s,
                body.contact.stiction_m_s,
            ) = contact;
            config.grasp.control_period_s = period;
            config.grasp.physics_steps = steps.max((period / 0.02).ceil()) as u32;
            config.reach.control_period_s = period;
            config.reach.physics_steps = steps as u32;
            config.validate().is_ok().then_some(config)
        },
    )
}

/// Plays an environment from bound to bound.
fn play<T: Task>(env: &mut Batch<T>) -> Result<(), TestCaseError> {
    let width = env.task().action_len();
    for step in 0..30 {
        let action = if step / 8 % 2 == 0 { 1.0 } else { -1.0 };
        env.step(&vec![action; width]).unwrap();
        for record in env.records() {
            prop_assert!(record.senses.iter().all(|x| x.is_finite()));
            prop_assert!(record.step.reward.is_finite());
        }
        let bytes = env.save(0).unwrap();
        env.load(0, &bytes).unwrap();
        prop_assert!(env.save(0).unwrap() == bytes);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Catches joints that weak damping lets spin for ever, and contacts whose equations rounding has
    /// left without a solution.
    #[test]
    fn grasping_stays_finite(config in configs(), of in proptest::sample::select(&CONTROLS)) {
        let Ok(task) = GraspTask::new(config, with_control(of)) else { return Ok(()) };
        let (start, diameter) = ([0.2, 0.8], task.config.grasp.diameters_m[0]);
        let near = GraspRequest {
            start: Some(start),
            object: ObjectPlace::At(task.before_palm(start, diameter / 2.0, 0.006)),
            diameter: Some(diameter),
            ..GraspRequest::default()
        };
        let mut env = Batch::new(Arc::new(task), 1, Autoreset::NextStep, 1).unwrap();
        env.request(0, near).unwrap();
        // A large object is in the arm's way, or out of its reach.
        match env.reset(&[true]) {
            Ok(()) => play(&mut env)?,
            Err(error) => prop_assert!(matches!(error, EnvError::Case { .. }), "{error}"),
        }
    }

    /// The same of reaching, from the middle of the joint ranges.
    #[test]
    fn reaching_stays_finite(
        config in configs(),
        of in proptest::sample::select(&[Control::DeltaPosture, Control::Posture, Control::Torque][..]),
    ) {
        let task = ReachTask::new(config, control(of)).unwrap();
        let middle = task.arm.fingertip(task.arm.denormalised([0.5; 2]));
        let mut env = Batch::new(Arc::new(task), 1, Autoreset::NextStep, 1).unwrap();
        env.request(0, CaseRequest {
            start: Some(middle.into()),
            target: Some(middle.into()),
            obstacle: ObstacleRequest::Absent,
        }).unwrap();
        if env.reset(&[true]).is_ok() {
            play(&mut env)?;
        }
    }
}

/// What the properties above found.
#[test]
fn limits_of_configs_are_named() {
    for (config, named) in [
        (
            r#"{"body": {"grip": {"hand_muscles": {"kd": 1e-3, "torque_max": 1.1}}}}"#,
            "grip.hand_muscles.torque_max = 1.1",
        ),
        (
            r#"{"body": {"muscles": {"kd": 0.01, "torque_max": 11}}}"#,
            "muscles.torque_max = 11",
        ),
        (
            r#"{"grasp": {"control_period_s": 0.5}}"#,
            "grasp.physics_steps: 10 is out of bounds: finite and in [25, 250]",
        ),
        (
            r#"{"body": {"muscles": {"kp": 0.001}}}"#,
            "settle_time_constants",
        ),
    ] {
        let error = Config::from_json(config).unwrap_err().to_string();
        assert!(error.contains(named), "{named}: {error}");
    }
}
