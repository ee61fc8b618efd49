//! An object put into the hand, which the enclosure reflex closes while the arm is moved about:
//! what babbling does, and what shows how well the reflex holds.

use std::collections::VecDeque;

use babble_body::robot::{Ball, Posture, Setup, Touch, World, towards};
use babble_eye::Gaze;

use super::case::GraspCase;
use super::picture::visible_in;
use super::sight::{FOVEA_NEURONS, foveate, scene, see};
use super::state::GraspState;
use super::task::GraspTask;
use crate::error::EnvError;
use crate::picture::{Film, Visible};
use crate::stream::Stream;

/// A world with an object at the palm, outside of any episode.
#[derive(Debug, Clone)]
pub struct InHand {
    world: World,
    case: GraspCase,
    /// Whether the hand enclosed the object in each physics step, up to the time that a grasp must be
    /// held for; newest last.
    enclosed: VecDeque<bool>,
    /// Physics steps that were filmed, and the film, if there is to be one.
    film: Option<(u32, Film)>,
}

impl InHand {
    /// The arm in a posture \[rad\] with the open hand, and an object of a diameter \[m\] on its support
    /// before the palm.
    #[must_use]
    pub fn new(task: &GraspTask, arm: [f64; 2], diameter: f64) -> Self {
        let radius = diameter / 2.0;
        let object = task.at_palm(arm, radius);
        let world = task.robot.world(&Setup {
            posture: task.robot.open_hand(arm),
            ball: Ball {
                centre: object,
                radius,
            },
            support: true,
            obstacle: None,
        });
        let case = GraspCase {
            start: arm,
            object,
            diameter,
            goal: None,
            obstacle: None,
        };
        Self {
            world,
            case,
            enclosed: VecDeque::new(),
            film: None,
        }
    }

    /// The world of an episode as it is.
    #[must_use]
    pub fn of(state: &GraspState) -> Self {
        Self {
            world: state.world.clone(),
            case: state.case,
            enclosed: VecDeque::new(),
            film: None,
        }
    }

    /// An object at the palm in a random posture in which the object is clear of the upper arm.
    ///
    /// # Errors
    /// [`EnvError::NoGraspCase`] if there is no such posture.
    pub fn draw(task: &GraspTask, diameter: f64, stream: &mut Stream) -> Result<Self, EnvError> {
        let arm = task.draw_free_posture(diameter / 2.0, stream)?;
        Ok(Self::new(task, arm, diameter))
    }

    /// Arm, hand, object and support.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// Where the arm began \[rad\].
    #[must_use]
    pub const fn start(&self) -> [f64; 2] {
        self.case.start
    }

    /// The reflex on the hand and the arm's muscles pulling to a posture \[rad\], for some time \[s\].
    /// Returns how deep the object was pressed into arm and hand at most \[m\].
    pub fn carry(&mut self, task: &GraspTask, arm: [f64; 2], seconds: f64) -> f64 {
        let [thumb, finger] = task.reflex();
        self.pull(task, [arm[0], arm[1], thumb, finger], seconds)
    }

    /// The muscles of arm and hand pulling to a posture \[rad\], for some time \[s\]. Returns how deep
    /// the object was pressed into arm and hand at most \[m\].
    pub fn pull(&mut self, task: &GraspTask, posture: Posture, seconds: f64) -> f64 {
        let drive = towards(posture);
        let steps = (seconds / task.config.grasp.physics_step_s()).round() as usize;
        let mut deepest: f64 = 0.0;
        for _ in 0..steps {
            task.robot.step(&mut self.world, &drive);
            self.enclosed
                .push_back(task.robot.touch(&self.world).encloses());
            deepest = deepest.max(task.robot.penetration(&self.world));
            self.expose(task);
        }
        let surplus = self.enclosed.len().saturating_sub(hold_len(task));
        self.enclosed.drain(..surplus);
        deepest
    }

    /// Films what happens from now on.
    pub fn start_film(&mut self, task: &GraspTask) {
        let frames = vec![self.visible(task)];
        let marks = Vec::new();
        self.film = Some((0, Film { frames, marks }));
    }

    /// Marks the last frame of the film, if there is one.
    pub fn mark(&mut self) {
        if let Some((_, film)) = &mut self.film {
            film.mark();
        }
    }

    /// The film so far; empty if nothing was filmed.
    #[must_use]
    pub fn into_film(self) -> Film {
        self.film.map(|(_, film)| film).unwrap_or_default()
    }

    /// Films a physics step.
    fn expose(&mut self, task: &GraspTask) {
        let Some((steps, mut film)) = self.film.take() else {
            return;
        };
        if (steps + 1).is_multiple_of(task.config.grasp.physics_steps) {
            film.frames.push(self.visible(task));
        }
        self.film = Some((steps + 1, film));
    }

    /// What there is to see; the eye looks straight ahead where all of the object is hidden.
    #[must_use]
    pub fn visible(&self, task: &GraspTask) -> Visible {
        let scene = scene(task, &self.world, &self.case);
        let (gaze, _) = foveate(task, &scene);
        visible_in(task, &self.world, &self.case, &scene, gaze)
    }

    /// Takes the support away.
    pub fn remove_support(&mut self, task: &GraspTask) {
        task.robot.remove_support(&mut self.world);
    }

    /// Which links touched the object in the last physics step, and how hard.
    #[must_use]
    pub fn touch(&self, task: &GraspTask) -> Touch {
        task.robot.touch(&self.world)
    }

    /// Whether the hand holds the object, as in an episode: the object is before the palm, and for the
    /// time of [`GraspConfig::hold_steps`] the hand enclosed it in more than
    /// [`GraspConfig::held_share`] of the physics steps.
    ///
    /// [`GraspConfig::hold_steps`]: super::GraspConfig::hold_steps
    /// [`GraspConfig::held_share`]: super::GraspConfig::held_share
    #[must_use]
    pub fn is_held(&self, task: &GraspTask) -> bool {
        let enclosed = self.enclosed.iter().filter(|&&encloses| encloses).count();
        let least = task.config.grasp.held_share * hold_len(task) as f64;
        task.in_hand(&self.world, self.case.radius()) && enclosed as f64 > least
    }

    /// Angles of shoulder, elbow, thumb and finger \[rad\].
    #[must_use]
    pub fn posture(&self, task: &GraspTask) -> [f64; 4] {
        task.robot.posture(&self.world)
    }

    /// Lets the eye find the object and fills in the fovea's edges; none where all of it is hidden.
    #[must_use]
    pub fn see(&self, task: &GraspTask, fovea: &mut [f32; FOVEA_NEURONS]) -> Option<Gaze> {
        see(task, &self.world, &self.case, fovea)
    }
}

/// Physics steps over which a grasp must be held.
const fn hold_len(task: &GraspTask) -> usize {
    let numbers = &task.config.grasp;
    numbers.hold_steps as usize * numbers.physics_steps as usize
}
