//! Pictures of photons: the photon transfer curve, the numbers of photons, mosaics, and that nothing but the seed and the place of a
//! pixel decides its noise.

use bilux_math::Rgb;
use bilux_math::transcendental::exp_f64;
use bilux_math::{Stream, poisson};
use bilux_pictures::sensor::{Pattern, Sensor};
use bilux_pictures::{Crop, Picture};

/// Standard deviations that no correct estimate is off by: one in 290,000.
const SIGMAS: f64 = 4.65;
const SIDE: usize = 256;

fn sensor() -> Sensor {
    Sensor {
        unit: 1.0,
        exposure_time: 0.01,
        f_number: 2.8,
        transmission: 1.0,
        pixel_pitch: 3.45e-6,
        wavelength: [600e-9, 555e-9, 450e-9],
        quantum_efficiency: [0.45, 0.6, 0.5],
        full_well: 20_000.0,
        dark_current: 300.0,
        read_noise: 5.0,
        dark_nonuniformity: 0.0,
        response_nonuniformity: 0.0,
        gain: 0.1,
        iso: 0.0,
        black_level: 20.0,
        bit_depth: 12,
        pattern: Pattern::Mono,
        seed: 7,
    }
}

fn grey(radiance: f64) -> Picture {
    Picture::from_rgb(SIDE, SIDE, vec![Rgb::grey(radiance as f32); SIDE * SIDE]).unwrap()
}

fn numbers(sensor: &Sensor, radiance: f64) -> Vec<f64> {
    let raw = sensor.read(&grey(radiance)).unwrap().raw;
    raw.channel("Y").unwrap().iter().map(|&number| f64::from(number)).collect()
}

/// Mean, variance and third central moment.
fn moments(numbers: &[f64]) -> [f64; 3] {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let central = |of: fn(f64) -> f64| numbers.iter().map(|x| of(x - mean)).sum::<f64>() / count;
    [mean, central(|x| x * x) * count / (count - 1.0), central(|x| x * x * x)]
}

/// Compares means and variances over the range of a sensor with [EMVA 1288, section 2]: the slope of variance over mean is the gain, and the
/// intercept is what reading and rounding add.
fn photon_transfer(read: impl Fn(&Sensor, f64) -> Vec<f64>) -> Result<(), String> {
    let sensor = sensor();
    for photons in [0.0, 10.0, 100.0, 1_000.0, 10_000.0, 30_000.0] {
        let radiance = photons / sensor.photons(1.0, 1);
        let found = read(&sensor, radiance);
        let [mean, variance, _] = moments(&found);
        let electrons = 0.6 * photons + 3.0;
        let expected_mean = 20.0 + 0.1 * electrons;
        let expected = 0.01 * (electrons + 25.0) + 1.0 / 12.0;
        let count = found.len() as f64;
        let off = [
            (mean - expected_mean) / (expected / count).sqrt(),
            (variance - expected) / (expected * (2.0 / count).sqrt()),
        ];
        if off.iter().any(|sigmas| sigmas.abs() > SIGMAS) {
            return Err(format!("{photons} photons: off by {off:?} standard deviations"));
        }
    }
    Ok(())
}

#[test]
fn variance_over_mean_is_the_photon_transfer_curve() {
    photon_transfer(numbers).unwrap();
}

#[test]
fn planted_bugs_bend_the_photon_transfer_curve() {
    let squared = |sensor: &Sensor, light: f64| {
        numbers(&Sensor { gain: sensor.gain * sensor.gain, ..sensor.clone() }, light)
    };
    let shot_before_efficiency = |sensor: &Sensor, light: f64| {
        let mut stream = Stream::new([1]);
        let read = |_| {
            let electrons = 0.6 * poisson(sensor.photons(light, 1), &mut stream) + 3.0;
            (20.5 + 0.1 * (electrons + 5.0 * stream.normal())).floor()
        };
        (0..SIDE * SIDE).map(read).collect()
    };
    let unrounded = |sensor: &Sensor, light: f64| {
        let fine = Sensor { bit_depth: 16, gain: 10.0 * sensor.gain, black_level: 200.0, ..sensor.clone() };
        numbers(&fine, light).into_iter().map(|number| number / 10.0).collect()
    };
    let without_reading =
        |sensor: &Sensor, light: f64| numbers(&Sensor { read_noise: 0.0, ..sensor.clone() }, light);
    assert!(photon_transfer(squared).is_err());
    assert!(photon_transfer(shot_before_efficiency).is_err());
    assert!(photon_transfer(unrounded).is_err());
    assert!(photon_transfer(without_reading).is_err());
}

