//! Grasping as a task: what its parts are together.

use babble_body::description::LinkDescription;
use image::RgbImage;
use serde::Serialize;
use serde_json::{Value, json};

use super::case::GraspRequest;
use super::entry::ENTRY;
use super::episode::{Grasp, goal_reward};
use super::options::GraspOptions;
use super::sight::FOVEA_NEURONS;
use super::state::GraspState;
use super::task::GraspTask;
use super::{picture, protocol, spec};
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::Executor;
use crate::picture::View;
use crate::spec::Spec;
use crate::stream::Purpose;
use crate::task::Task;

impl Task for GraspTask {
    type Episode = Grasp;

    const NAME: &'static str = "grasping";
    const MAGIC: [u8; 4] = *b"BBGS";
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn min_per_thread(&self) -> usize {
        1
    }

    fn action_len(&self) -> usize {
        4
    }

    fn senses_len(&self) -> usize {
        FOVEA_NEURONS + 14
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
            ..
        } = &self.config;
        (profile, body, grasp, options)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn quantities(&self) -> Value {
        json!({
            "ranges": self.robot.ranges(),
            "reflex": self.reflex(),
            "delta_posture": self.config.grasp.delta_posture_deg.to_radians(),
        })
    }

    fn robot(&self) -> Vec<LinkDescription> {
        self.robot.description()
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        goal_reward(
            &self.config,
            [0, 1].map(|i| achieved[i]),
            [0, 1].map(|i| desired[i]),
        )
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
