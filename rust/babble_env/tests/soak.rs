//! Random play, bad actions and resets for long: nothing panics, all that is shown is finite and in
//! its bounds, what is asked of a state before it is loaded holds of each, and the physics stays
//! physical. The long form is `cargo test --release --test soak -- --ignored --nocapture`.

mod playing;

use std::fmt;
use std::sync::Arc;

use babble_env::episode;
use babble_env::tasks::grasp::Region;
use babble_env::{
    Autoreset, Batch, Config, Control, GraspOptions, GraspTask, Purpose, ReachOptions, ReachTask,
    Reward, Stream, Task,
};
use playing::grasping::{CONTROLS, before_the_palm, grasp_with, with_control};
use playing::{bits, control, seeded};

/// Environments in a batch.
const ENVS: usize = 16;

/// The farthest that anything went.
#[derive(Debug, Default, Clone, Copy)]
struct Extremes {
    /// Depth of the object in arm and hand without an obstacle \[m\].
    depth: f64,
    /// The same where there is one, against which the arm's 200 N·m can press the object \[m\].
    wedged: f64,
    /// Speed of the object \[m/s\].
    speed: f64,
    /// Kinetic energy of the object \[J\].
    energy: f64,
    /// Speed of arm, thumb or finger \[rad/s\].
    turn: f64,
    /// How far arm, thumb or finger is beyond its range \[rad\].
    beyond: f64,
    /// Reward of a step.
    reward: f64,
    /// Episodes that ended.
    ends: u64,
    /// Control steps after which arm or hand touched the object.
    touching: u64,
}

/// What no play may lead to. Ten million steps led to 5.8 mm, 9.0 mm in rapier, in which an arm at its
/// most throws the object or closes on it; wedged 28 mm, 2.8 m/s, 0.44 J, 11 rad/s, 1.05 rad beyond a
/// range, which is soft, and a reward of 3.5.
const MOST: Extremes = Extremes {
    depth: 0.012,
    wedged: 0.04,
    speed: 4.0,
    energy: 0.7,
    turn: 16.0,
    beyond: 1.6,
    reward: 4.0,
    ends: u64::MAX,
    touching: u64::MAX,
};

impl Extremes {
    fn assert_bounded(&self, name: &str) {
        println!("{name}: {self}");
        for (what, found, most) in [
            ("depth", self.depth, MOST.depth),
            ("depth where wedged", self.wedged, MOST.wedged),
            ("speed", self.speed, MOST.speed),
            ("energy", self.energy, MOST.energy),
            ("turn", self.turn, MOST.turn),
            ("beyond range", self.beyond, MOST.beyond),
            ("reward", self.reward, MOST.reward),
        ] {
            assert!(found <= most, "{name}: {what} {found}, at most {most}");
        }
    }

    fn join(&mut self, other: &Self) {
        self.depth = self.depth.max(other.depth);
        self.wedged = self.wedged.max(other.wedged);
        self.speed = self.speed.max(other.speed);
        self.energy = self.energy.max(other.energy);
        self.turn = self.turn.max(other.turn);
        self.beyond = self.beyond.max(other.beyond);
        self.reward = self.reward.max(other.reward);
        self.ends += other.ends;
        self.touching += other.touching;
    }
}

impl fmt::Display for Extremes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.2} mm deep, {:.2} mm wedged, {:.2} m/s, {:.4} J, {:.2} rad/s, {:.3} rad beyond, reward {:.2}, {} ends, \
             {} in contact",
            1e3 * self.depth,
            1e3 * self.wedged,
            self.speed,
            self.energy,
            self.turn,
            self.beyond,
            self.reward,
            self.ends,
            self.touching
        )
    }
}

/// Actions of one environment: each held for some steps, so that arms and objects get somewhere.
struct Player {
    stream: Stream,
    action: Vec<f32>,
    left: u32,
}

impl Player {
    fn new(width: usize, seed: u64) -> Self {
        Self {
            stream: Stream::new(Purpose::Policy, seed, 0),
            action: vec![0.0; width],
            left: 0,
        }
    }

