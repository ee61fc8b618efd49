//! Laws of the population codes, Eq. 3 and 4.

use babble_brain::{BrainError, ConjunctiveMap, MapConfig, PopulationMap};
use proptest::prelude::*;

fn config() -> MapConfig {
    MapConfig {
        neurons: [21, 15],
        low: [-60.0, 0.0],
        high: [60.0, 1.0],
        sigma: 0.7,
    }
}

fn map() -> PopulationMap {
    PopulationMap::new(&config()).unwrap()
}

/// The value at a place counted in spacings from the first neuron.
fn at(place: [f64; 2]) -> [f64; 2] {
    [-60.0 + 6.0 * place[0], place[1] / 14.0]
}

/// Distance of two values along each axis, in spacings.
fn spacings(p: [f64; 2], q: [f64; 2]) -> f64 {
    ((p[0] - q[0]) / 6.0)
        .abs()
        .max(((p[1] - q[1]) * 14.0).abs())
}

fn encoded(x: [f64; 2]) -> Vec<f32> {
    let mut a = vec![f32::NAN; map().len()];
    map().encode(x, &mut a);
    a
}

/// Rows run along the first value, and the ends are preferred exactly.
/// Catches column-major indices and a spacing of (high - low) / n.
#[test]
fn neurons_are_row_major_from_low_to_high() {
    let map = map();
    assert_eq!(map.len(), 315);
    assert_eq!(map.preferred(0), [-60.0, 0.0]);
    assert_eq!(map.preferred(20), [60.0, 0.0]);
    assert_eq!(map.preferred(21), [-60.0, 1.0 / 14.0]);
    assert_eq!(map.preferred(314), [60.0, 1.0]);
}

/// A silent map reads its middle, by both read-outs; so does one whose stimulus is out of sight or
/// no number. Catches a division 0/0.
#[test]
fn silent_map_reads_the_middle() {
    for x in [[1e9, 0.0], [f64::NAN, 0.5], [f64::INFINITY, 0.5]] {
        let a = encoded(x);
        assert!(a.iter().all(|&a_j| a_j == 0.0));
        assert_eq!(map().read_out(&a), [0.0, 0.5]);
        assert_eq!(map().read_out_peak(&a, 2), [0.0, 0.5]);
    }
}

/// The mean of two bumps lies between them, the peak read-out stays with the stronger, and with
/// the first of two equals. Catches a window around the wrong neuron.
#[test]
fn peak_read_out_takes_one_of_two_bumps() {
    let (left, right) = (at([4.0, 7.0]), at([16.0, 7.0]));
    let mix = |weight: f32| -> Vec<f32> {
        let (l, r) = (encoded(left), encoded(right));
        l.iter().zip(&r).map(|(l, r)| l + weight * r).collect()
    };
    assert!(spacings(map().read_out(&mix(1.0)), at([10.0, 7.0])) < 1e-5);
    assert!(spacings(map().read_out_peak(&mix(1.0), 2), left) < 1e-3);
    assert!(spacings(map().read_out_peak(&mix(1.1), 2), right) < 1e-3);
    let all = map().read_out_peak(&mix(1.1), usize::MAX);
    assert_eq!(all, map().read_out(&mix(1.1)));
}

#[test]
fn bad_configs_are_named() {
    let field = |change: fn(&mut MapConfig)| {
        let mut config = config();
        change(&mut config);
        match PopulationMap::new(&config) {
            Err(BrainError::OutOfRange { field, .. }) => field,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(field(|c| c.neurons[1] = 1), "neurons[1]");
    assert_eq!(field(|c| c.neurons[0] = 1 << 40), "neurons[0]");
    assert_eq!(field(|c| c.low[0] = f64::NAN), "low[0]");
    assert_eq!(field(|c| c.high[1] = 0.0), "high[1]");
    assert_eq!(
        field(|c| (c.low[0], c.high[0]) = (-1.5e308, 1.5e308)),
        "high[0]"
    );
    assert_eq!(field(|c| c.sigma = 0.0), "sigma");
    assert_eq!(field(|c| c.sigma = f64::INFINITY), "sigma");
    let unknown = "neurons = [21, 21]\nlow = [0, 0]\nhigh = [1, 1]\nsigma = 0.7\nsquare = true";
    assert!(toml::from_str::<MapConfig>(unknown).is_err());
}

proptest! {
    /// Each activity is Eq. 3 of the distance in spacings, inside and outside of the map.
    /// Catches σ in the unit of the values, a missing square and swapped axes.
    #[test]
    fn encodes_equation_3(place in [-5.0..25.0, -5.0..19.0]) {
        let x = at(place);
        for (j, g) in encoded(x).into_iter().enumerate() {
            let (dx, dy) = (place[0] - (j % 21) as f64, place[1] - (j / 21) as f64);
            let expected = (-(dx * dx + dy * dy) / (2.0 * 0.7 * 0.7)).exp();
            prop_assert!((f64::from(g) - expected).abs() < 1e-6 * expected + 2e-38);
        }
    }

    /// Reading out an encoded value returns it, two spacings inside the map.
    /// Catches an offset of half a spacing and unnormalised sums.
    #[test]
    fn read_out_inverts_encoding(place in [2.0..18.0, 2.0..12.0]) {
        let x = at(place);
        prop_assert!(spacings(map().read_out(&encoded(x)), x) < 0.01);
    }

    /// At the border the missing half of the bump pulls the read-out inside, by at most 0.35
    /// spacings with σ = 0.7.
    #[test]
    fn read_out_is_pulled_inside_at_the_border(place in [0.0..20.0, 0.0..14.0]) {
        let x = at(place);
        prop_assert!(spacings(map().read_out(&encoded(x)), x) < 0.35);
    }

    /// A pair's activity is proportional to the product of its neurons', all sum to one, and the
    /// first map's index runs inside. Catches swapped maps and normalising one map alone.
    #[test]
    fn conjunction_is_the_normalised_product(p0 in [0.0..20.0, 0.0..14.0], p1 in [0.0..20.0, 0.0..14.0]) {
        let small = MapConfig { neurons: [5, 5], low: [0.0; 2], high: [1.0; 2], sigma: 0.7 };
        let small = PopulationMap::new(&small).unwrap();
        let (x0, x1) = (at(p0), [p1[0] / 20.0, p1[1] / 14.0]);
        let (g0, mut g1) = (encoded(x0), vec![0.0; 25]);
        small.encode(x1, &mut g1);
        let pairs = ConjunctiveMap::new(map(), small);
        let mut g = vec![f32::NAN; pairs.len()];
        pairs.encode(x0, x1, &mut g);
        let total = |g: &[f32]| g.iter().copied().map(f64::from).sum::<f64>();
        prop_assert!((total(&g) - 1.0).abs() < 1e-5);
        let scale = 1.0 / (total(&g0) * total(&g1));
        for (j, &g_j) in g.iter().enumerate() {
            let expected = f64::from(g0[j % 315]) * f64::from(g1[j / 315]) * scale;
            prop_assert!((f64::from(g_j) - expected).abs() < 1e-6 * expected + 2e-38);
        }
    }
}
