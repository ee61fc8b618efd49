//! A session: agents, a stage, and what was done.

use std::sync::Arc;

use babble_agent::erased;
use babble_env::{AnyTask, Config, Executor};
use serde_json::Map;

use crate::agent::{Agent, LearnerMind, Mind, task_name};
use crate::command::{Case, Command, MapName};
use crate::cost::Cost;
use crate::fault::Fault;
use crate::hash::Hash;
use crate::history::{Event, Happened};
use crate::making;
use crate::palm;
use crate::policies::Policies;
use crate::setup::{AgentSetup, Setup};
use crate::snapshot::{Snapshot, Undo};
use crate::stage::Stage;
use crate::state::{CurvePoint, Outcomes, State};
use crate::test_cases;

/// A session. After an error it is as it was before.
#[derive(Debug)]
pub struct Lab {
    pub(crate) setup: Arc<Setup>,
    pub(crate) task: Arc<dyn AnyTask>,
    pub(crate) agents: Vec<Agent>,
    pub(crate) stage: Stage,
    pub(crate) policies: Policies,
    pub(crate) begun_with: Arc<Setup>,
    pub(crate) commands: Vec<Command>,
    /// Hashes of the agents that came from files.
    pub(crate) loaded: Vec<String>,
    curve: Vec<CurvePoint>,
    history: Vec<Event>,
    undo: Undo,
    cost: Cost,
    executor: Executor,
}

impl Lab {
    /// A session that begins with a setup, whose agents may be some of the policies; `executor` does the
    /// work.
    ///
    /// # Errors
    /// A [`Fault`] that names the field of the setup.
    pub fn open(setup: Setup, policies: Policies, executor: Executor) -> Result<Self, Fault> {
        setup.check()?;
        let setup = Arc::new(setup);
        let task = making::task(&setup, &Map::new())?;
        let each = setup.agents.iter().enumerate();
        let agents = each.map(|(i, agent)| Agent::new(agent, &setup, &task, i, &policies));
        Ok(Self {
            agents: agents.collect::<Result<_, _>>()?,
            stage: Stage::new(&task, setup.agents.len(), setup.seed)?,
            task,
            policies,
            begun_with: Arc::clone(&setup),
            setup,
            commands: Vec::new(),
            loaded: Vec::new(),
            curve: Vec::new(),
            history: Vec::new(),
            undo: Undo::default(),
            cost: Cost::default(),
            executor,
        })
    }

    /// Does what a command says.
    ///
    /// # Errors
    /// A [`Fault`]; everything is then as it was.
    pub fn apply(&mut self, command: &Command) -> Result<(), Fault> {
        let before = self.carry_out(command)?;
        self.undo.push(before);
        Ok(())
    }

    /// Does what a command says as a part of what was done before: undo takes both back together.
    ///
    /// # Errors
    /// A [`Fault`]; everything is then as it was.
    pub fn go_on(&mut self, command: &Command) -> Result<(), Fault> {
        self.carry_out(command)?;
        Ok(())
    }

    /// Does what a command says, and returns how everything was before.
    fn carry_out(&mut self, command: &Command) -> Result<Snapshot, Fault> {
        command.check()?;
        let before = self.snapshot()?;
        let what = match self.perform(command) {
            Ok(what) => what,
            Err(fault) => {
                self.restore(&before)?;
                return Err(fault);
            }
        };
        let event = Event {
            setup: Arc::clone(&self.setup),
            learnt: self.learnt(),
            what,
        };
        let merged = self
            .commands
            .last_mut()
            .is_some_and(|last| last.merge(command));
        if let Some(earlier) = self.history.last_mut().filter(|_| merged) {
            earlier.merge(event);
        } else {
            self.commands.push(command.clone());
            self.history.push(event);
        }
        Ok(before)
    }

    /// Knows these policies from now on, which a change of the setup can name.
    pub fn know(&mut self, policies: Policies) {
        self.policies = policies;
    }