#[test]
fn a_full_well_and_the_largest_number_end_the_curve() {
    let sensor = sensor();
    let bright = 100_000.0 / sensor.photons(1.0, 1);
    let [mean, variance, _] = moments(&numbers(&Sensor { read_noise: 0.0, ..sensor.clone() }, bright));
    assert_eq!((mean, variance), (20.0 + 2_000.0, 0.0));
    let reading = Sensor { gain: 1.0, ..sensor.clone() }.read(&grey(bright)).unwrap();
    assert!(reading.raw.channel("Y").unwrap().iter().all(|&number| number == 4095.0));
    assert_eq!(reading.saturated, (SIDE * SIDE) as u64);
    // A pixel with three numbers is one pixel.
    let reading = Sensor { gain: 1.0, pattern: Pattern::Prism, ..sensor }.read(&grey(bright)).unwrap();
    assert_eq!(reading.saturated, (SIDE * SIDE) as u64);
}

/// Distance of a sample from Poisson numbers of this mean, by its first three moments, in standard deviations.
fn far_from_poisson(numbers: &[f64], mean: f64) -> f64 {
    let [first, second, third] = moments(numbers);
    let count = numbers.len() as f64;
    let off = [
        (first - mean) / (mean / count).sqrt(),
        (second - mean) / ((mean + 2.0 * mean * mean) / count).sqrt(),
        // Var of the third sample moment of a Poisson variable, by its cumulants. [Kendall 1994]
        (third - mean) / ((mean + 18.0 * mean * mean + 6.0 * mean * mean * mean) / count).sqrt(),
    ];
    off.iter().fold(0.0, |most: f64, sigmas| most.max(sigmas.abs()))
}

#[test]
fn poisson_numbers_have_their_moments() {
    const COUNT: usize = 200_000;
    for mean in [0.01, 0.7, 3.0, 9.99, 10.01, 30.0, 200.0, 1e5] {
        let mut stream = Stream::new([11, f64::to_bits(mean)]);
        let numbers: Vec<f64> = (0..COUNT).map(|_| poisson(mean, &mut stream)).collect();
        let far = far_from_poisson(&numbers, mean);
        assert!(far < SIGMAS, "mean {mean}: {far}");
        // A normal number, rounded, has no third moment.
        if (3.0..100.0).contains(&mean) {
            let normal = |_| (mean + mean.sqrt() * stream.normal()).round();
            let rounded: Vec<f64> = (0..COUNT).map(normal).collect();
            assert!(far_from_poisson(&rounded, mean) > SIGMAS, "mean {mean}");
        }
    }
    assert_eq!(poisson(0.0, &mut Stream::new([0])), 0.0);
}

#[test]
fn poisson_numbers_are_as_frequent_as_they_are_likely() {
    const COUNT: usize = 200_000;
    for mean in [2.5, 12.0, 40.0] {
        let mut stream = Stream::new([12, f64::to_bits(mean)]);
        let mut found = [0.0; 120];
        (0..COUNT).for_each(|_| found[poisson(mean, &mut stream) as usize] += 1.0);
        let (mut likely, mut statistic, mut cells) = (exp_f64(-mean), 0.0, 0.0);
        for (k, found) in found.iter().enumerate() {
            let expected = likely * COUNT as f64;
            if expected >= 10.0 {
                statistic += (found - expected) * (found - expected) / expected;
                cells += 1.0;
            }
            likely *= mean / (k + 1) as f64;
        }
        // χ² is normal enough for so many cells.
        assert!((statistic - cells) / (2.0 * cells).sqrt() < SIGMAS, "mean {mean}: {statistic} of {cells}");
    }
}

#[test]
fn photons_are_those_of_the_standard() {
    // In µm², ms, µm and µW/cm². [EMVA 1288, section 2]
    let irradiance = 100.0 * std::f64::consts::PI / (4.0 * 2.8 * 2.8);
    let photons = 50.34 * 3.45 * 3.45 * 10.0 * 0.555 * irradiance;
    assert!((sensor().photons(1.0, 1) / photons - 1.0).abs() < 1e-3);
}

#[test]
fn iso_speed_sets_the_gain_and_follows_from_it() {
    let sensor = Sensor { iso: 800.0, ..sensor() };
    assert!((sensor.iso_speed() - 800.0).abs() < 1e-9);
    assert!(
        (sensor.system_gain() / Sensor { iso: 400.0, ..sensor.clone() }.system_gain() - 2.0).abs() < 1e-12
    );
    // 78 over the exposure that saturates, in lx s: the irradiance in lx of the luminance that saturates, times the time.
    let dark = Sensor { dark_current: 0.0, ..sensor };
    let exposure = dark.saturating_luminance() * std::f64::consts::PI / (4.0 * 2.8 * 2.8) * 0.01;
    assert!((78.0 / exposure - 800.0).abs() < 1e-6);
}

