//! What a physics step of grasping costs without senses: CPU time of the thread.
//!
//! `cargo bench --bench physics` measures all scenes; with the arguments `SCENE CONFIG SECONDS`,
//! SCENE `free` or `held`, CONFIG as in [`Config::from_json`], one, and prints it as JSON.
//! bench/twin.py does the same with `MuJoCo`.

use std::error::Error;
use std::time::{Duration, Instant};

use babble_body::robot::{Ball, Setup, World, towards};
use babble_env::{Config, GraspOptions, GraspTask, Purpose, Stream};
use rustix::time::{ClockId, clock_gettime};

/// Where random equilibrium points are: shoulder, elbow, thumb, fingers \[rad\].
const TARGETS: [[f64; 2]; 4] = [[-1.2, 1.2], [0.1, 1.6], [0.0, 1.57], [0.0, 1.57]];
/// Time between two of them \[s\].
const TARGET_S: f64 = 0.5;
/// Targets until the motion begins anew from the same world: ten seconds.
const BLOCK_TARGETS: usize = 20;
/// Time that the hand closes on the object, and that it then holds it before the clock starts \[s\].
const CLOSING_S: f64 = 3.0;
const SETTLING_S: f64 = 0.5;
/// An object further than this from its place in the hand has been dropped \[m\].
const SLIP_M: f64 = 0.02;
const RADIUS_M: f64 = 0.025;
/// The arm stretched along x, and an object out of its reach.
const ARM: [f64; 2] = [0.0, 0.0];
const AWAY: [f64; 2] = [0.0, -0.8];

#[derive(Clone, Copy, PartialEq)]
enum Scene {
    Free,
    Held,
}

struct Robot {
    task: GraspTask,
    scene: Scene,
    random: Stream,
}

impl Robot {
    fn new(config: &str, scene: Scene) -> Result<Self, Box<dyn Error>> {
        Ok(Self {
            task: GraspTask::new(Config::from_json(config)?, GraspOptions::default())?,
            scene,
            random: Stream::new(Purpose::Test, 0, 0),
        })
    }

    /// The world that every block begins with.
    fn start(&self) -> World {
        let robot = &self.task.robot;
        let centre = match self.scene {
            Scene::Free => AWAY,
            Scene::Held => self.task.before_palm(ARM, RADIUS_M, 0.001),
        };
        let ball = Ball {
            centre,
            radius: RADIUS_M,
        };
        let mut world = robot.world(&Setup {
            posture: robot.open_hand(ARM),
            ball,
            support: true,
            obstacle: None,
        });
        if self.scene == Scene::Held {
            let [thumb, fingers] = self.task.reflex();
            let closed = [ARM[0], ARM[1], thumb, fingers];
            self.steps(&mut world, closed, CLOSING_S);
            robot.remove_support(&mut world);
            self.steps(&mut world, closed, SETTLING_S);
        }
        world
    }

    /// Steps for some time \[s\]; returns the number of steps.
    fn steps(&self, world: &mut World, to: [f64; 4], seconds: f64) -> u32 {
        let drive = towards(to);
        let steps = (seconds / self.task.config.grasp.physics_step_s()).round() as u32;
        for _ in 0..steps {
            self.task.robot.step(world, &drive);
        }
        steps
    }

    /// Random equilibrium points of the arm, and of the hand if it is free.
    fn draw_target(&mut self) -> [f64; 4] {
        let mut target = TARGETS.map(|[low, high]| self.random.uniform(low, high));
        if self.scene == Scene::Held {
            [target[2], target[3]] = self.task.reflex();
        }
        target
    }

    /// CPU and clock time of one step.
    fn measure(&mut self, seconds: f64) -> Result<[Duration; 2], Box<dyn Error>> {
        let start = self.start();
        let in_hand = self.task.pocket_offset(&start, RADIUS_M);
        let (mut steps, mut cpu, mut clock) = (0, Duration::ZERO, Duration::ZERO);
        while clock.as_secs_f64() < seconds {
            let mut world = start.clone();
            for _ in 0..BLOCK_TARGETS {
                let target = self.draw_target();
                let (cpu_before, before) = (cpu_time(), Instant::now());
                steps += self.steps(&mut world, target, TARGET_S);
                cpu += cpu_time().saturating_sub(cpu_before);
                clock += before.elapsed();
            }
            let slip = self.task.pocket_offset(&world, RADIUS_M) - in_hand;
            if self.scene == Scene::Held && slip.amax() > SLIP_M {
                return Err(format!("the object was dropped within {steps} steps").into());
            }
        }
        Ok([cpu / steps, clock / steps])
    }
}

fn cpu_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn microseconds(time: Duration) -> f64 {
    1e6 * time.as_secs_f64()
}

fn all() -> Result<(), Box<dyn Error>> {
    for (fingers, degrees) in [("virtual", 9), ("independent", 18)] {
        let config = format!(r#"{{"body": {{"grip": {{"fingers": "{fingers}"}}}}}}"#);
        for (name, scene) in [("free", Scene::Free), ("held", Scene::Held)] {
            let [cpu, _] = Robot::new(&config, scene)?.measure(1.0)?;
            let cpu = microseconds(cpu);
            println!("physics step, {degrees} degrees of freedom, {name}: {cpu:.2} µs CPU");
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench`.
    let given: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| argument != "--bench")
        .collect();
    let [scene, config, seconds] = given.as_slice() else {
        return all();
    };
    let scene = match scene.as_str() {
        "free" => Scene::Free,
        "held" => Scene::Held,
        other => return Err(format!("scene {other:?} is not free or held").into()),
    };
    let [cpu, clock] = Robot::new(config, scene)?.measure(seconds.parse()?)?;
    let (cpu, clock) = (microseconds(cpu), microseconds(clock));
    println!(r#"{{"cpu_us": {cpu}, "clock_us": {clock}}}"#);
    Ok(())
}
