//! Laws of watched babbles: a film shows what is learnt, and looking changes nothing.

mod common;

use babble_agent::erased::{self, brain_of};
use babble_env::Config;
use babble_lab::{Film, Lab};
use common::{GRASP, REACH, babble, lab, recall, setup};
use serde_json::{Map, Value};

const AGENTS: [(&str, &str); 4] = [
    (REACH, "paper"),
    (REACH, "conjunctive"),
    (GRASP, "paper"),
    (GRASP, "chain"),
];

/// The babbles up to the first one that can be learnt from.
fn films(lab: &Lab) -> Vec<Film> {
    let mut all = Vec::new();
    for ahead in 0..200 {
        all.push(lab.film(0, ahead).unwrap());
        if all[all.len() - 1].learnable {
            return all;
        }
    }
    panic!("nothing to learn from");
}

/// Catches a film of another babble than the next one, and one that moves the sequence on.
#[test]
fn the_films_are_those_of_the_babbles_that_are_learnt_from_next() {
    for (env, variant) in AGENTS {
        let mut watched = lab(setup(env, &[variant]));
        let mut fast = lab(setup(env, &[variant]));
        for _ in 0..4 {
            let films = films(&watched);
            watched.apply(&babble(1)).unwrap();
            let babbled = watched.state().unwrap().agents[0].babbled;
            assert_eq!(films.last().unwrap().number, babbled, "{env} {variant}");
            let numbers: Vec<u64> = films.iter().map(|film| film.number).collect();
            let first = babbled + 1 - numbers.len() as u64;
            assert_eq!(numbers, (first..=babbled).collect::<Vec<_>>());
        }
        fast.apply(&babble(4)).unwrap();
        assert_eq!(watched.hash(), fast.hash());
        let record = |lab: &Lab| lab.record(None, "").unwrap();
        assert_eq!(record(&watched), record(&fast));
    }
}

/// The weights after one babble are those of Eq. 7 with the activities of its film: Δw = η (a − ā) (g − ḡ)
/// (`w_max` − |w|) from w = ā = ḡ = 0 on. Catches activities of another moment or map.
#[test]
fn eq_7_learns_from_the_activities_of_the_film() {
    // The chain learns by another rule.
    for &(env, variant) in &AGENTS[..3] {
        let mut lab = lab(setup(env, &[variant]));
        let films = films(&lab);
        let film = films.last().unwrap();
        lab.apply(&babble(1)).unwrap();
        let brain = lab.brain(0).unwrap().unwrap();
        let of_maps = brain.associations.iter();
        let sizes: Vec<[usize; 2]> = of_maps
            .map(|one| [&one.input, &one.output].map(|map| map.activity.len()))
            .collect();
        let per_moment: usize = sizes.iter().flatten().sum();
        assert_eq!(film.activities.len(), film.moments.len() * per_moment);
        let mut from = 0;
        for (i, [n_in, n_out]) in sizes.into_iter().enumerate() {
            let moments = film.activities.chunks_exact(per_moment);
            let maps: Vec<(&[f32], &[f32])> = moments
                .map(|one| one[from..from + n_in + n_out].split_at(n_in))
                .collect();
            from += n_in + n_out;
            let first = maps[0].0;
            let most = (0..n_in).fold(0, |best, k| if first[k] > first[best] { k } else { best });
            let expected = eq_7(&maps, most, n_out);
            let found = lab.weights(0, i, babble_lab::MapName::Input, most).unwrap();
            for (j, (&w, expected)) in found.activity.iter().zip(expected).enumerate() {
                let near = (f64::from(w) - expected).abs() < 1e-5;
                assert!(near, "{env} {variant} {i} {j}: {w} is not {expected}");
            }
        }
    }
}

/// Weights from one input neuron to all output neurons after some moments, with the paper's numbers.
fn eq_7(maps: &[(&[f32], &[f32])], neuron: usize, n_out: usize) -> Vec<f64> {
    let (eta, w_max, xi) = (1.0, 0.2, 0.2);
    let (mut w, mut a_mean, mut g_mean) = (vec![0.0; n_out], vec![0.0; n_out], 0.0);
    for (g, a) in maps {
        let g = f64::from(g[neuron]);
        for j in 0..n_out {
            let a = f64::from(a[j]);
            let room: f64 = w_max - f64::abs(w[j]);
            w[j] += eta * (a - a_mean[j]) * (g - g_mean) * room;
            a_mean[j] = xi * a_mean[j] + (1.0 - xi) * a;
        }
        g_mean = xi * g_mean + (1.0 - xi) * g;
    }
    w
}

/// Catches frames of another period, and a film that ends before the babble.
#[test]
fn a_film_has_a_frame_for_each_control_period_and_moves() {
    for (env, variant) in AGENTS {
        let lab = lab(setup(env, &[variant]));
        let films = films(&lab);
        let film = films.last().unwrap();
        assert!((film.period - 0.05).abs() < 1e-12);
        // A babble of the chain goes on as soon as the palm touches; the others take their whole time.
        let task = babble_env::make(env, Config::profile("paper").unwrap(), &Map::new()).unwrap();
        let brain = brain_of(if env == REACH { "reach" } else { "grasp" }, variant).unwrap();
        let learner = erased::learner(&task, brain, 0, Value::Null).unwrap();
        let (steps, most) = (film.frames.len() - 1, learner.babble_steps(&task).unwrap());
        let fits = steps == most || (variant == "chain" && steps < most);
        assert!(fits, "{env} {variant}: {steps} of {most} steps");
        let tips: Vec<[f64; 3]> = film.frames.iter().map(|scene| scene.fingertip).collect();
        assert!(tips.windows(2).any(|pair| pair[0] != pair[1]));
        assert!(film.moments.is_sorted() && *film.moments.last().unwrap() < film.frames.len());
        let parts = |scene: &babble_lab::Scene| -> Vec<&str> {
            scene.solids.iter().map(|solid| solid.part).collect()
        };
        assert!(
            film.frames
                .iter()
                .all(|scene| parts(scene) == parts(&film.frames[0]))
        );
    }
}

#[test]
fn an_agent_that_does_not_learn_has_no_film() {
    let mut scripted = setup(REACH, &["paper"]);
    scripted.agents.push(babble_lab::AgentSetup::Scripted {});
    let fault = lab(scripted).film(1, 0).unwrap_err();
    assert_eq!(fault.field.as_deref(), Some("agent"));
}

/// The first case of the seed is there to be seen before it begins.
#[test]
fn what_is_seen_before_the_first_case_is_that_case() {
    for env in [REACH, GRASP] {
        let mut lab = lab(setup(env, &["paper"]));
        let before = (
            lab.scene(0).unwrap(),
            lab.sight(0).unwrap(),
            lab.brain(0).unwrap(),
        );
        assert!(lab.state().unwrap().episode.is_none());
        lab.apply(&recall()).unwrap();
        let after = (
            lab.scene(0).unwrap(),
            lab.sight(0).unwrap(),
            lab.brain(0).unwrap(),
        );
        assert_eq!(before, after, "{env}");
    }
}

#[test]
fn maps_have_a_name_for_each_axis() {
    for (env, variant) in AGENTS {
        let lab = lab(setup(env, &[variant]));
        for one in lab.brain(0).unwrap().unwrap().associations {
            for map in [one.input, one.output] {
                assert_eq!(
                    map.axes.len(),
                    map.shape.len(),
                    "{env} {variant} {}",
                    map.name
                );
                assert!(map.axes.iter().all(|axis| axis.range[0] < axis.range[1]));
            }
        }
    }
}
