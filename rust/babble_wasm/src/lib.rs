#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

use babble_env::Executor;
use babble_lab::{Command, Fault, Lab, MapName, Setup, ToJson};
use wasm_bindgen::prelude::*;

/// What an export returns: JSON or bytes, or a [`Fault`] as JSON, which JavaScript throws.
type Reply<T> = Result<T, JsValue>;

/// Makes a panic an exception with its message. The engine is of no use after it.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| wasm_bindgen::throw_str(&info.to_string())));
}

/// The environments, sliders and so on, as JSON.
///
/// # Errors
/// A fault.
#[wasm_bindgen]
pub fn registry() -> Reply<String> {
    json(&babble_lab::registry().map_err(thrown)?)
}

/// The setup that a session in an environment begins with, as JSON.
///
/// # Errors
/// A fault.
#[wasm_bindgen(js_name = defaultSetup)]
pub fn default_setup(env: &str) -> Reply<String> {
    json(&babble_lab::default_setup(env).map_err(thrown)?)
}

/// What is wrong with the expression of a rule, and at which character, as JSON; `null` if it can be used.
///
/// # Errors
/// A fault.
#[wasm_bindgen(js_name = checkRule)]
pub fn check_rule(rule: &str) -> Reply<String> {
    babble_lab::check_rule(rule).map_err(thrown)
}

/// The lessons, as JSON.
///
/// # Errors
/// A fault.
#[wasm_bindgen]
pub fn lessons() -> Reply<String> {
    json(babble_lab::lessons())
}

/// Networks that were trained elsewhere, by name.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Policies(babble_lab::Policies);

#[wasm_bindgen]
impl Policies {
    /// None yet.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the network in a file's bytes.
    ///
    /// # Errors
    /// A fault.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Reply<()> {
        self.0.add(name, bytes).map_err(thrown)
    }
}

/// A session.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Session(Lab);

#[wasm_bindgen]
#[expect(clippy::missing_errors_doc, reason = "a fault as JSON, in all of them")]
impl Session {
    /// A session that begins with a setup, given as JSON, whose agents may be some of the policies.
    #[wasm_bindgen(constructor)]
    pub fn new(setup: &str, policies: &Policies) -> Reply<Self> {
        let setup = Setup::from_json(setup).map_err(thrown)?;
        let executor = Executor::new(1).map_err(|error| thrown(error.into()))?;
        Ok(Self(
            Lab::open(setup, policies.0.clone(), executor).map_err(thrown)?,
        ))
    }

    /// Does what a command says, given as JSON.
    pub fn apply(&mut self, command: &str) -> Reply<()> {
        let command = Command::from_json(command).map_err(thrown)?;
        self.0.apply(&command).map_err(thrown)
    }

    /// Does what a command says, given as JSON, as a part of what was done before.
    #[wasm_bindgen(js_name = goOn)]
    pub fn go_on(&mut self, command: &str) -> Reply<()> {
        let command = Command::from_json(command).map_err(thrown)?;
        self.0.go_on(&command).map_err(thrown)
    }

    /// Knows these policies from now on.
    pub fn know(&mut self, policies: &Policies) {
        self.0.know(policies.0.clone());
    }

    /// Takes back what was done last.
    pub fn undo(&mut self) -> Reply<()> {
        self.0.undo().map_err(thrown)
    }

    /// How things stand, as JSON.
    pub fn state(&self) -> Reply<String> {
        json(&self.0.state().map_err(thrown)?)
    }

    /// The world of an agent's episode, as JSON.
    pub fn scene(&self, agent: usize) -> Reply<String> {
        json(&self.0.scene(agent).map_err(thrown)?)
    }

    /// A babble to look at.
    pub fn film(&self, agent: usize, ahead: u32) -> Reply<Film> {
        let film = self.0.film(agent, u64::from(ahead));
        Ok(Film(film.map_err(thrown)?))
    }

    /// The case on the stage with the ball elsewhere along the palm, so far from the wrist \[m\], as JSON.
    #[wasm_bindgen(js_name = palmCase)]
    pub fn palm_case(&self, wrist_m: f64) -> Reply<String> {
        json(&self.0.palm_case(wrist_m).map_err(thrown)?)
    }

