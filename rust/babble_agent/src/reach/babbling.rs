//! Babbled movements: a random case, and a random movement in it (Sect. III-A).

use babble_env::picture::Film;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::{EnvError, Outcome, ReachCase, ReachTask, Stream};
use serde::{Deserialize, Serialize};

use crate::babbling::{Babble, Column, ColumnKind};

/// What a movement leaves behind: percepts as the environment's senses give them, and what was done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experience {
    /// Pan and tilt on the target, over their ranges.
    pub eye: [f32; 2],
    /// Angles of the obstacle in the camera frame \[rad\].
    pub obstacle: [f32; 2],
    /// Parameters (b1, b2) of the movement.
    pub b: [f32; 2],
    /// How it ended.
    pub outcome: Outcome,
}

impl Experience {
    /// Whether it neither touched the obstacle nor left the joint ranges.
    #[must_use]
    pub fn is_legal(&self) -> bool {
        !matches!(self.outcome, Outcome::Collision | Outcome::JointLimit)
    }
}

/// How movements are simulated while babbling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReachBabbling {
    /// Without the muscles' lag: faster, and less like the paper.
    pub quasi_static: bool,
}

impl ReachBabbling {
    const fn fidelity(self) -> Fidelity {
        if self.quasi_static {
            Fidelity::QuasiStatic
        } else {
            Fidelity::Full
        }
    }
}

/// A random case, and a random movement in it.
struct Movement {
    case: ReachCase,
    b: [f64; 2],
    path: MovementPath,
}

impl Movement {
    fn draw(task: &ReachTask, stream: &mut Stream) -> Result<Self, EnvError> {
        let case = ReachCase::draw_geometry(task, stream)?;
        let [low, high] = task.config.reach.b_range;
        let b1 = stream.uniform(low, high);
        let b = [b1, 1.0 - b1];
        let path = MovementPath::new(task, &case, b)?;
        Ok(Self { case, b, path })
    }

    /// What it leaves behind; an illegal one leaves something only if `all` are asked for.
    /// `each` is called with the arm's posture \[rad\] at the end of every control period.
    fn make(
        &self,
        task: &ReachTask,
        options: ReachBabbling,
        stream: &mut Stream,
        all: bool,
        each: &mut dyn FnMut([f64; 2]),
    ) -> Result<Option<Experience>, EnvError> {
        let case = &self.case;
        let mut senses = task.config.noise.senses(stream);
        let mut muscles = task.config.noise.muscles(stream);
        let fidelity = options.fidelity();
        let played = self
            .path
            .play_with(task, case, fidelity, &mut muscles, |arm| each(arm.q));
        let mut experience = Experience {
            eye: [0.0; 2],
            obstacle: [0.0; 2],
            b: self.b.map(|x| x as f32),
            outcome: played.outcome,
        };
        if !experience.is_legal() && !all {
            return Ok(None);
        }
        let gaze = task.foveate(case)?;
        let camera = task.eye.camera(gaze);
        let single = |x: [f64; 2]| x.map(|x| x as f32);
        experience.eye = single(task.eye.normalised(gaze));
        experience.obstacle = single(ReachTask::obstacle_angles(&camera, case.obstacle.as_ref()));
        task.add_eye_errors(&mut senses, &mut experience.eye);
        task.add_sight_errors(&mut senses, &mut experience.obstacle);
        Ok(Some(experience))
    }
}

impl Babble for ReachTask {
    type Options = ReachBabbling;
    type Experience = Experience;

    const TRIES: usize = 5;
    const RAREST: u64 = 10_000;
    const PERIODS_S: Option<[f64; 2]> = None;

    /// A random case, b1 uniform in its range and b2 = 1 − b1. What is seen and the parameters are the
    /// same all along a movement, so there is one experience, whatever the period (Sect. III-A: "for
    /// each trajectory"). Senses and muscles have the config's noise.
    fn babble(
        &self,
        options: ReachBabbling,
        _period_s: Option<f64>,
        stream: &mut Stream,
        all: bool,
    ) -> Result<Vec<Experience>, EnvError> {
        let movement = Movement::draw(self, stream)?;
        let whole = movement.path.postures().len() == self.config.reach.movement_steps();
        if !whole && !all {
            return Ok(Vec::new());
        }
        let made = movement.make(self, options, stream, all, &mut |_| {})?;
        Ok(made.into_iter().collect())
    }

    fn film(
        &self,
        options: ReachBabbling,
        _period_s: Option<f64>,
        stream: &mut Stream,
    ) -> Result<(Vec<Experience>, Film), EnvError> {
        let movement = Movement::draw(self, stream)?;
        let mut postures = vec![movement.case.start];
        let made = movement.make(self, options, stream, true, &mut |q| postures.push(q))?;
        let gaze = self.foveate(&movement.case)?;
        let each = postures.into_iter();
        let mut film = Film {
            frames: each
                .map(|q| self.visible_at(&movement.case, gaze, q))
                .collect(),
            marks: Vec::new(),
        };
        film.mark();
        Ok((made.into_iter().collect(), film))
    }

    fn babble_steps(&self, _options: ReachBabbling) -> usize {
        self.config.reach.movement_steps() + self.settle_steps()
    }

    fn is_learnable(experience: &Experience) -> bool {
        experience.is_legal()
    }

    fn with_action_of(experience: &Experience, other: &Experience) -> Experience {
        Experience {
            b: other.b,
            ..*experience
        }
    }

    fn outcome(experience: &Experience) -> Outcome {
        experience.outcome
    }

    fn columns(all: &[Experience]) -> Vec<Column> {
        vec![
            Column::of("eye", ColumnKind::Percept, all, |e| e.eye),
            Column::of("obstacle", ColumnKind::Percept, all, |e| e.obstacle),
            Column::of("b", ColumnKind::Action, all, |e| e.b),
        ]
    }
}
