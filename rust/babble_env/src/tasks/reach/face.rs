//! Reaching as a task: what its parts are together.

use babble_body::Body;
use babble_body::description::{self, LinkDescription};
use image::RgbImage;
use serde::Serialize;
use serde_json::{Value, json};

use super::config::ReachConfig;
use super::entry::ENTRY;
use super::episode::{self, Drawn, Sight};
use super::options::ReachOptions;
use super::request::CaseRequest;
use super::state::{ReachState, SENSES};
use super::task::ReachTask;
use super::{check, picture, protocol, spec};
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::noise::NoiseConfig;
use crate::options::Control;
use crate::outcome::Outcome;
use crate::picture::{View, Visible};
use crate::progress::{Ending, Lifecycle, Progress};
use crate::spec::Spec;
use crate::stream::{Purpose, Stream};
use crate::task::{MAX_TERMS, Task};

/// The part of a config that reaching depends on.
#[derive(Serialize)]
struct Fingerprint<'a> {
    profile: &'a str,
    body: &'a Body,
    reach: &'a ReachConfig,
    #[serde(skip_serializing_if = "NoiseConfig::is_off")]
    noise: NoiseConfig,
}

impl Task for ReachTask {
    type Request = CaseRequest;
    type Drawn = Drawn;
    type State = ReachState;
    type Derived = Sight;
    type Potential = f64;

    const NAME: &'static str = "reaching";
    const MAGIC: [u8; 4] = *b"BBRS";
    const OUTCOMES: &'static [Outcome] = &spec::OUTCOMES;
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn min_per_thread(&self) -> usize {
        // A whole movement, or a control step of about a microsecond.
        match self.options.control {
            Control::Pattern => 1,
            _ => 8,
        }
    }

    fn most_physics_steps(&self) -> u64 {
        // A whole movement, which drawing a legal case plays in every control.
        self.movement_physics_steps() as u64
    }

    fn action_len(&self) -> usize {
        2
    }

    fn senses_len(&self) -> usize {
        SENSES
    }

    fn spec(&self) -> Spec {
        spec::spec(self)
    }

    fn fingerprint(&self) -> impl Serialize {
        // Recording is for pictures and changes no episode.
        let options = ReachOptions {
            record: false,
            ..self.options
        };
        let Config {
            profile,
            body,
            reach,
            noise,
            ..
        } = &self.config;
        let config = Fingerprint {
            profile,
            body,
            reach,
            noise: *noise,
        };
        (config, options)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn quantities(&self) -> Value {
        let muscles = &self.config.body.muscles;
        let ranges = [0, 1].map(|i| [self.arm.lower[i], self.arm.upper_limit[i]]);
        json!({
            "joint_range": ranges.map(|[low, high]| high - low),
            "ranges": ranges,
            "muscles": [[muscles.kp, muscles.torque_max], [muscles.kp, muscles.torque_max]],
            "delta_posture": self.config.reach.delta_posture_deg.to_radians(),
            "b_range": self.config.reach.b_range,
        })
    }

    fn robot(&self) -> Vec<LinkDescription> {
        description::reaching(&self.config.body).to_vec()
    }

    fn shared(state: &ReachState) -> (&Progress, &Lifecycle<CaseRequest>) {
        (&state.progress, &state.lifecycle)
    }

    fn shared_mut(state: &mut ReachState) -> (&mut Progress, &mut Lifecycle<CaseRequest>) {
        (&mut state.progress, &mut state.lifecycle)
    }

    fn fresh(&self, lifecycle: Lifecycle<CaseRequest>) -> ReachState {
        episode::fresh(self, lifecycle)
    }

    fn check(&self, state: &mut ReachState) -> Result<(), EnvError> {
        check::check(self, state)
    }

    fn derive(&self, state: &ReachState) -> Sight {
        Sight::new(self, state)
    }

    fn draw(
        &self,
        request: &CaseRequest,
        stream: &mut Stream,
        stop: &Stop<'_>,
    ) -> Result<Drawn, EnvError> {
        episode::draw(self, request, stream, stop)
    }

    fn begin(&self, state: &mut ReachState, drawn: Drawn) {
        episode::begin(self, state, drawn);
    }

    fn ending(&self) -> Ending {
        Ending {
            goal: self.options.goal,
            goes_on: false,
            single_step: self.options.control == Control::Pattern,
            max_steps: self.options.max_episode_steps,
        }
    }

    fn potential(&self, state: &ReachState) -> f64 {
        state.distance
    }

    fn advance(
        &self,
        state: &mut ReachState,
        _: &mut Sight,
        action: &[f32],
    ) -> Result<bool, EnvError> {
        episode::advance(self, state, action)
    }

    fn reward_terms(&self, state: &ReachState, before: f64) -> [f64; MAX_TERMS] {
        episode::reward_terms(self, state, before)
    }

    fn observe(&self, state: &ReachState, sight: &Sight, out: &mut [f32]) {
        episode::observe(self, state, sight, out);
    }

    fn goals(&self, state: &ReachState, achieved: &mut [f32], desired: &mut [f32]) {
        let [tip, target] = episode::goals(self, state);
        achieved.copy_from_slice(&tip);
        desired.copy_from_slice(&target);
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        self.goal_space().reward(achieved, desired)
    }

    fn request(&self, asked: &CaseValues) -> CaseRequest {
        CaseRequest::from_values(self, asked)
    }

    fn case(&self, state: &ReachState) -> CaseValues {
        state.case.values()
    }

    fn cases(
        &self,
        name: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError> {
        let cases = if ENTRY.protocol(name)?.random {
            let sampled = protocol::table1(self, n, seed, purpose, executor)?;
            sampled.into_iter().map(Some).collect()
        } else {
            protocol::fig4(self)
        };
        Ok(cases
            .iter()
            .map(|case| Some(case.as_ref()?.values()))
            .collect())
    }

    fn trail(&self, state: &ReachState) -> Vec<[f64; 2]> {
        let tip = |&q| self.arm.fingertip(q).into();
        state.trail.iter().map(tip).collect()
    }

    fn moments(&self, state: &ReachState) -> usize {
        state.trail.len()
    }

    fn visible(&self, state: &ReachState) -> Option<Visible> {
        Some(picture::visible(self, state))
    }

    fn picture(
        &self,
        state: &ReachState,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        picture::picture(self, state, view, size, frame)
    }
}
