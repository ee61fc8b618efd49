//! Agent files: refused by name, or agents that decide and are saved again alike.

use std::collections::HashMap;

use babble_agent::{AgentError, GraspNetwork, Learner, Network, PolicyNetwork, ReachNetwork};
use safetensors::serialize;
use safetensors::tensor::{Dtype, TensorView};
use xxhash_rust::xxh3::Xxh3;

/// Neurons of the fovea's map, whose weights a file of grasping holds.
const FOVEA: usize = babble_env::tasks::grasp::FOVEA_NEURONS;

/// Tensors of an association.
const PARTS: [&str; 3] = ["weights", "a_mean", "g_mean"];

/// An agent of reaching or grasping: a byte for the neurons along the maps, one for a tensor that is
/// too long, eight that fill the tensors, then the JSON. Whether it is one.
pub fn agent_file(data: &[u8]) -> bool {
    let mut taken = tried(data);
    let Some((numbers, json)) = data.split_at_checked(10) else {
        return taken;
    };
    let Ok(json) = std::str::from_utf8(json) else {
        return taken;
    };
    let side = 2 + usize::from(numbers[0] % 4);
    let [n, fovea] = [side * side, FOVEA];
    for (key, names, lengths) in [
        ("gym_babble.reach", &PARTS[..], &[n * n, n, n][..]),
        // Of the conjunctive map.
        ("gym_babble.reach", &PARTS, &[n * n * n, n, n * n]),
        (
            "gym_babble.grasp",
            &[
                "reach.weights",
                "reach.a_mean",
                "reach.g_mean",
                "grasp.weights",
                "grasp.a_mean",
                "grasp.g_mean",
            ],
            &[n * n, n, n, fovea * n, n, fovea],
        ),
    ] {
        let tensors: Vec<Vec<u8>> = lengths
            .iter()
            .enumerate()
            .map(|(i, &length)| {
                let longer = usize::from(numbers[1] == 1 + i as u8);
                let fill = numbers[2..].iter().copied().cycle();
                fill.take(4 * (length + longer)).collect()
            })
            .collect();
        taken |= tried(&file(key, json, names, &tensors));
    }
    taken
}

/// A file that is right in all but what it holds.
fn file(key: &str, json: &str, names: &[&str], tensors: &[Vec<u8>]) -> Vec<u8> {
    let mut hash = Xxh3::new();
    hash.update(json.as_bytes());
    for tensor in tensors {
        hash.update(tensor);
    }
    let fields = json.strip_prefix('{').unwrap_or(json);
    let text = format!("{{\"checksum\":\"{:016x}\",{fields}", hash.digest());
    let views = names.iter().zip(tensors).map(|(name, tensor)| {
        let view = TensorView::new(Dtype::F32, vec![tensor.len() / 4], tensor);
        (*name, view.expect("a tensor"))
    });
    let metadata = HashMap::from([(key.to_owned(), text)]);
    serialize(views, Some(metadata)).expect("a file")
}

fn tried(bytes: &[u8]) -> bool {
    let mut taken = false;
    match Learner::<ReachNetwork>::load(bytes) {
        Ok(learner) => {
            let [b1, b2] = learner
                .network
                .decide([0.4, 0.6], [0.1, -0.2])
                .expect("a decision");
            assert!(b1.is_finite() && b2.is_finite());
            saved_again(&learner);
            taken = true;
        }
        Err(error) => named(&error),
    }
    match Learner::<GraspNetwork>::load(bytes) {
        Ok(learner) => {
            let decided = learner
                .network
                .decide([0.4, 0.6], &[0.5; FOVEA])
                .expect("a decision");
            let postures = [decided.arm, decided.hand];
            assert!(postures.as_flattened().iter().all(|x| x.is_finite()));
            saved_again(&learner);
            taken = true;
        }
        Err(error) => named(&error),
    }
    match PolicyNetwork::load(bytes) {
        Ok(network) => {
            let saved = network.save().expect("a file");
            let again = PolicyNetwork::load(&saved).expect("a network that was saved is one");
            assert_eq!(again.save(), Ok(saved));
            taken = true;
        }
        Err(error) => named(&error),
    }
    taken
}

/// An agent that is saved and read again has the same weights.
fn saved_again<N: Network>(learner: &Learner<N>) {
    let saved = learner.save().expect("a file");
    let again = Learner::<N>::load(&saved).expect("an agent that was saved is one");
    let [ours, theirs] = [learner, &again].map(|learner| learner.network.associations());
    assert_eq!(ours, theirs);
}

fn named(error: &AgentError) {
    let known = matches!(
        error,
        AgentError::File { .. }
            | AgentError::Config { .. }
            | AgentError::Brain(_)
            | AgentError::Env(_)
    );
    assert!(known, "refused by another name: {error}");
}
