//! A batch of environments that plays requests. It knows no network.

use std::cell::Cell;
use std::sync::Arc;
use std::time::{Duration, Instant};

use babble_env::batch::Record;
use babble_env::case::CasePart;
use babble_env::picture::View;
use babble_env::registry::{self, TaskEntry};
use babble_env::spec::Spec;
use babble_env::{
    AnyBatch, AnyTask, Autoreset, CaseValue, CaseValues, Config, EnvError, Executor, Options,
    Purpose, seeding,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbImage};
use serde_json::Value;
use tokio::runtime::{Handle, RuntimeFlavor};
use tokio::task::block_in_place;

use crate::fault::{Fault, Kind};
use crate::limits::Limits;
use crate::wire::{
    Bytes, CaseMap, GoalReward, Make, Raw, Render, Reset, Save, Scenarios, Shown, Stepped,
};

/// Physics steps that one step of an environment may take, which nothing interrupts: about 0.1 s.
const PHYSICS_STEPS: u64 = 100_000;
/// Physics steps of rapier that loading a state may repeat, which nothing interrupts: about 1 s.
const REPLAYED_STEPS: u64 = 10_000;

thread_local! {
    /// When the request that runs in this thread has had its time.
    static DEADLINE: Cell<Option<Instant>> = const { Cell::new(None) };
    /// Whether the thread was lent to others during this request.
    static LENT: Cell<bool> = const { Cell::new(false) };
}

/// Asked every 50 ms of a request.
fn is_late() -> bool {
    if !LENT.replace(true) {
        lend_thread();
    }
    DEADLINE
        .get()
        .is_some_and(|deadline| Instant::now() > deadline)
}

/// Lets another thread take up what else waits for this one, if it serves connections: a request that
/// was expected to be short is not. A moment's wait gives the other thread time to do so.
fn lend_thread() {
    let runtime = Handle::try_current().map(|handle| handle.runtime_flavor());
    if matches!(runtime, Ok(RuntimeFlavor::MultiThread)) {
        block_in_place(|| std::thread::sleep(Duration::from_millis(5)));
    }
}

/// A batch of environments, and what was asked when it was made.
#[derive(Debug)]
pub struct Session {
    /// Id of the environments.
    pub env: String,
    /// Their task, as the registry has it.
    pub entry: &'static TaskEntry,
    /// The complete config and options.
    pub task: Arc<dyn AnyTask>,
    /// All options by name.
    pub options: Options,
    /// When an ended episode begins anew.
    pub autoreset: Autoreset,
    /// What the environments show.
    pub spec: Spec,
    batch: Box<dyn AnyBatch>,
    /// Edge of the eye's image, where observations have one \[pixel\].
    retina: Option<u32>,
    seeded: bool,
    limits: Limits,
}

impl Session {
    /// Environments that have to be reset before they can step, in at most so many threads.
    ///
    /// # Errors
    /// [`Fault`] for an id, option or config that is refused, or beyond the limits.
    pub fn make(asked: &Make, limits: &Limits, threads: usize) -> Result<Self, Fault> {
        let n = asked.num_envs;
        let (entry, row) = registry::environment(&asked.env)?;
        let task = registry::make(&asked.env, read_config(&asked.config)?, &asked.options)?;
        check_steps(&*task)?;
        let options = all_options(entry, row.presets, &asked.options);
        let autoreset: Autoreset = asked.autoreset.parse()?;
        let retina = (options.get("obs").and_then(Value::as_str) == Some("retina"))
            .then(|| options.get("retina_size").and_then(Value::as_u64))
            .flatten()
            .map(|size| size as u32);
        let image = retina.map_or(0, |size| 3 * size as usize * size as usize);
        let spec = task.spec();
        let senses: usize = spec.senses.iter().map(|entry| entry.labels.len()).sum();
        let bytes = n.saturating_mul(image + 8 * (senses + 64));
        if bytes > limits.message_bytes {
            return Err(Fault::limit(
                "bytes of an observation",
                bytes,
                limits.message_bytes,
            ));
        }
        let wanted = asked.threads.unwrap_or(n / entry.envs_per_thread);
        let executor = Executor::new(wanted.clamp(1, threads))?.interrupted_by(is_late);
        let batch = Arc::clone(&task).batch(n, autoreset, executor)?;
        Ok(Self {
            env: asked.env.clone(),
            entry,
            task,
            options,
            autoreset,
            spec,
            batch,
            retina,
            seeded: false,
            limits: limits.clone(),
        })
    }

