//! Babbles to look at, before they are learnt from.

use serde::Serialize;

use crate::fault::Fault;
use crate::lab::Lab;
use crate::scene::Scene;

/// A babble of an agent, from its beginning to its end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Film {
    /// Its number, from 1 on.
    pub number: u64,
    /// Time from one frame to the next \[s\].
    pub period: f64,
    /// Its world, moment by moment.
    pub frames: Vec<Scene>,
    /// Numbers of the frames in which the agent learns, if it can learn from this babble.
    pub moments: Vec<usize>,
    /// Whether it can be learnt from.
    pub learnable: bool,
    /// How it ended.
    pub outcome: &'static str,
    /// Activities of the maps in each of these moments: of each association the input map's, for what was
    /// seen, then the output map's, for what was done; not part of the JSON, as there are many.
    #[serde(skip)]
    pub activities: Vec<f32>,
}

impl Lab {
    /// The babble of an agent that comes after `ahead` others from here on. It is learnt from when the agent
    /// [babbles](crate::Command::Babble); looking at it changes nothing.
    ///
    /// # Errors
    /// A [`Fault`] for an agent that does not learn, or an error of the task.
    pub fn film(&self, agent: usize, ahead: u64) -> Result<Film, Fault> {
        let learner = &self.learner(agent)?.learner;
        let film = learner.film(&self.task, ahead)?;
        let maps = |moment: &babble_agent::learner::FilmMoment| {
            let each = moment.activities.iter();
            each.flat_map(|one| [&one.g[..], &one.a].concat())
                .collect::<Vec<f32>>()
        };
        Ok(Film {
            number: learner.babbled() + ahead + 1,
            period: 1.0 / self.task.spec().control_hz,
            frames: film.frames.iter().map(|seen| self.scene_of(seen)).collect(),
            moments: film.moments.iter().map(|moment| moment.frame).collect(),
            learnable: film.learnable,
            outcome: film.outcome.name(),
            activities: film.moments.iter().flat_map(maps).collect(),
        })
    }
}
