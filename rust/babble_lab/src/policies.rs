//! Networks that were trained elsewhere, by name.

use std::collections::BTreeMap;
use std::sync::Arc;

use babble_agent::PolicyNetwork;
use babble_env::option_spec::OptionValues;
use babble_env::registry;
use xxhash_rust::xxh3::xxh3_64;

use crate::fault::Fault;
use crate::making;
use crate::setup::{AgentSetup, Setup};

/// Most networks.
const MOST: usize = 16;
/// Options that a network was trained for: what its actions mean, and what it senses.
const NEEDED: [&str; 4] = [
    "control",
    "arm_touch",
    "enclosure_reflex",
    "reflex_releases",
];

/// Networks by name.
#[derive(Debug, Clone, Default)]
pub struct Policies(BTreeMap<String, Entry>);

#[derive(Debug, Clone)]
struct Entry {
    network: Arc<PolicyNetwork>,
    /// Hash of the file.
    hash: String,
}

impl Policies {
    /// Adds the network in a file's bytes, in place of another one of that name.
    ///
    /// # Errors
    /// A [`Fault`] for bytes that are no network, or if there are too many.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), Fault> {
        if self.0.len() == MOST && !self.0.contains_key(name) {
            let problem = format!("there are {MOST} policies already");
            return Err(Fault::config("name", problem));
        }
        let entry = Entry {
            network: Arc::new(PolicyNetwork::load(bytes)?),
            hash: format!("{:016x}", xxh3_64(bytes)),
        };
        self.0.insert(name.to_owned(), entry);
        Ok(())
    }

    /// The network of that name, if it can act in a setup's environment.
    pub(crate) fn get(&self, name: &str, setup: &Setup) -> Result<Arc<PolicyNetwork>, Fault> {
        let Some(Entry { network, .. }) = self.0.get(name) else {
            return Err(Fault::config(
                "name",
                format!("there is no policy {name:?}"),
            ));
        };
        let (task, _) = registry::environment(&setup.env)?;
        let about = network.about();
        if about.task != task.name {
            let problem = format!("the policy {name:?} is for the task {:?}", about.task);
            return Err(Fault::config("name", problem));
        }
        let theirs = OptionValues::read(task.options, &about.options)?;
        let ours = making::options(setup)?;
        for option in NEEDED {
            if (theirs.name(option), theirs.flag(option)) != (ours.name(option), ours.flag(option))
            {
                let problem = format!("the policy {name:?} was trained with another {option}");
                return Err(Fault::config(&format!("options.{option}"), problem));
            }
        }
        Ok(Arc::clone(network))
    }

    /// Hashes of the files of the networks that setups name.
    pub(crate) fn hashes<'a>(
        &self,
        setups: impl Iterator<Item = &'a Setup>,
    ) -> BTreeMap<String, String> {
        let agents = setups.flat_map(|setup| &setup.agents);
        let names = agents.filter_map(|agent| match agent {
            AgentSetup::Policy { name } => Some(name),
            _ => None,
        });
        let hash = |name: &String| Some((name.clone(), self.0.get(name)?.hash.clone()));
        names.filter_map(hash).collect()
    }
}
