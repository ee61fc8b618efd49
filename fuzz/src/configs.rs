//! Configs: refused by name, or tasks can be made of them.

use babble_env::{Config, EnvError, GraspOptions, GraspTask, ReachOptions, ReachTask, Task};

/// A config in TOML or in JSON. Whether it is one.
pub fn config(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let mut taken = false;
    for read in [Config::from_toml, Config::from_json] {
        match read(text) {
            Ok(config) => {
                used(&config);
                taken = true;
            }
            Err(EnvError::Config { .. } | EnvError::Body(_) | EnvError::Option { .. }) => {}
            Err(other) => panic!("refused by another name: {other}"),
        }
    }
    taken
}

fn used(config: &Config) {
    let json = config.to_json().expect("JSON");
    let again = Config::from_json(&json).expect("a config that was written is one");
    assert_eq!(&again, config);
    let reach = ReachTask::new(config.clone(), ReachOptions::default()).expect("a task");
    sound(&reach);
    assert!(reach.settle_steps() <= 120_000);
    match GraspTask::new(config.clone(), GraspOptions::default()) {
        Ok(task) => sound(&task),
        // A bent hand, which only reaching has.
        Err(EnvError::Config { .. }) => {}
        Err(other) => panic!("refused by another name: {other}"),
    }
}

/// Its spaces are there, and its movements end.
fn sound<T: Task>(task: &T) {
    for entry in task.spec().senses {
        let ordered = entry
            .low
            .iter()
            .zip(&entry.high)
            .all(|(low, high)| low < high);
        assert!(ordered, "{entry:?}");
    }
}