#[test]
fn developed_light_is_the_light_of_the_scene() {
    let light = Rgb::new(0.02, 0.05, 0.03);
    for name in Pattern::NAMES {
        let pattern = Pattern::named(name).unwrap();
        let sensor = Sensor { pattern, ..sensor() };
        let picture = Picture::from_rgb(SIDE, SIDE, vec![light; SIDE * SIDE]).unwrap();
        let seen = sensor.developed(&sensor.read(&picture).unwrap().raw).unwrap();
        let wanted =
            if pattern == Pattern::Mono { vec![light.luminance()] } else { light.to_array().to_vec() };
        assert_eq!(seen.channels().len(), wanted.len());
        for (channel, wanted) in seen.channels().iter().zip(wanted) {
            let mean = channel.samples.iter().map(|&x| f64::from(x)).sum::<f64>() / (SIDE * SIDE) as f64;
            assert!(
                (mean / f64::from(wanted) - 1.0).abs() < 0.005,
                "{name} {}: {mean}, {wanted}",
                channel.name
            );
        }
    }
}

#[test]
fn mosaics_have_their_colours_in_place() {
    let sensor = Sensor { pattern: Pattern::named("grbg").unwrap(), read_noise: 0.0, ..sensor() };
    let red = Picture::from_rgb(4, 2, vec![Rgb::new(0.5, 0.0, 0.0); 8]).unwrap();
    let raw = sensor.read(&red).unwrap().raw;
    let bright: Vec<bool> = raw.channel("Y").unwrap().iter().map(|&number| number > 100.0).collect();
    assert_eq!(bright, [false, true, false, true, false, false, false, false]);
}

#[test]
fn noise_depends_on_the_seed_and_the_place_alone() {
    let sensor = Sensor { response_nonuniformity: 0.02, dark_nonuniformity: 3.0, ..sensor() };
    let by_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| numbers(&sensor, 0.1))
    };
    let whole = by_threads(1);
    assert_eq!(whole, by_threads(3));
    let other = numbers(&Sensor { seed: 8, ..sensor.clone() }, 0.1);
    assert_ne!(whole, other);
    let mut part = Picture::from_rgb(8, 4, vec![Rgb::grey(0.1); 32]).unwrap();
    part.crop = Some(Crop { x: 16, y: 3, whole: [SIDE, SIDE] });
    let raw = sensor.read(&part).unwrap().raw;
    for (row, samples) in raw.channel("Y").unwrap().chunks(8).enumerate() {
        let begin = (3 + row) * SIDE + 16;
        assert!(samples.iter().zip(&whole[begin..begin + 8]).all(|(a, b)| f64::from(*a) == *b));
    }
}

#[test]
fn fixed_patterns_are_the_same_for_every_seed() {
    let sensor = Sensor { response_nonuniformity: 0.05, ..sensor() };
    let mean_of = |seeds: std::ops::Range<u64>| {
        let mut sums = vec![0.0; SIDE * SIDE];
        for seed in seeds {
            let numbers = numbers(&Sensor { seed, ..sensor.clone() }, 0.3);
            sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number / 8.0);
        }
        sums
    };
    let (a, b) = (mean_of(0..8), mean_of(8..16));
    let [mean_a, variance, _] = moments(&a);
    let mean_b = moments(&b)[0];
    let covariance = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64;
    // What both have in common is the responses.
    let response = covariance.sqrt() / (mean_a - 20.3);
    assert!((response - 0.05).abs() < 0.001, "{response}, {variance}");
}

#[test]
fn what_no_sensor_can_be_is_refused() {
    let no_room = Sensor { black_level: 4095.0, ..sensor() };
    assert!(no_room.read(&grey(1.0)).unwrap_err().to_string().contains("black level"));
    let blind = Sensor { quantum_efficiency: [0.5, 0.0, 0.5], iso: 100.0, ..sensor() };
    assert!(blind.read(&grey(1.0)).unwrap_err().to_string().contains("quantum efficiency"));
    let mut depth = Picture::new(2, 2).unwrap();
    depth.push_channel("depth.Z", vec![1.0; 4]).unwrap();
    assert!(sensor().read(&depth).is_err());
    let mut odd = grey(0.1);
    odd.channel_mut("R").unwrap()[0] = f32::NAN;
    odd.channel_mut("G").unwrap()[1] = f32::INFINITY;
    odd.channel_mut("B").unwrap()[2] = -5.0;
    let raw = sensor().read(&odd).unwrap().raw;
    assert!(raw.channel("Y").unwrap().iter().all(|number| number.is_finite()));
}