    /// How many environments there are.
    #[must_use]
    pub fn envs(&self) -> usize {
        self.batch.envs()
    }

    /// What an observation consists of.
    #[must_use]
    pub fn obs(&self) -> &str {
        let obs = self.options.get("obs");
        obs.and_then(Value::as_str).unwrap_or_default()
    }

    /// Edge of the eye's image in an observation, if it has one \[pixel\].
    #[must_use]
    pub const fn retina(&self) -> Option<u32> {
        self.retina
    }

    /// Threads that step them.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.batch.threads()
    }

    /// Does a request within its time.
    pub fn timed<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        LENT.set(false);
        DEADLINE.set(Instant::now().checked_add(self.limits.request_time));
        let done = work(self);
        DEADLINE.set(None);
        done
    }

    /// Begins new episodes.
    ///
    /// # Errors
    /// [`Fault`] for lists of a wrong length and cases that cannot be played; all episodes go on.
    pub fn reset(&mut self, asked: &Reset) -> Result<Stepped, Fault> {
        let n = self.envs();
        let mask = self.mask(asked.mask.as_ref())?;
        if let Some(seeds) = &asked.seeds {
            check_length("seeds", seeds.len(), n)?;
        }
        let requests = match &asked.cases {
            Some(cases) => self.requests(cases)?,
            None => vec![None; n],
        };
        self.seed(asked.seeds.as_deref(), &mask)?;
        for (i, request) in requests.into_iter().enumerate() {
            if let Some(request) = request.filter(|_| mask[i]) {
                self.batch.request(i, &request)?;
            }
        }
        self.batch.reset(&mask)?;
        self.stepped()
    }

    fn mask(&self, asked: Option<&Bytes>) -> Result<Vec<bool>, Fault> {
        let n = self.envs();
        let Some(Raw(mask)) = asked else {
            return Ok(vec![true; n]);
        };
        check_length("mask", mask.len(), n)?;
        if let Some(other) = mask.iter().find(|&&x| x > 1) {
            return Err(config(format!("mask has {other}, expected 0 or 1")));
        }
        Ok(mask.iter().map(|&x| x == 1).collect())
    }

    fn requests(&self, cases: &[Option<CaseMap>]) -> Result<Vec<Option<CaseValues>>, Fault> {
        check_length("cases", cases.len(), self.envs())?;
        let parts = self.task.case_parts();
        let read = |case: &Option<CaseMap>| {
            let Some(case) = case else { return Ok(None) };
            Ok(Some(read_case(parts, case)?))
        };
        cases.iter().map(read).collect()
    }

    /// Environments that were never seeded are seeded by chance.
    fn seed(&mut self, seeds: Option<&[Option<u64>]>, mask: &[bool]) -> Result<(), Fault> {
        for (i, &masked) in mask.iter().enumerate() {
            let given = seeds.and_then(|seeds| seeds[i]);
            let given = given.filter(|_| masked || !self.seeded);
            let seed = match given {
                Some(seed) => seed,
                None if self.seeded => continue,
                None => by_chance()?,
            };
            self.batch.seed(i, seeding::stream_seed(seed))?;
        }
        self.seeded = true;
        Ok(())
    }

    /// One step of all environments.
    ///
    /// # Errors
    /// [`Fault`] for actions of a wrong shape or not finite, and environments that need a reset; then
    /// nothing was stepped. After another all environments need a reset.
    pub fn step(&mut self, actions: &[f32]) -> Result<Stepped, Fault> {
        self.batch.step(actions)?;
        self.stepped()
    }

    fn stepped(&self) -> Result<Stepped, Fault> {
        let all = 0..self.envs();
        let now: Vec<(usize, &Record)> = all
            .clone()
            .filter_map(|i| Some((i, self.batch.record(i)?)))
            .collect();
        let ended: Vec<(usize, &Record)> = all
            .filter_map(|i| Some((i, self.batch.final_record(i)?)))
            .collect();
        let last = (!ended.is_empty()).then(|| self.shown(&ended, true));
        Ok(Stepped {
            now: self.shown(&now, false)?,
            ended: Raw(ended.iter().map(|&(i, _)| i as u32).collect()),
            last: last.transpose()?,
        })
    }

    /// What some environments show, or showed when their episodes ended.
    fn shown(&self, records: &[(usize, &Record)], ended: bool) -> Result<Shown, Fault> {
        let spec = &self.spec;
        let mut shown = Shown::default();
        let code = |name| spec.outcomes.iter().position(|&known| known == name);
        let facts = spec.facts.len();
        let terms = spec.reward_terms.len();
        let measures = spec.measures_len();
        for &(i, record) in records {
            shown.senses.0.extend_from_slice(&record.senses);
            shown.achieved.0.extend_from_slice(&record.achieved);
            shown.desired.0.extend_from_slice(&record.desired);
            shown.reward.0.push(record.step.reward);
            shown.terminated.0.push(record.step.terminated.into());
            shown.truncated.0.push(record.step.truncated.into());
            let outcome = code(record.info.outcome.name()).unwrap_or_default();
            shown.outcome.0.push(outcome as u8);
            let known = record.info.facts[..facts].iter();
            shown.facts.0.extend(known.map(|&fact| u8::from(fact)));
            shown.terms.0.extend_from_slice(&record.step.terms[..terms]);
            shown
                .measures
                .0
                .extend_from_slice(&record.info.measures[..measures]);
            if let Some(size) = self.retina {
                let image = if ended {
                    self.batch.final_picture(i, View::Eye, [size; 2])?
                } else {
                    Some(self.batch.picture(i, View::Eye, [size; 2], None)?)
                };
                shown
                    .retina
                    .0
                    .extend(image.map(RgbImage::into_raw).unwrap_or_default());
            }
        }
        Ok(shown)
    }

    /// States of environments.
    ///
    /// # Errors
    /// [`Fault`] for an environment that there is not.
    pub fn save(&self, asked: &Save) -> Result<Vec<Option<Bytes>>, Fault> {
        let all = || (0..self.envs()).collect();
        let envs: Vec<usize> = asked.envs.clone().unwrap_or_else(all);
        if envs.len() > self.envs() {
            return Err(Fault::limit("states at once", envs.len(), self.envs()));
        }
        let mut bytes = 0;
        let mut states = Vec::with_capacity(envs.len());
        for i in envs {
            let state = if asked.ended {
                self.batch.save_final(i)?
            } else {
                Some(self.batch.save(i)?)
            };
            bytes += state.as_ref().map_or(0, Vec::len);
            if bytes > self.limits.message_bytes {
                return Err(Fault::limit(
                    "bytes of the states",
                    bytes,
                    self.limits.message_bytes,
                ));
            }
            states.push(state.map(Raw));
        }
        Ok(states)
    }

    /// Continues environments from states.
    ///
    /// # Errors
    /// [`Fault`] for a state that is refused; all environments are as they were.
    pub fn load(&mut self, states: &[Option<Bytes>]) -> Result<(), Fault> {
        check_length("states", states.len(), self.envs())?;
        let mut before = Vec::new();
        let loaded = self.load_each(states, &mut before);
        if loaded.is_err() {
            for (i, was) in before {
                self.batch.load(i, &was)?;
            }
        }
        self.seeded |= loaded.is_ok() && states.iter().all(Option::is_some);
        loaded
    }

    /// Loads states and keeps those of before.
    fn load_each(
        &mut self,
        states: &[Option<Bytes>],
        before: &mut Vec<(usize, Vec<u8>)>,
    ) -> Result<(), Fault> {
        for (i, state) in states.iter().enumerate() {
            let Some(Raw(state)) = state else { continue };
            if is_late() {
                let message = "loading took longer than this server allows; nothing was loaded";
                return Err(Fault::new(Kind::LimitError, message));
            }
            let was = self.batch.save(i)?;
            self.batch.load(i, state).map_err(|error| {
                let Fault { kind, message } = error.into();
                Fault::new(kind, format!("states[{i}]: {message}"))
            })?;
            before.push((i, was));
        }
        Ok(())
    }

    /// A number that two states share only if they are the same to the bit.
    ///
    /// # Errors
    /// [`Fault`] for an environment that there is not.
    pub fn hash(&self, env: usize) -> Result<u64, Fault> {
        Ok(self.batch.state_hash(env)?)
    }

    /// The running case of an environment.
    ///
    /// # Errors
    /// [`Fault`] for an environment that there is not.
    pub fn case(&self, env: usize) -> Result<CaseMap, Fault> {
        Ok(case_map(&self.batch.case(env)?))
    }

    /// The recorded way of the hand, x and y of one control step after the other \[m\].
    ///
    /// # Errors
    /// [`Fault`] for an environment that there is not.
    pub fn trail(&self, env: usize) -> Result<Vec<f64>, Fault> {
        Ok(self.batch.trail(env)?.into_flattened())
    }

    /// Recorded moments since the reset.
    ///
    /// # Errors
    /// [`Fault`] for an environment that there is not.
    pub fn moments(&self, env: usize) -> Result<usize, Fault> {
        Ok(self.batch.moments(env)?)
    }

    /// A picture, as pixels or as a PNG file.
    ///
    /// # Errors
    /// [`Fault`] for an environment, camera, size or moment that there is not, or a refused state.
    pub fn render(&self, asked: &Render) -> Result<Vec<u8>, Fault> {
        let pixels = u64::from(asked.width) * u64::from(asked.height);
        if pixels > self.limits.picture_pixels {
            return Err(Fault::limit(
                "width × height",
                pixels,
                self.limits.picture_pixels,
            ));
        }
        let view: View = asked.camera.parse()?;
        let size = [asked.width, asked.height];
        let image = match &asked.state {
            None => self.batch.picture(asked.env, view, size, asked.moment)?,
            Some(Raw(state)) => {
                let one = Executor::new(1)?.interrupted_by(is_late);
                let mut other = Arc::clone(&self.task).batch(1, Autoreset::Disabled, one)?;
                other.load(0, state)?;
                other.picture(0, view, size, asked.moment)?
            }
        };
        if asked.png {
            png(&image)
        } else {
            Ok(image.into_raw())
        }
    }

    /// Rewards of the goal form.
    ///
    /// # Errors
    /// [`Fault`] for goals of a wrong shape.
    pub fn goal_reward(&self, asked: &GoalReward) -> Result<Vec<f64>, Fault> {
        let width = self.spec.goal_len();
        if width == 0 {
            return Err(config(
                "goal_reward: the observations have no goals; make with obs=\"goal\"",
            ));
        }
        let (achieved, desired) = (&asked.achieved.0, &asked.desired.0);
        check_length("desired", desired.len(), achieved.len())?;
        if !achieved.len().is_multiple_of(width) {
            return Err(config(format!(
                "achieved has {} numbers, expected a multiple of {width}",
                achieved.len()
            )));
        }
        if let Some(x) = achieved.iter().chain(desired).find(|x| !x.is_finite()) {
            return Err(config(format!("a goal has {x}: goals must be finite")));
        }
        let pairs = achieved
            .chunks_exact(width)
            .zip(desired.chunks_exact(width));
        Ok(pairs.map(|(a, d)| self.task.goal_reward(a, d)).collect())
    }

    /// Cases of a protocol.
    ///
    /// # Errors
    /// [`Fault`] for a protocol that there is not, or more cases than environments are allowed.
    pub fn scenarios(&self, asked: &Scenarios) -> Result<Vec<Option<CaseMap>>, Fault> {
        if asked.n > self.limits.envs_per_session {
            return Err(Fault::limit("n", asked.n, self.limits.envs_per_session));
        }
        let purpose = match &asked.split {
            None => Purpose::Test,
            Some(split) => split.parse()?,
        };
        let mut executor = Executor::new(1)?.interrupted_by(is_late);
        let drawn = self
            .task
            .cases(&asked.protocol, asked.n, asked.seed, purpose, &mut executor);
        let cases = drawn.map_err(|error| match error {
            EnvError::Interrupted => Fault::new(
                Kind::LimitError,
                format!(
                    "n = {}: drawing the cases took longer than this server allows; ask for fewer",
                    asked.n
                ),
            ),
            other => other.into(),
        })?;
        Ok(cases
            .iter()
            .map(|case| case.as_ref().map(case_map))
            .collect())
    }

    /// Environment `i`'s last observation and what it shows beside, for a batch of one.
    #[must_use]
    pub fn record(&self, i: usize) -> Option<&Record> {
        self.batch.record(i)
    }
}

