//! "Open in Python": the lines that make the same agent, seed and config.

use std::fmt::Write;

use serde_json::{Map, Value};

use crate::command::Command;
use crate::expression::RuleExpression;
use crate::fault::Fault;
use crate::lab::Lab;
use crate::making;
use crate::setup::AgentSetup;

impl Lab {
    /// Lines of Python that make the same agent, seed and config, and let it learn as much.
    ///
    /// # Errors
    /// A [`Fault`] for an agent that does not exist.
    pub fn python(&self, agent: usize) -> Result<String, Fault> {
        let made = self.agent(agent)?;
        let setup = &self.setup;
        let mut config = Map::new();
        if setup.profile != "paper" {
            config.insert("profile".to_owned(), setup.profile.clone().into());
        }
        config.extend(making::config_fields(setup)?);
        let mut arguments = vec![literal(&setup.env.clone().into())];
        let mut lines = "import gymnasium as gym\nimport gym_babble\n\n".to_owned();
        if !config.is_empty() {
            let _ = writeln!(lines, "config = {}", literal(&config.into()));
            arguments.push("config=config".to_owned());
        }
        let option = |(name, value): (&String, &Value)| format!("{name}={}", literal(value));
        arguments.extend(setup.options.iter().map(option));
        let _ = writeln!(lines, "env = gym.make({})", arguments.join(", "));
        lines += &self.agent_lines(&made.setup, agent)?;
        let _ = writeln!(lines, "observation, info = env.reset(seed={})", setup.seed);
        lines += "state, done = None, False\nwhile not done:\n";
        lines += "    action, state = agent.predict(observation, state)\n";
        lines += "    observation, reward, terminated, truncated, info = env.step(action)\n";
        lines += "    done = terminated or truncated\n";
        lines += "print(info[\"outcome\"])\n";
        Ok(lines)
    }

    fn agent_lines(&self, agent: &AgentSetup, place: usize) -> Result<String, Fault> {
        let seed = self.setup.seed;
        let (variant, brain) = match agent {
            AgentSetup::Random {} => {
                return Ok(format!("agent = gym_babble.Random(env, seed={seed})\n"));
            }
            AgentSetup::Scripted {} => return Ok("agent = gym_babble.Scripted(env)\n".to_owned()),
            AgentSetup::Oracle {} => return Ok("agent = gym_babble.Oracle(env)\n".to_owned()),
            AgentSetup::Approach {} => {
                let problem = "the agent that bends its elbow is of the lab alone";
                return Err(Fault::config("agent", problem));
            }
            AgentSetup::Policy { name } => {
                let file = literal(&format!("{name}.safetensors").into());
                return Ok(format!("agent = gym_babble.load_agent({file}, env)\n"));
            }
            AgentSetup::Hebb { variant, brain, .. } => (variant, brain),
        };
        let mut lines = String::new();
        let rule = self.learner(place)?.rule.as_ref();
        if let Some(rule) = rule {
            lines += &rule_lines(rule);
        }
        let changed = |command: &Command| matches!(command, Command::Change { .. });
        if self.commands.iter().any(changed) {
            lines +=
                "# The setup was changed meanwhile: this agent has learnt in the last one alone.\n";
        }
        let mind = self.learner(place)?;
        if !mind.lesions.is_empty() {
            lines += "# Without the silenced neurons.\n";
        }
        let mut arguments = format!(
            "env, variant={}, seed={seed}",
            literal(&variant.clone().into())
        );
        if rule.is_some() {
            arguments += ", rule=rule";
        }
        if !brain.is_empty() {
            let _ = write!(arguments, ", brain={}", literal(&brain.clone().into()));
        }
        let _ = writeln!(lines, "agent = gym_babble.HebbBabbling({arguments})");
        if mind.learner.learnt() > 0 {
            let _ = writeln!(
                lines,
                "agent.learn({}, progress_bar=True)",
                mind.learner.learnt()
            );
        }
        Ok(lines)
    }
}

/// The rule as a function of arrays, whose results are the same but for rounding.
fn rule_lines(rule: &RuleExpression) -> String {
    let mut expression = rule.to_string().replace('^', "**");
    for (name, function) in [
        ("abs(", "np.abs("),
        ("min(", "np.minimum("),
        ("max(", "np.maximum("),
        ("tanh(", "np.tanh("),
        ("exp(", "np.exp("),
        ("sqrt(", "np.sqrt("),
        ("sign(", "np.sign("),
    ] {
        expression = expression.replace(name, function);
    }
    let result = format!("    return np.zeros_like(w) + ({expression})");
    [
        "",
        "import numpy as np",
        "",
        "def rule(a, a_mean, g, g_mean, w, eta, w_max):",
        "    a, a_mean = a[:, None], a_mean[:, None]",
        &result,
        "",
        "",
    ]
    .join("\n")
}

/// A value as Python writes it.
fn literal(value: &Value) -> String {
    match value {
        Value::Null => "None".to_owned(),
        Value::Bool(true) => "True".to_owned(),
        Value::Bool(false) => "False".to_owned(),
        Value::Number(number) => number.to_string(),
        // What JSON escapes, Python reads likewise.
        Value::String(_) => value.to_string(),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(literal).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Object(fields) => {
            let field = |(name, value): (&String, &Value)| {
                format!("{}: {}", Value::from(name.clone()), literal(value))
            };
            let fields: Vec<String> = fields.iter().map(field).collect();
            format!("{{{}}}", fields.join(", "))
        }
    }
}
