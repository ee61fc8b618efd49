//! Laws of the population codes, Eq. 3 and 4.

use babble_brain::{BrainError, ConjunctiveMap, MapConfig, PopulationMap};
use proptest::prelude::*;

fn config() -> MapConfig {
    MapConfig {
        neurons: vec![21, 15],
        low: vec![-60.0, 0.0],
        high: vec![60.0, 1.0],
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
    map().encode(&x, &mut a).unwrap();
    a
}

fn read(a: &[f32]) -> [f64; 2] {
    let mut x = [f64::NAN; 2];
    map().read_out(a, &mut x).unwrap();
    x
}

fn read_peak(a: &[f32], radius: usize) -> [f64; 2] {
    let mut x = [f64::NAN; 2];
    map().read_out_peak(a, radius, &mut x).unwrap();
    x
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
        assert_eq!(read(&a), [0.0, 0.5]);
        assert_eq!(read_peak(&a, 2), [0.0, 0.5]);
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
    assert!(spacings(read(&mix(1.0)), at([10.0, 7.0])) < 1e-5);
    assert!(spacings(read_peak(&mix(1.0), 2), left) < 1e-3);
    assert!(spacings(read_peak(&mix(1.1), 2), right) < 1e-3);
    let all = read_peak(&mix(1.1), usize::MAX);
    assert_eq!(all, read(&mix(1.1)));
}

fn of_axes(axes: usize) -> MapConfig {
    MapConfig {
        neurons: vec![9; axes],
        low: vec![0.0; axes],
        high: vec![1.0; axes],
        sigma: 0.7,
    }
}

/// Maps of one to four axes: each activity is Eq. 3 at the neuron's preferred value, the first axis
/// runs fastest, and both read-outs give the stimulus back; a batch is its stimuli one by one.
/// Catches an axis left out or exchanged with another.
#[test]
fn maps_of_any_number_of_axes() {
    for axes in 1..=4 {
        let map = PopulationMap::new(&of_axes(axes)).unwrap();
        assert_eq!(map.len(), 9_usize.pow(axes as u32));
        assert_eq!(map.preferred(1)[0], 0.125);
        let x: Vec<f64> = (0..2 * axes).map(|i| 0.3 + 0.05 * i as f64).collect();
        let mut g = vec![0.0; 2 * map.len()];
        map.encode(&x, &mut g).unwrap();
        for (x, g) in x.chunks_exact(axes).zip(g.chunks_exact(map.len())) {
            for (j, &g_j) in g.iter().enumerate() {
                let differences = map.preferred(j).into_iter().zip(x);
                let square: f64 = differences.map(|(p, x)| (8.0 * (p - x)).powi(2)).sum();
                let expected = (-square / (2.0 * 0.7 * 0.7)).exp();
                assert!((f64::from(g_j) - expected).abs() < 1e-6 * expected + 2e-38);
            }
        }
        let (mut mean, mut peak) = (vec![0.0; 2 * axes], vec![0.0; 2 * axes]);
        map.read_out(&g, &mut mean).unwrap();
        map.read_out_peak(&g, 2, &mut peak).unwrap();
        for ((x, mean), peak) in x.iter().zip(mean).zip(peak) {
            assert!((x - mean).abs() < 0.01 / 8.0 && (x - peak).abs() < 0.02 / 8.0);
        }
    }
}

/// Slices that do not fit are refused by name. Catches a panic on a user's lengths.
#[test]
fn bad_lengths_are_named() {
    let field = |result: Result<(), BrainError>| match result {
        Err(BrainError::Length { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    assert_eq!(field(map().encode(&[0.0; 3], &mut [0.0; 315])), "x");
    assert_eq!(field(map().encode(&[0.0; 2], &mut [0.0; 316])), "out");
    assert_eq!(field(map().read_out(&[0.0; 314], &mut [0.0; 2])), "a");
    assert_eq!(field(map().read_out(&[0.0; 315], &mut [0.0; 3])), "out");
    let pairs = ConjunctiveMap::new(map(), map());
    assert_eq!(field(pairs.encode(&[0.0; 2], &[0.0; 4], &mut [])), "x1");
    let uneven = MapConfig {
        low: vec![0.0],
        ..config()
    };
    assert_eq!(field(PopulationMap::new(&uneven).map(|_| ())), "low");
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
    assert_eq!(field(|c| c.neurons.clear()), "axes");
    assert_eq!(field(|c| *c = of_axes(9)), "axes");
    assert_eq!(field(|c| *c = of_axes(8)), "neurons");
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
        prop_assert!(spacings(read(&encoded(x)), x) < 0.01);
    }

    /// At the border the missing half of the bump pulls the read-out inside, by at most 0.35
    /// spacings with σ = 0.7.
    #[test]
    fn read_out_is_pulled_inside_at_the_border(place in [0.0..20.0, 0.0..14.0]) {
        let x = at(place);
        prop_assert!(spacings(read(&encoded(x)), x) < 0.35);
    }

    /// A pair's activity is proportional to the product of its neurons', all sum to one, and the
    /// first map's index runs inside. Catches swapped maps and normalising one map alone.
    #[test]
    fn conjunction_is_the_normalised_product(p0 in [0.0..20.0, 0.0..14.0], p1 in [0.0..20.0, 0.0..14.0]) {
        let small = MapConfig::square(5, 0.0, 1.0, 0.7);
        let small = PopulationMap::new(&small).unwrap();
        let (x0, x1) = (at(p0), [p1[0] / 20.0, p1[1] / 14.0]);
        let (g0, mut g1) = (encoded(x0), vec![0.0; 25]);
        small.encode(&x1, &mut g1).unwrap();
        let pairs = ConjunctiveMap::new(map(), small);
        let mut g = vec![f32::NAN; pairs.len()];
        pairs.encode(&x0, &x1, &mut g).unwrap();
        let total = |g: &[f32]| g.iter().copied().map(f64::from).sum::<f64>();
        prop_assert!((total(&g) - 1.0).abs() < 1e-5);
        let scale = 1.0 / (total(&g0) * total(&g1));
        for (j, &g_j) in g.iter().enumerate() {
            let expected = f64::from(g0[j % 315]) * f64::from(g1[j / 315]) * scale;
            prop_assert!((f64::from(g_j) - expected).abs() < 1e-6 * expected + 2e-38);
        }
    }
}