/// Refuses what would take long and cannot be interrupted.
fn check_steps(task: &dyn AnyTask) -> Result<(), Fault> {
    for (what, steps, most) in [
        (
            "physics steps of one step",
            task.most_physics_steps(),
            PHYSICS_STEPS,
        ),
        (
            "physics steps that loading a state repeats",
            task.most_replayed_steps(),
            REPLAYED_STEPS,
        ),
    ] {
        if steps > most {
            return Err(Fault::limit(what, steps, most));
        }
    }
    Ok(())
}

/// All options of an environment by name, with the defaults of those not given.
fn all_options(entry: &TaskEntry, presets: &[(&str, &str)], given: &Options) -> Options {
    let defaults = entry.options.iter().map(|option| {
        let value = serde_json::to_value(option.default).unwrap_or_default();
        (option.name.to_owned(), value)
    });
    let mut all: Options = defaults.collect();
    all.extend(registry::presets(presets));
    all.extend(given.clone());
    all
}

/// A config as a client gives it. No name of a file is one.
fn read_config(given: &Value) -> Result<Config, Fault> {
    Ok(match given {
        Value::Null => Config::profile("paper")?,
        Value::String(name) => Config::profile(name)?,
        document => Config::from_json(&document.to_string())?,
    })
}

fn read_case(parts: &'static [CasePart], case: &CaseMap) -> Result<CaseValues, EnvError> {
    for (name, value) in &case.0 {
        let numbers = match value {
            CaseValue::Number(number) => std::slice::from_ref(number),
            CaseValue::Numbers(numbers) => numbers,
            CaseValue::Absent | CaseValue::Flag(_) => &[],
        };
        if let (Some(number), Some(part)) = (
            numbers.iter().find(|x| !x.is_finite()),
            parts.iter().find(|part| part.name == name),
        ) {
            return Err(EnvError::CaseValue {
                part: part.name,
                value: number.to_string(),
                expected: "finite numbers".to_owned(),
            });
        }
    }
    let given = case
        .0
        .iter()
        .map(|(name, value)| (name.as_str(), value.clone()));
    CaseValues::read(parts, given)
}