    fn draw(&mut self) -> &[f32] {
        if self.left == 0 {
            let stream = &mut self.stream;
            self.left = stream.uniform(1.0, 30.0) as u32;
            let size = match stream.uniform(0.0, 8.0) as u32 {
                0 => 0.0,
                1 => 1e-40,
                2 => 1e30,
                3 => 3.0,
                4 => 0.1,
                _ => 1.0,
            };
            // In some the whole is at its bounds, in others anywhere within.
            let extreme = stream.uniform(0.0, 1.0) < 0.4;
            for a in &mut self.action {
                let x = stream.uniform(-1.0, 1.0);
                *a = (size * if extreme { x.signum() } else { x }) as f32;
            }
        }
        self.left -= 1;
        &self.action
    }
}

/// Plays a batch for so many steps in all.
fn play<T: Task>(
    task: &Arc<T>,
    steps: usize,
    seed: u64,
    ask: impl Fn(&mut Batch<T>, usize, &mut Stream),
    look: impl Fn(&T, &T::State, &mut Extremes),
) -> Extremes {
    let width = task.action_len();
    let senses = task.spec().senses;
    let low: Vec<f32> = senses
        .iter()
        .flat_map(|e| &e.low)
        .map(|&x| x as f32)
        .collect();
    let high: Vec<f32> = senses
        .iter()
        .flat_map(|e| &e.high)
        .map(|&x| x as f32)
        .collect();
    let mut envs = seeded(task.clone(), ENVS, Autoreset::NextStep, 1, seed);
    let mut players: Vec<_> = (0..ENVS as u64)
        .map(|i| Player::new(width, seed + i))
        .collect();
    let mut stream = Stream::new(Purpose::Test, seed, 0);
    let mut extremes = Extremes::default();
    let ask_and_reset = |envs: &mut Batch<T>, i: usize, stream: &mut Stream| {
        ask(envs, i, stream);
        let mask: Vec<_> = (0..ENVS).map(|j| j == i).collect();
        // A case that cannot be played is forgotten, and the episode goes on.
        let _ = envs.reset(&mask);
    };
    for i in (0..ENVS).step_by(2) {
        ask_and_reset(&mut envs, i, &mut stream);
    }
    for step in 0..steps / ENVS {
        let mut actions: Vec<f32> = players.iter_mut().flat_map(|p| p.draw().to_vec()).collect();
        if step % 101 == 0 {
            let before = bits(&envs);
            let good = actions.clone();
            let at = stream.uniform(0.0, actions.len() as f64) as usize;
            actions[at] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][step % 3];
            envs.step(&actions).expect_err("not finite");
            assert!(bits(&envs) == before, "a refused action left a trace");
            actions = good;
        }
        if step % 67 == 66 {
            let i = stream.uniform(0.0, ENVS as f64) as usize;
            ask_and_reset(&mut envs, i, &mut stream);
        }
        envs.step(&actions).unwrap();
        for record in envs.records() {
            for (k, x) in record.senses.iter().enumerate() {
                assert!(low[k] <= *x && *x <= high[k], "sense {k} = {x}");
            }
            assert!(record.step.reward.is_finite());
            extremes.reward = extremes.reward.max(record.step.reward.abs());
            extremes.ends += u64::from(playing::ended(record));
        }
        for i in 0..ENVS {
            look(task, envs.state(i).unwrap(), &mut extremes);
        }
        if step % 7 == 0 {
            let mut state = envs.state(step % ENVS).unwrap().clone();
            episode::check(&**task, &mut state).unwrap();
        }
    }
    extremes
}

/// Every choice of options that changes how a task is played.
fn reaching() -> Vec<Arc<ReachTask>> {
    let mut tasks = Vec::new();
    for body in ["paper", "icub"] {
        for &of in Control::ALL {
            for (goal, reward, settled) in [
                (false, Reward::Progress, false),
                (false, Reward::Sparse, true),
                (true, Reward::Sparse, false),
            ] {
                let options = ReachOptions {
                    goal,
                    reward,
                    settled,
                    ..control(of)
                };
                let config = Config::profile(body).unwrap();
                tasks.push(Arc::new(ReachTask::new(config, options).unwrap()));
            }
        }
    }
    tasks
}

fn grasping(engine: &str, fingers: &str) -> Vec<Arc<GraspTask>> {
    let mut tasks = Vec::new();
    for body in ["paper", "icub"] {
        for of in CONTROLS {
            for (goal, reward, region, enclosure_reflex, max_episode_steps) in [
                (false, Reward::Progress, Region::PalmSide, false, 40),
                (false, Reward::Sparse, Region::PalmSide, true, 240),
                (true, Reward::Sparse, Region::Full, false, 60),
            ] {
                let options = GraspOptions {
                    goal,
                    reward,
                    region,
                    enclosure_reflex,
                    max_episode_steps,
                    ..with_control(of)
                };
                let json = format!(
                    r#"{{"profile": "{body}", "grasp": {{"any_diameter_between": true}},
                        "body": {{"engine": "{engine}", "grip": {{"fingers": "{fingers}"}}}}}}"#
                );
                tasks.push(grasp_with(&json, options));
            }
        }
    }
    tasks
}