    /// The case on the stage, or the next one, with the ball so far from the wrist \[m\] when the elbow alone
    /// bends until the palm touches it.
    ///
    /// # Errors
    /// A [`Fault`] for a distance out of bounds, or another task.
    pub fn palm_case(&self, wrist_m: f64) -> Result<Case, Fault> {
        palm::moved(&self.task, &self.stage.seen(0).case(0)?, wrist_m)
    }

    /// Takes back what was done last, as if it had never been: a command, and those that
    /// [went on](Self::go_on) with it.
    ///
    /// # Errors
    /// A [`Fault`] if there is none that can be undone.
    pub fn undo(&mut self) -> Result<(), Fault> {
        let Some(before) = self.undo.pop() else {
            let problem = "there is nothing to undo";
            return Err(Fault::new("ConfigError", None, problem));
        };
        self.restore(&before)
    }

    /// How things stand.
    ///
    /// # Errors
    /// A [`Fault`] if the stage cannot be read.
    pub fn state(&self) -> Result<State, Fault> {
        let name = task_name(&self.setup)?;
        Ok(State {
            setup: (*self.setup).clone(),
            agents: self.agents.iter().map(|agent| agent.state(name)).collect(),
            episode: self.stage.state(self.period()?),
            curve: self.curve.clone(),
            commands: self.commands.len(),
            undoable: self.undo.len(),
            hash: self.hash()?,
        })
    }

    /// What happened, the first event first.
    #[must_use]
    pub fn history(&self) -> &[Event] {
        &self.history
    }

    /// A number that two sessions share only if all that commands changed is the same to the bit; 16
    /// hexadecimal digits.
    ///
    /// # Errors
    /// A [`Fault`] if the stage cannot be read.
    pub fn hash(&self) -> Result<String, Fault> {
        let mut hash = Hash::default();
        for agent in &self.agents {
            agent.hash(&mut hash);
        }
        self.stage.hash(&mut hash)?;
        hash.add(&serde_json::to_vec(&self.curve)?);
        Ok(format!("{:016x}", hash.finish()))
    }

    /// A learning agent as a file of the Python package.
    ///
    /// # Errors
    /// A [`Fault`] for an agent that does not learn.
    pub fn save_agent(&self, agent: usize) -> Result<Vec<u8>, Fault> {
        Ok(self.learner(agent)?.learner.save()?)
    }

    /// Puts an agent from a file in place of another; the setup changes with it, and the record begins
    /// anew.
    ///
    /// # Errors
    /// A [`Fault`] for bytes that are no agent, or one that cannot act in the environment.
    pub fn load_agent(&mut self, agent: usize, bytes: &[u8]) -> Result<(), Fault> {
        self.agent(agent)?;
        let learner = erased::load(bytes)?;
        let setup = self.setup_with(agent, &*learner)?;
        let before = self.snapshot()?;
        let changed = self.change(&setup).and_then(|()| {
            self.agents[agent].mind = Mind::Learner(LearnerMind::new(learner, None));
            let (seed, task) = (self.setup.seed, Arc::clone(&self.task));
            self.agents[agent].with_policy(seed, &task, |_| Ok(()))
        });
        if let Err(fault) = changed {
            self.restore(&before)?;
            return Err(fault);
        }
        let known = self.agents.iter().filter_map(Agent::learner);
        self.loaded = known.map(|mind| format!("{:016x}", mind.hash)).collect();
        self.begun_with = Arc::clone(&self.setup);
        self.commands.clear();
        self.history.clear();
        self.curve.clear();
        self.undo = Undo::default();
        Ok(())
    }

