//! Grasping as a task: what its parts are together.

use babble_body::config::EngineName;
use babble_body::description::LinkDescription;
use image::RgbImage;
use serde::Serialize;
use serde_json::{Value, json};

use super::case::{GraspCase, GraspRequest};
use super::enclosure::Grip;
use super::entry::ENTRY;
use super::episode::{self, Potential};
use super::options::GraspOptions;
use super::sight::FOVEA_NEURONS;
use super::state::{ARM_TOUCHES, GraspState, SENSES};
use super::task::GraspTask;
use super::{check, picture, protocol, spec};
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::noise::NoiseConfig;
use crate::outcome::Outcome;
use crate::picture::{View, Visible};
use crate::progress::{Ending, Lifecycle, Progress};
use crate::spec::Spec;
use crate::stream::{Purpose, Stream};
use crate::task::{MAX_MEASURES, MAX_TERMS, Task};

/// Written as the options alone while there is no noise.
#[derive(Serialize)]
struct OptionsAndNoise {
    #[serde(flatten)]
    options: GraspOptions,
    #[serde(skip_serializing_if = "NoiseConfig::is_off")]
    noise: NoiseConfig,
}

impl Task for GraspTask {
    type Request = GraspRequest;
    type Drawn = GraspCase;
    type State = GraspState;
    type Derived = Box<[f32; FOVEA_NEURONS]>;
    type Potential = Potential;

    const NAME: &'static str = "grasping";
    const MAGIC: [u8; 4] = *b"BBGS";
    const OUTCOMES: &'static [Outcome] = &spec::OUTCOMES;
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn min_per_thread(&self) -> usize {
        1
    }

    fn most_physics_steps(&self) -> u64 {
        self.config.grasp.physics_steps.into()
    }

    fn most_replayed_steps(&self) -> u64 {
        // Only rapier repeats an episode, as its state cannot be checked.
        if self.config.body.engine == EngineName::Tree {
            return 0;
        }
        u64::from(self.options.max_episode_steps) * self.most_physics_steps()
    }

    fn action_len(&self) -> usize {
        4
    }

    fn senses_len(&self) -> usize {
        if self.options.arm_touch {
            SENSES + ARM_TOUCHES
        } else {
            SENSES
        }
    }

    fn spec(&self) -> Spec {
        spec::spec(self)
    }

    fn fingerprint(&self) -> impl Serialize {
        // Recording is for pictures and changes no episode.
        let options = GraspOptions {
            record: false,
            ..self.options
        };
        let Config {
            profile,
            body,
            grasp,
            noise,
            ..
        } = &self.config;
        let noise = *noise;
        (profile, body, grasp, OptionsAndNoise { options, noise })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn quantities(&self) -> Value {
        json!({
            "ranges": self.robot.ranges(),
            "reflex": self.reflex(),
            "muscles": self.muscles().map(|muscles| [muscles.kp, muscles.torque_max]),
            "delta_posture": self.config.grasp.delta_posture_deg.to_radians(),
        })
    }

    fn robot(&self) -> Vec<LinkDescription> {
        self.robot.description()
    }

    fn unconverged_steps(&self) -> Option<u64> {
        self.robot.unconverged_steps()
    }

    fn shared(state: &GraspState) -> (&Progress, &Lifecycle<GraspRequest>) {
        (&state.progress, &state.lifecycle)
    }

    fn shared_mut(state: &mut GraspState) -> (&mut Progress, &mut Lifecycle<GraspRequest>) {
        (&mut state.progress, &mut state.lifecycle)
    }

    fn fresh(&self, lifecycle: Lifecycle<GraspRequest>) -> GraspState {
        episode::fresh(self, lifecycle)
    }

    fn check(&self, state: &mut GraspState) -> Result<(), EnvError> {
        check::check(self, state)
    }

    fn derive(&self, state: &GraspState) -> Self::Derived {
        episode::look(self, state)
    }

    fn draw(
        &self,
        request: &GraspRequest,
        stream: &mut Stream,
        stop: &Stop<'_>,
    ) -> Result<GraspCase, EnvError> {
        request.draw(self, stream, stop)
    }

    fn begin(&self, state: &mut GraspState, case: GraspCase) {
        episode::begin(self, state, case);
    }

    fn ending(&self) -> Ending {
        Ending {
            goal: self.options.goal,
            goes_on: self.options.support_stays,
            single_step: false,
            max_steps: self.options.max_episode_steps,
        }
    }

    fn potential(&self, state: &GraspState) -> Potential {
        state.potential(self)
    }

    fn advance(
        &self,
        state: &mut GraspState,
        edges: &mut Self::Derived,
        action: &[f32],
    ) -> Result<bool, EnvError> {
        Ok(episode::advance(self, state, edges, action))
    }

    fn reward_terms(&self, state: &GraspState, before: Potential) -> [f64; MAX_TERMS] {
        state.reward_terms(self, before)
    }

    fn observe(&self, state: &GraspState, edges: &Self::Derived, out: &mut [f32]) {
        episode::observe(self, state, edges, out);
    }

    fn goals(&self, state: &GraspState, achieved: &mut [f32], desired: &mut [f32]) {
        achieved.copy_from_slice(&state.achieved(self));
        desired.copy_from_slice(&state.desired());
    }

    fn facts(&self, state: &GraspState, out: &mut [bool]) {
        let held = state.enclosure.grip == Grip::Held;
        out[..4].copy_from_slice(&[state.reach, state.palm_reach, held, state.in_sight]);
    }

    fn measures(&self, state: &GraspState, out: &mut [f64; MAX_MEASURES]) {
        *out = self.robot.object(&state.world).into();
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        self.goal_space().reward(achieved, desired)
    }

    fn request(&self, asked: &CaseValues) -> GraspRequest {
        GraspRequest::from_values(self, asked)
    }

    fn case(&self, state: &GraspState) -> CaseValues {
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
        let protocol = ENTRY.protocol(name)?;
        let cases = match (protocol.random, protocol.name) {
            (true, _) => {
                let drawn = protocol::random(self, n, seed, purpose, executor)?;
                drawn.into_iter().map(Some).collect()
            }
            (false, "fig7") => protocol::fig7(self),
            (false, _) => protocol::table2(self),
        };
        Ok(cases
            .iter()
            .map(|case| Some(case.as_ref()?.values()))
            .collect())
    }

    fn trail(&self, state: &GraspState) -> Vec<[f64; 2]> {
        state.trail.iter().map(|moment| moment.palm).collect()
    }

    fn moments(&self, state: &GraspState) -> usize {
        state.trail.len()
    }

    fn visible(&self, state: &GraspState) -> Option<Visible> {
        Some(picture::visible(self, state))
    }

    fn picture(
        &self,
        state: &GraspState,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        picture::picture(self, state, view, size, frame)
    }
}
