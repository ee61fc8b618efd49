//! Configs: a profile with fields replaced, from JSON, TOML or a file.

use std::fs;
use std::path::PathBuf;

use babble_env::config::PROFILES;
use babble_env::{Config, EnvError, ReachOptions, ReachTask};

fn refusal(json: &str) -> String {
    match Config::from_json(json) {
        Err(error @ (EnvError::Config { .. } | EnvError::Body(_) | EnvError::Option { .. })) => {
            error.to_string()
        }
        other => panic!("{json} gave {other:?}"),
    }
}

/// The profiles are valid, make a task and survive the way through JSON. Catches a default that its
/// own check refuses, and a field that is not written.
#[test]
fn profiles_are_valid() {
    for name in PROFILES {
        let config = Config::profile(name).unwrap();
        config.validate().unwrap();
        ReachTask::new(config.clone(), ReachOptions::default()).unwrap();
        assert_eq!(
            Config::from_json(&config.to_json().unwrap()),
            Ok(config.clone())
        );
        assert_eq!(
            Config::from_json(&format!(r#"{{"profile": "{name}"}}"#)),
            Ok(config)
        );
    }
    assert_eq!(Config::from_json("{}"), Config::profile("paper"));
}

/// One field replaced changes that field and no other. Catches a merge that resets its siblings.
#[test]
fn merge_replaces_what_is_given() {
    let text = r#"{
        "profile": "icub",
        "body": {"muscles": {"kd": 20}, "joints": {"elbow": {"upper_deg": 100}}},
        "reach": {"distance_m": [0.11, 0.19]}
    }"#;
    let mut expected = Config::profile("icub").unwrap();
    expected.body.muscles.kd = 20.0;
    expected.body.joints.get_mut("elbow").unwrap().upper_deg = 100.0;
    expected.reach.distance_m = [0.11, 0.19];
    assert_eq!(Config::from_json(text), Ok(expected));
}

/// TOML and JSON say the same. Catches integers that only one of them takes for numbers.
#[test]
fn toml_equals_json() {
    let toml = r#"
        profile = "icub"
        [body.arm]
        half_width_m = 0.012
        [body.joints.wrist_flexion]
        locked_deg = 10
        [reach]
        movement_s = 5
        b_range = [0.1, 0.9]
    "#;
    let json = r#"{"profile": "icub", "body": {"arm": {"half_width_m": 0.012},
        "joints": {"wrist_flexion": {"locked_deg": 10}}},
        "reach": {"movement_s": 5, "b_range": [0.1, 0.9]}}"#;
    let config = Config::from_toml(toml).unwrap();
    assert_eq!(config.reach.movement_s, 5.0);
    assert_eq!(Config::from_json(json), Ok(config));
}