    /// The setup in which an agent from a file goes on as it would have.
    fn setup_with(&self, place: usize, learner: &dyn erased::AnyLearner) -> Result<Setup, Fault> {
        let mut setup = (*self.setup).clone();
        let task = learner.task();
        if task_name(&setup)? != task {
            let first = &babble_env::registry::task(task)?.environments[0];
            first.id.clone_into(&mut setup.env);
            setup.options = Map::new();
        }
        let config = learner.config();
        let profile = serde_json::to_value(Config::profile(&config.profile)?)?;
        setup.profile.clone_from(&config.profile);
        setup.config = making::difference(&serde_json::to_value(config)?, &profile);
        setup.seed = learner.seed();
        let brain = learner.brain()?;
        let variant = brain.get("variant").and_then(|name| name.as_str());
        let variant = variant.unwrap_or("paper").to_owned();
        if brain["rule"]["name"] == "own" {
            let problem = "it learns by a rule of its own, which the file does not have";
            return Err(Fault::new("AgentFileError", Some("rule"), problem));
        }
        let base = erased::brain_of(task, &variant)?;
        setup.agents[place] = AgentSetup::Hebb {
            brain: making::difference(&brain, &base),
            variant,
            rule: None,
        };
        Ok(setup)
    }

    /// The agent of that place.
    pub(crate) fn agent(&self, agent: usize) -> Result<&Agent, Fault> {
        let n = self.agents.len();
        self.agents
            .get(agent)
            .ok_or_else(|| Fault::config("agent", format!("agent = {agent} is not below {n}")))
    }

    /// The learner of that place.
    pub(crate) fn learner(&self, agent: usize) -> Result<&LearnerMind, Fault> {
        let found = self.agent(agent)?.learner();
        found.ok_or_else(|| Fault::config("agent", format!("agent {agent} does not learn")))
    }

    /// Time of a control step, or of a whole movement if that is one action \[s\].
    fn period(&self) -> Result<f64, Fault> {
        let period = 1.0 / self.task.spec().control_hz;
        if making::options(&self.setup)?.name("control") != "pattern" {
            return Ok(period);
        }
        let steps = erased::babble_steps(&self.task, serde_json::Value::Null)?;
        Ok(steps as f64 * period)
    }

    fn perform(&mut self, command: &Command) -> Result<Happened, Fault> {
        match command {
            Command::Babble { n } => self.babble(*n),
            Command::Recall { case } => self.recall(case.as_ref()),
            Command::Step { n } => self.step(*n),
            Command::Test { n } => self.test(*n),
            Command::Lesion {
                agent,
                map,
                association,
                neurons,
            } => self.lesion(*agent, *map, *association, neurons),
            Command::Change { setup } => {
                self.change(setup)?;
                Ok(Happened::Changed)
            }
            Command::Answer { question, value } => Ok(Happened::Answered {
                question: question.clone(),
                value: value.clone(),
            }),
        }
    }

    fn babble(&mut self, n: u64) -> Result<Happened, Fault> {
        if !self.agents.iter().any(|agent| agent.setup.learns()) {
            let problem = "no agent learns by babbling";
            return Err(Fault::config("agents", problem));
        }
        for agent in &mut self.agents {
            if let Mind::Learner(mind) = &mut agent.mind {
                mind.learn(&self.task, n, &mut self.cost, &mut self.executor)?;
            }
        }
        Ok(Happened::Babbled)
    }

    /// Babbles that each agent has learnt from.
    fn learnt(&self) -> Vec<u64> {
        let learnt = |agent: &Agent| agent.learner().map_or(0, |mind| mind.learner.learnt());
        self.agents.iter().map(learnt).collect()
    }

    fn recall(&mut self, case: Option<&Case>) -> Result<Happened, Fault> {
        Ok(Happened::Recalled {
            drawn: case.is_none(),
            case: self.stage.begin(case)?,
        })
    }

    fn step(&mut self, n: u64) -> Result<Happened, Fault> {
        let (agents, executor) = (&mut self.agents, &mut self.executor);
        let ended = self.stage.step(agents, n, &mut self.cost, executor)?;
        let case = self.stage.case().cloned().unwrap_or_default();
        let palm = self.stage.palm();
        Ok(Happened::Stepped { ended, case, palm })
    }