fn case_map(case: &CaseValues) -> CaseMap {
    let named = case
        .iter()
        .map(|(name, value)| (name.to_owned(), value.clone()));
    CaseMap(named.collect())
}

fn png(image: &RgbImage) -> Result<Vec<u8>, Fault> {
    let mut file = Vec::new();
    let written = PngEncoder::new(&mut file).write_image(
        image,
        image.width(),
        image.height(),
        ExtendedColorType::Rgb8,
    );
    written.map_err(|error| Fault::new(Kind::ServerError, error.to_string()))?;
    Ok(file)
}

fn by_chance() -> Result<u64, Fault> {
    getrandom::u64().map_err(|error| Fault::new(Kind::ServerError, error.to_string()))
}

fn config(message: impl Into<String>) -> Fault {
    Fault::new(Kind::ConfigError, message)
}

fn check_length(what: &str, got: usize, expected: usize) -> Result<(), Fault> {
    if got == expected {
        return Ok(());
    }
    Err(config(format!(
        "{what} has {got} values, expected {expected}"
    )))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    use crate::session::is_late;

    /// There is one thread: without lending it, the second task would wait for the first.
    #[tokio::test(flavor = "multi_thread", worker_threads = 1)]
    async fn long_work_lends_its_thread_to_others() {
        let heard = Arc::new(AtomicBool::new(false));
        let (hears, says) = (Arc::clone(&heard), heard);
        let long = tokio::spawn(async move {
            let other = tokio::spawn(async move { says.store(true, Ordering::Relaxed) });
            let began = Instant::now();
            while !hears.load(Ordering::Relaxed) && began.elapsed() < Duration::from_secs(60) {
                is_late();
                sleep(Duration::from_millis(1));
            }
            (hears.load(Ordering::Relaxed), other)
        });
        let (is_heard, other) = long.await.unwrap();
        other.await.unwrap();
        assert!(is_heard);
    }
}