    /// What the eye has to do with Eq. 1, as JSON.
    pub fn sight(&self, agent: usize) -> Reply<String> {
        json(&self.0.sight(agent).map_err(thrown)?)
    }

    /// A picture as red, green, blue and opacity, rows from the top.
    pub fn picture(&self, agent: usize, view: &str, width: u32, height: u32) -> Reply<Vec<u8>> {
        let size = [width, height];
        self.0.picture(agent, view, size).map_err(thrown)
    }

    /// The maps of a learning agent as JSON, without their activities; `null` for an agent without maps.
    pub fn brain(&self, agent: usize) -> Reply<String> {
        json(&self.0.brain(agent).map_err(thrown)?)
    }

    /// The activities of all maps of [`brain`](Self::brain): of each association the input's, then the
    /// output's.
    pub fn activities(&self, agent: usize) -> Reply<Vec<f32>> {
        let brain = self.0.brain(agent).map_err(thrown)?;
        let all = brain.into_iter().flat_map(|brain| brain.associations);
        Ok(all
            .flat_map(|one| [one.input.activity, one.output.activity])
            .flatten()
            .collect())
    }

    /// Name and shape of the map that [`weights`](Self::weights) go to, as JSON.
    #[wasm_bindgen(js_name = weightsMap)]
    pub fn weights_map(
        &self,
        agent: usize,
        association: usize,
        map: &str,
        neuron: usize,
    ) -> Reply<String> {
        let map = map_name(map)?;
        let weights = self.0.weights(agent, association, map, neuron);
        json(&weights.map_err(thrown)?)
    }

    /// Weights of one neuron with all neurons of the other map.
    pub fn weights(
        &self,
        agent: usize,
        association: usize,
        map: &str,
        neuron: usize,
    ) -> Reply<Vec<f32>> {
        let map = map_name(map)?;
        let weights = self.0.weights(agent, association, map, neuron);
        Ok(weights.map_err(thrown)?.activity)
    }

    /// A learning agent as a file of the Python package.
    #[wasm_bindgen(js_name = saveAgent)]
    pub fn save_agent(&self, agent: usize) -> Reply<Vec<u8>> {
        self.0.save_agent(agent).map_err(thrown)
    }

    /// Puts an agent from a file in place of another.
    #[wasm_bindgen(js_name = loadAgent)]
    pub fn load_agent(&mut self, agent: usize, bytes: &[u8]) -> Reply<()> {
        self.0.load_agent(agent, bytes).map_err(thrown)
    }

    /// Lines of Python that make the same agent.
    pub fn python(&self, agent: usize) -> Reply<String> {
        self.0.python(agent).map_err(thrown)
    }

    /// How far the session has come in a lesson, as JSON.
    pub fn progress(&self, lesson: &str) -> Reply<String> {
        let lesson = babble_lab::lesson::lesson(lesson).map_err(thrown)?;
        json(&lesson.progress(self.0.history()))
    }

    /// The session so far as a file to hand in, JSON; `lesson` is undefined outside of one.
    #[expect(clippy::needless_pass_by_value, reason = "as wasm-bindgen passes it")]
    pub fn record(&self, lesson: Option<String>, name: &str) -> Reply<String> {
        json(&self.0.record(lesson.as_deref(), name).map_err(thrown)?)
    }
}

/// A babble to look at.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Film(babble_lab::Film);

#[wasm_bindgen]
impl Film {
    /// All but the activities, as JSON.
    ///
    /// # Errors
    /// A fault.
    pub fn told(&self) -> Reply<String> {
        json(&self.0)
    }

    /// The activities of all maps.
    #[must_use]
    pub fn activities(&self) -> Vec<f32> {
        self.0.activities.clone()
    }
}

fn map_name(name: &str) -> Reply<MapName> {
    name.parse().map_err(thrown)
}

fn json(value: &(impl ToJson + ?Sized)) -> Reply<String> {
    value.to_json().map_err(thrown)
}

#[expect(clippy::needless_pass_by_value, reason = "as map_err passes it")]
fn thrown(fault: Fault) -> JsValue {
    let text = fault.to_json().unwrap_or_else(|_| fault.problem.clone());
    JsValue::from_str(&text)
}