    fn test(&mut self, n: u64) -> Result<Happened, Fault> {
        let protocol = making::protocol(&self.setup)?;
        let mut most = self.cost;
        let steps = n * self.agents.len() as u64 * u64::from(self.task.spec().max_episode_steps);
        most.add_steps(&*self.task, steps);
        most.check()?;
        let cases = test_cases::cases(&self.task, protocol.name, n, &mut self.executor)?;
        let mut outcomes = Vec::new();
        for agent in &self.agents {
            outcomes.push(test_cases::play(
                agent,
                self.setup.seed,
                &self.task,
                &cases,
                &mut self.cost,
                &mut self.executor,
            )?);
        }
        let success = |all: &Outcomes| all.get("success").copied().unwrap_or(0);
        let (cases, successes) = (cases.len() as u64, outcomes.iter().map(success).collect());
        let point = CurvePoint {
            learnt: self.learnt(),
            cases,
            successes,
            outcomes,
        };
        self.curve.push(point.clone());
        Ok(Happened::Tested {
            cases,
            successes: point.successes,
            outcomes: point.outcomes,
        })
    }

    fn lesion(
        &mut self,
        place: usize,
        map: MapName,
        association: usize,
        neurons: &[usize],
    ) -> Result<Happened, Fault> {
        self.learner(place)?;
        let mut silenced = 0;
        if let Mind::Learner(mind) = &mut self.agents[place].mind {
            mind.lesion(association, map, neurons)?;
            silenced = mind.lesions.len();
        }
        Ok(Happened::Lesioned {
            agent: place,
            silenced,
        })
    }

    /// Agents whose part of the setup stays keep what they have learnt, others begin anew.
    fn change(&mut self, setup: &Setup) -> Result<(), Fault> {
        setup.check()?;
        let task = making::task(setup, &Map::new())?;
        let same_seed = setup.seed == self.setup.seed;
        let same_task = task_name(setup)? == task_name(&self.setup)?;
        let mut agents = Vec::new();
        for (i, agent) in setup.agents.iter().enumerate() {
            let before = self.agents.get(i).filter(|before| before.setup == *agent);
            agents.push(match before.filter(|_| same_seed && same_task) {
                None => Agent::new(agent, setup, &task, i, &self.policies)?,
                Some(before) => {
                    let mut kept = before.clone();
                    kept.move_to(&task)?;
                    kept.with_policy(setup.seed, &task, |_| Ok(()))?;
                    kept
                }
            });
        }
        self.stage = Stage::new(&task, agents.len(), setup.seed)?;
        self.agents = agents;
        self.task = task;
        self.setup = Arc::new(setup.clone());
        Ok(())
    }

    fn snapshot(&self) -> Result<Snapshot, Fault> {
        Ok(Snapshot {
            setup: Arc::clone(&self.setup),
            agents: self.agents.clone(),
            stage: self.stage.snapshot()?,
            lengths: [self.curve.len(), self.commands.len()],
            last: self
                .commands
                .last()
                .cloned()
                .zip(self.history.last().cloned()),
            cost: self.cost,
        })
    }

    fn restore(&mut self, before: &Snapshot) -> Result<(), Fault> {
        self.stage = Stage::restored(&before.stage)?;
        self.task = Arc::clone(self.stage.task());
        self.setup = Arc::clone(&before.setup);
        self.agents.clone_from(&before.agents);
        self.cost = before.cost;
        let [curve, commands] = before.lengths;
        self.curve.truncate(curve);
        self.commands.truncate(commands);
        self.history.truncate(commands);
        // The last ones may have become longer since.
        if let Some((command, event)) = before.last.clone() {
            self.commands[commands - 1] = command;
            self.history[commands - 1] = event;
        }
        Ok(())
    }
}
