//! Moving a point as a task: what its parts are together.

use image::{Rgb, RgbImage};
use serde::Serialize;

use super::entry::ENTRY;
use super::episode::{self, PointState, TargetRequest};
use super::task::PointTask;
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::outcome::Outcome;
use crate::picture::{View, no_such_frame};
use crate::progress::{Ending, Lifecycle, Progress, SUCCESS_FACTS};
use crate::spec::{Entry, Spec};
use crate::stream::{Purpose, Stream};
use crate::task::{MAX_TERMS, Task};

impl Task for PointTask {
    type Request = TargetRequest;
    type Drawn = [f64; 2];
    type State = PointState;
    type Derived = ();
    type Potential = ();

    const NAME: &'static str = "moving a point";
    const MAGIC: [u8; 4] = *b"BBPT";
    const OUTCOMES: &'static [Outcome] = &[Outcome::Running, Outcome::Success, Outcome::Timeout];
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn config(&self) -> &Config {
        &self.config
    }

    fn min_per_thread(&self) -> usize {
        ENTRY.envs_per_thread
    }

    fn action_len(&self) -> usize {
        2
    }

    fn senses_len(&self) -> usize {
        5
    }

    fn spec(&self) -> Spec {
        let entry = |name, labels: &[&'static str], low, description| Entry {
            name,
            labels: labels.to_vec(),
            low: vec![low; labels.len()],
            high: vec![1.0; labels.len()],
            unit: "m".into(),
            description,
        };
        Spec {
            senses: vec![
                entry("position", &["x", "y"], -1.0, "where the point is"),
                entry("target", &["x", "y"], -1.0, "where it should be"),
                entry("time", &["elapsed"], 0.0, "share of the episode"),
            ],
            goals: vec![],
            action: entry("action", &["x", "y"], -1.0, "velocity, 0.1 m a step"),
            reward_terms: &["success"],
            reward_bounds: [0.0, 1.0],
            facts: &SUCCESS_FACTS,
            measures: &[],
            outcomes: Self::OUTCOMES
                .iter()
                .map(|outcome| outcome.name())
                .collect(),
            max_episode_steps: self.max_episode_steps,
            control_hz: 20.0,
        }
    }

    fn fingerprint(&self) -> impl Serialize {
        self.max_episode_steps
    }

    fn shared(state: &PointState) -> (&Progress, &Lifecycle<TargetRequest>) {
        (&state.progress, &state.lifecycle)
    }

    fn shared_mut(state: &mut PointState) -> (&mut Progress, &mut Lifecycle<TargetRequest>) {
        (&mut state.progress, &mut state.lifecycle)
    }

    fn fresh(&self, lifecycle: Lifecycle<TargetRequest>) -> PointState {
        episode::fresh(lifecycle)
    }

    fn check(&self, state: &mut PointState) -> Result<(), EnvError> {
        episode::check(state)
    }

    fn derive(&self, _: &PointState) {}

    fn draw(
        &self,
        request: &TargetRequest,
        stream: &mut Stream,
        _: &Stop<'_>,
    ) -> Result<[f64; 2], EnvError> {
        episode::draw(request, stream)
    }

    fn begin(&self, state: &mut PointState, target: [f64; 2]) {
        episode::begin(self, state, target);
    }

    fn ending(&self) -> Ending {
        Ending {
            goal: false,
            goes_on: false,
            single_step: false,
            max_steps: self.max_episode_steps,
        }
    }

    fn potential(&self, _: &PointState) {}

    fn advance(
        &self,
        state: &mut PointState,
        (): &mut (),
        action: &[f32],
    ) -> Result<bool, EnvError> {
        Ok(episode::advance(self, state, action))
    }

    fn reward_terms(&self, state: &PointState, (): ()) -> [f64; MAX_TERMS] {
        let success = f64::from(u8::from(state.progress.is_success));
        [success, 0.0, 0.0, 0.0]
    }

    fn observe(&self, state: &PointState, (): &(), out: &mut [f32]) {
        episode::observe(self, state, out);
    }

    fn request(&self, asked: &CaseValues) -> TargetRequest {
        TargetRequest {
            target: asked.numbers("target"),
        }
    }

    fn case(&self, state: &PointState) -> CaseValues {
        CaseValues::default().with("target", state.target)
    }

    fn cases(
        &self,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError> {
        ENTRY.protocol(protocol)?;
        executor.map(0..n, |i, _| {
            let target = Self::sample(&mut Stream::new(purpose, seed, i as u64));
            Ok(Some(CaseValues::default().with("target", target)))
        })
    }

    fn trail(&self, state: &PointState) -> Vec<[f64; 2]> {
        state.trail.clone()
    }

    fn moments(&self, state: &PointState) -> usize {
        state.trail.len()
    }

    fn picture(
        &self,
        state: &PointState,
        _: View,
        [width, height]: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        let moments = state.trail.len();
        let position = match frame {
            None => state.position,
            Some(k) => *state
                .trail
                .get(k)
                .ok_or_else(|| no_such_frame(k, moments))?,
        };
        let mut image = RgbImage::from_pixel(width, height, Rgb([255; 3]));
        for ([x, y], colour) in [(state.target, [217, 38, 31]), (position, [30, 60, 90])] {
            let column = (0.5 * (x + 1.0) * f64::from(width - 1)) as u32;
            let row = (0.5 * (1.0 - y) * f64::from(height - 1)) as u32;
            image.put_pixel(column.min(width - 1), row.min(height - 1), Rgb(colour));
        }
        Ok(image)
    }
}