fn soak_reaching(steps: usize) {
    let tasks = reaching();
    let mut all = Extremes::default();
    for (seed, task) in tasks.iter().enumerate() {
        // A step of a whole movement is as long as hundreds of others.
        let pattern = task.options.control == Control::Pattern;
        let share = steps / tasks.len() / if pattern { 10 } else { 1 };
        let ask = |envs: &mut Batch<ReachTask>, i: usize, _: &mut Stream| {
            // The case of another environment, which can be played.
            let case = envs.state((i + 1) % ENVS).unwrap().case;
            let request = babble_env::tasks::reach::CaseRequest {
                start: Some(case.hand),
                target: Some(case.target),
                ..Default::default()
            };
            envs.request(i, request).unwrap();
        };
        let look = |task: &ReachTask, state: &<ReachTask as Task>::State, to: &mut Extremes| {
            let q = task.arm.normalised(state.arm.q);
            assert!(q.iter().all(|q| (-1e-9..=1.0 + 1e-9).contains(q)), "{q:?}");
            to.turn = to.turn.max(state.arm.v[0].abs()).max(state.arm.v[1].abs());
        };
        all.join(&play(task, share, seed as u64, ask, look));
    }
    all.assert_bounded("reaching");
}

fn soak_grasping(engine: &str, fingers: &str, steps: usize) {
    let tasks = grasping(engine, fingers);
    let mut all = Extremes::default();
    for (seed, task) in tasks.iter().enumerate() {
        let extremes = play(
            task,
            steps / tasks.len(),
            seed as u64,
            ask_near,
            look_at_grasp,
        );
        all.join(&extremes);
    }
    all.assert_bounded(&format!("{engine}, {fingers} finger"));
}

/// Objects before the palm, where random hands touch them; some with an obstacle.
fn ask_near(envs: &mut Batch<GraspTask>, i: usize, stream: &mut Stream) {
    let mut near = before_the_palm(envs.task(), stream.uniform(0.02, 0.08));
    if stream.uniform(0.0, 1.0) < 0.3 {
        let centre = [stream.uniform(-0.3, 0.3), stream.uniform(-0.3, 0.3)];
        near.obstacle = Some(playing::grasping::obstacle(centre, 0.02));
    }
    envs.request(i, near).unwrap();
}

fn look_at_grasp(task: &GraspTask, state: &<GraspTask as Task>::State, to: &mut Extremes) {
    let robot = &task.robot;
    let world = &state.world;
    let depth = robot.penetration(world);
    if state.case.obstacle.is_none() {
        to.depth = to.depth.max(depth);
    } else {
        to.wedged = to.wedged.max(depth);
    }
    to.touching += u64::from(robot.touch(world).any());
    let speed = robot.object_velocity(world).norm();
    assert!(speed.is_finite());
    let radius = state.case.radius();
    let mass = task.config.body.object.density_kg_m3
        * (4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius);
    to.speed = to.speed.max(speed);
    to.energy = to.energy.max(0.5 * mass * speed * speed);
    for (i, turn) in robot.speeds(world).into_iter().enumerate() {
        assert!(turn.is_finite());
        to.turn = to.turn.max(turn.abs());
        let (q, [low, high]) = (robot.posture(world)[i], robot.ranges()[i]);
        to.beyond = to.beyond.max(low - q).max(q - high);
    }
}

#[test]
fn a_short_soak_of_reaching() {
    soak_reaching(120_000);
}

#[test]
fn a_short_soak_of_grasping() {
    soak_grasping("tree", "virtual", 20_000);
    soak_grasping("tree", "independent", 4_000);
    soak_grasping("rapier", "virtual", 3_000);
}

#[test]
#[ignore = "ten million steps of each task take twelve minutes"]
fn a_long_soak() {
    soak_reaching(10_000_000);
    soak_grasping("tree", "virtual", 9_000_000);
    soak_grasping("tree", "independent", 800_000);
    soak_grasping("rapier", "virtual", 200_000);
}