/// Unknown fields are refused with their path at every level. Catches a typo that changes nothing.
#[test]
fn unknown_fields_are_named() {
    let cases = [
        (r#"{"bodi": {}}"#, "bodi"),
        (r#"{"body": {"arms": {}}}"#, "body.arms"),
        (r#"{"body": {"arm": {"uper_arm_m": 0.2}}}"#, "uper_arm_m"),
        (
            r#"{"body": {"joints": {"knee": {"lower_deg": 0, "upper_deg": 9}}}}"#,
            "joints.knee",
        ),
        (r#"{"body": {"joints": {"elbow": {"lower": 0}}}}"#, "lower"),
        (r#"{"body": {"eye": {"fov": 90}}}"#, "fov"),
        (r#"{"reach": {"distance": [0.1, 0.2]}}"#, "reach.distance"),
    ];
    for (json, path) in cases {
        assert!(refusal(json).contains(path), "{json}: {}", refusal(json));
    }
}

/// Values of a wrong type are named with their path.
#[test]
fn wrong_types_are_named() {
    let cases = [
        (r#"{"body": 3}"#, "body"),
        (
            r#"{"body": {"arm": {"upper_arm_m": "long"}}}"#,
            "body.arm.upper_arm_m",
        ),
        (
            r#"{"body": {"hand": {"finger_m": [0.1, 0.1]}}}"#,
            "body.hand.finger_m",
        ),
        (
            r#"{"body": {"joints": {"elbow": {"locked_deg": "no"}}}}"#,
            "body.joints.elbow.locked_deg",
        ),
        (
            r#"{"reach": {"physics_steps": 2.5}}"#,
            "reach.physics_steps",
        ),
        (r#"{"reach": {"physics_steps": -1}}"#, "reach.physics_steps"),
        (r#"{"reach": null}"#, "reach"),
        (r#"{"profile": 7}"#, "profile"),
        ("[1, 2]", "config: "),
        (r#""paper""#, "config: "),
        ("{", "document"),
        ("{} {}", "document"),
    ];
    for (json, path) in cases {
        assert!(refusal(json).contains(path), "{json}: {}", refusal(json));
    }
    assert!(refusal(r#"{"profile": "nao"}"#).contains("icub"));
}

/// JSON and TOML refuse the same things, and name the field. Catches a second value that replaces the
/// first in silence, and a number that becomes null.
#[test]
fn duplicate_fields_and_numbers_that_are_not_finite_are_named() {
    let refused = [
        (
            Config::from_json(r#"{"reach": {"movement_s": 5, "movement_s": 6}}"#),
            "reach",
            "duplicate",
        ),
        (
            Config::from_json(r#"{"reach": {"movement_s": 5}, "reach": {}}"#),
            "document",
            "duplicate",
        ),
        (
            Config::from_toml("[reach]\nmovement_s = 5\nmovement_s = 6"),
            "movement_s",
            "duplicate",
        ),
        (
            Config::from_toml("[reach]\nmovement_s = nan"),
            "reach.movement_s",
            "NaN is not finite",
        ),
        (
            Config::from_toml("[grasp]\ndiameters_m = [0.03, -inf]"),
            "grasp.diameters_m[1]",
            "-inf is not finite",
        ),
        (
            Config::from_json(r#"{"reach": {"movement_s": 1e400}}"#),
            "reach.movement_s",
            "out of range",
        ),
    ];
    for (config, field, problem) in refused {
        let error = config.unwrap_err().to_string();
        assert!(error.contains(field) && error.contains(problem), "{error}");
    }
}

/// Text that is nested deeper than any config is refused. Catches a stack that overflows.
#[test]
fn deep_text_is_refused() {
    let json = format!("{}1{}", r#"{"reach":"#.repeat(100_000), "}".repeat(100_000));
    let toml = format!("a = {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    let tables = format!("[{}a]", "a.".repeat(10_000));
    for refused in [
        Config::from_json(&json),
        Config::from_toml(&toml),
        Config::from_toml(&tables),
    ] {
        assert!(matches!(refused, Err(EnvError::Config { .. })));
    }
}

/// Values out of bounds are named with path, value and bound. Catches a field without a check: the
/// task would hang, divide by zero or fill the memory.
#[test]
fn numbers_out_of_bounds_are_named() {
    let cases = [
        (r#"{"body": {"muscles": {"kp": 0}}}"#, "muscles.kp = 0"),
        (
            r#"{"body": {"arm": {"forearm_m": -0.1}}}"#,
            "arm.forearm_m = -0.1",
        ),
        (
            r#"{"reach": {"distance_m": [0, 0.2]}}"#,
            "reach.distance_m[0]: 0 ",
        ),
        (
            r#"{"reach": {"distance_m": [0.2, 0.1]}}"#,
            "reach.distance_m[1]: 0.1 ",
        ),
        (
            r#"{"reach": {"success_radius_m": 0.1}}"#,
            "reach.success_radius_m: 0.1 ",
        ),
        (
            r#"{"reach": {"b_range": [0, 0.9]}}"#,
            "reach.b_range[0]: 0 ",
        ),
        (
            r#"{"reach": {"b_range": [0.5, 0.4]}}"#,
            "reach.b_range[1]: 0.4 ",
        ),
        (r#"{"reach": {"movement_s": 0}}"#, "reach.movement_s: 0 "),
        (
            r#"{"reach": {"movement_s": 1e9}}"#,
            "reach.movement_s: 1000000000 ",
        ),
        (
            r#"{"reach": {"settle_time_constants": -1}}"#,
            "reach.settle_time_constants: -1 ",
        ),
        (
            r#"{"reach": {"delta_posture_deg": 0}}"#,
            "reach.delta_posture_deg: 0 ",
        ),
        (
            r#"{"reach": {"settled_speed_rad_s": 0}}"#,
            "reach.settled_speed_rad_s: 0 ",
        ),
        (
            r#"{"reach": {"control_period_s": 0}}"#,
            "reach.control_period_s: 0 ",
        ),
        (
            r#"{"reach": {"control_period_s": 2}}"#,
            "reach.control_period_s: 2 ",
        ),
        (
            r#"{"reach": {"physics_steps": 0}}"#,
            "reach.physics_steps: 0 ",
        ),
        (
            r#"{"reach": {"physics_steps": 100000}}"#,
            "reach.physics_steps: 100000 ",
        ),
    ];
    for (json, words) in cases {
        assert!(refusal(json).contains(words), "{json}: {}", refusal(json));
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut config = Config::profile("paper").unwrap();
        config.reach.control_period_s = bad;
        let error = config.validate().unwrap_err().to_string();
        assert!(error.contains("reach.control_period_s"), "{error}");
    }
}

/// A body whose joint ranges leave no case is an error, not an endless search.
#[test]
fn config_without_room_says_so() {
    let json = r#"{"body": {"joints": {
        "shoulder": {"lower_deg": 0, "upper_deg": 2}, "elbow": {"lower_deg": 10, "upper_deg": 12}}}}"#;
    let task = ReachTask::new(Config::from_json(json).unwrap(), ReachOptions::default()).unwrap();
    let mut stream = babble_env::Stream::new(babble_env::Purpose::Test, 0, 0);
    let error = babble_env::ReachCase::draw_geometry(&task, &mut stream).unwrap_err();
    assert!(matches!(error, EnvError::NoLegalCase { .. }), "{error}");
}

/// A config file and what is wrong with it. The folder is gone after the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("babble_env-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn with(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Files are read by their ending; one that is missing or of another kind is named.
#[test]
fn files_are_read_or_named() {
    let folder = Folder::new("files");
    let toml = folder.with("body.toml", "[reach]\nmovement_s = 4.0\n");
    let json = folder.with("body.json", r#"{"reach": {"movement_s": 4.0}}"#);
    let config = Config::from_file(&toml).unwrap();
    assert_eq!(config.reach.movement_s, 4.0);
    assert_eq!(Config::from_file(&json), Ok(config));
    let bad = [
        folder.with("body.yaml", "reach: 1"),
        folder.0.join("missing.toml"),
    ];
    for path in bad {
        let error = Config::from_file(&path).unwrap_err().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
    let broken = folder.with("broken.toml", "[reach\n");
    assert!(Config::from_file(&broken).is_err());
    // Whatever is wrong in a file, its path is told.
    for text in [
        "profile = \"nao\"",
        "[body.arm]\nforearm_m = 0",
        "[reach]\nspeed = 1",
    ] {
        let path = folder.with("wrong.toml", text);
        let error = Config::from_file(&path).unwrap_err().to_string();
        assert!(error.contains("wrong.toml"), "{error}");
    }
}

/// Editors may begin UTF-8 with a byte order mark. Foreign, huge and endless files are refused.
#[test]
fn files_of_other_kinds_are_named() {
    let folder = Folder::new("kinds");
    let marked = [
        folder.with("marked.toml", "\u{feff}profile = \"icub\""),
        folder.with("marked.json", "\u{feff}{\"profile\": \"icub\"}"),
    ];
    for path in marked {
        assert_eq!(Config::from_file(&path), Config::profile("icub"));
    }
    let huge = folder.with("huge.toml", &"# nothing\n".repeat(200_000));
    let binary = folder.0.join("binary.json");
    fs::write(&binary, [0x89, b'P', b'N', b'G', 0xff]).unwrap();
    for (path, problem) in [
        (huge, "at most 1048576 bytes"),
        (binary, "not UTF-8"),
        (folder.0.join("folder.toml"), "not a file"),
    ] {
        if problem == "not a file" {
            fs::create_dir(&path).unwrap();
        }
        let error = Config::from_file(&path).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
}
