//! Tests of the tree of lights.

use super::super::extent::{DirectionCone, LightExtent};
use super::*;
use bilux_math::Aabb;
use bilux_math::hash::{hash_words, unit_f32};
use std::f32::consts::FRAC_PI_2;

fn number(i: u64, k: u64) -> f32 {
    unit_f32(hash_words([i, k]) as u32)
}

fn point(i: u64, size: f32) -> Vec3 {
    (Vec3::new(number(i, 0), number(i, 1), number(i, 2)) * 2.0 - Vec3::ONE) * size
}

/// Flat lamps that face anywhere, some to both sides; each with where it is and how it faces.
fn lamps(count: u64) -> Vec<(LightExtent, f32)> {
    let lamp = |i: u64| {
        let p = point(i, 5.0);
        let axis = point(i + 1_000_000, 1.0).normalize();
        let extent = LightExtent {
            bounds: Aabb::of_points([p]),
            facing: DirectionCone::of(axis),
            spread: FRAC_PI_2,
            both_sides: i.is_multiple_of(5),
        };
        (extent, 0.1 + number(i, 3))
    };
    (0..count).map(lamp).collect()
}

#[test]
fn each_light_is_chosen_as_often_as_it_says() {
    let lamps = lamps(40);
    let tree = LightTree::new(&lamps);
    for place in (0..20).map(|i| point(i + 77, 7.0)) {
        let all: Vec<f32> = (0..lamps.len()).map(|light| tree.probability(place, light)).collect();
        let sum: f32 = all.iter().sum();
        let (mut counts, mut nothing) = (vec![0; lamps.len()], 0);
        for i in 0..20_000 {
            let Some((light, probability)) = tree.sample(place, (i as f32 + 0.5) / 20_000.0) else {
                nothing += 1;
                continue;
            };
            assert!((probability - all[light]).abs() < 1e-6);
            counts[light] += 1;
        }
        // Where a branch seems to shine, but none of its lights does, nothing is chosen.
        assert!((nothing as f32 / 20_000.0 - (1.0 - sum)).abs() < 1e-3, "{nothing} {sum}");
        for (count, probability) in counts.into_iter().zip(all) {
            assert!((count as f32 / 20_000.0 - probability).abs() < 1e-3);
        }
    }
}

/// Light that a lamp brings to a point, by its own closed form.
fn brings((extent, power): &(LightExtent, f32), p: Vec3) -> f32 {
    let from = p - extent.bounds.centre();
    let cosine = extent.facing.axis.dot(from.normalize());
    let cosine = if extent.both_sides { cosine.abs() } else { cosine.max(0.0) };
    power * cosine / from.length_squared()
}

#[test]
fn no_light_that_shines_on_a_point_is_left_out() {
    let lamps = lamps(3000);
    let tree = LightTree::new(&lamps);
    for place in (0..40).map(|i| point(i + 12345, 8.0)) {
        for (light, lamp) in lamps.iter().enumerate() {
            assert!(brings(lamp, place) <= 0.0 || tree.probability(place, light) > 0.0, "{light} {place}");
        }
    }
}

/// The second moment of a choice, relative to the square of the mean: 1 if every light is chosen by what it brings.
fn noise(lamps: &[(LightExtent, f32)], p: Vec3, probability: impl Fn(usize) -> f32) -> f32 {
    let of = |light: usize| f64::from(brings(&lamps[light], p));
    let mean: f64 = (0..lamps.len()).map(of).sum();
    let second = (0..lamps.len()).filter(|&light| of(light) > 0.0);
    let second: f64 = second.map(|light| of(light) * of(light) / f64::from(probability(light))).sum();
    (second / (mean * mean)) as f32
}

#[test]
fn it_has_a_fraction_of_the_noise_of_a_choice_by_power() {
    let lamps = lamps(2000);
    let tree = LightTree::new(&lamps);
    let power: f32 = lamps.iter().map(|(_, power)| power).sum();
    let (mut own, mut by_power) = (0.0, 0.0);
    for place in (0..50).map(|i| point(i + 5000, 5.0)) {
        own += noise(&lamps, place, |light| tree.probability(place, light)) / 50.0;
        by_power += noise(&lamps, place, |light| lamps[light].1 / power) / 50.0;
    }
    assert!(by_power > 4.0 * own, "{own}, by power {by_power}");
}

/// Of a lamp behind a wall nothing arrives, however strong it is: the others are found as before, but for a bounded factor.
#[test]
fn a_strong_lamp_that_is_hidden_leaves_the_others_their_light() {
    for count in [12, 200, 3000] {
        let visible = lamps(count);
        let places: Vec<Vec3> = (0..30).map(|i| point(i + 5000, 5.0)).collect();
        let mean_noise = |hidden: &[f32]| {
            let mut all = visible.clone();
            all.extend(hidden.iter().enumerate().map(|(i, power)| {
                (LightExtent::all_around(Aabb::of_points([point(i as u64 + 31, 4.0)])), *power)
            }));
            let tree = LightTree::new(&all);
            let of = |place: &Vec3| noise(&visible, *place, |light| tree.probability(*place, light));
            places.iter().map(of).sum::<f32>() / places.len() as f32
        };
        let alone = mean_noise(&[]);
        for (hidden, most) in
            [(&[1e2][..], 70.0), (&[1e4], 70.0), (&[1e6], 70.0), (&[1e8], 70.0), (&[1e4, 1e8], 700.0)]
        {
            let found = mean_noise(hidden);
            assert!(found < most * alone, "{count} lamps with {hidden:?}: {found}, alone {alone}");
        }
    }
}

#[test]
fn lights_in_one_place_and_in_a_row_make_a_tree_too() {
    let at = |p: Vec3| (LightExtent::all_around(Aabb::of_points([p])), 1.0);
    let same: Vec<_> = (0..1000).map(|_| at(Vec3::ONE)).collect();
    // Each lamp is half as far as the one before.
    let row: Vec<_> =
        (0..1000).map(|i| at(Vec3::X * bilux_math::transcendental::exp(-0.7 * i as f32))).collect();
    for lamps in [same, row] {
        let tree = LightTree::new(&lamps);
        for place in [Vec3::ZERO, Vec3::ONE, Vec3::X * 100.0] {
            let sum: f32 = (0..lamps.len()).map(|light| tree.probability(place, light)).sum();
            assert!((sum - 1.0).abs() < 1e-3, "{sum}");
            assert!(tree.sample(place, 0.3).is_some());
        }
    }
}

#[test]
fn no_lights_make_no_tree() {
    assert!(LightTree::new(&[]).sample(Vec3::ZERO, 0.5).is_none());
}

#[test]
fn many_walks_find_what_each_finds_alone() {
    let lamps = lamps(3000);
    let tree = LightTree::new(&lamps);
    let points: Vec<(Vec3, f32)> = (0..500).map(|i| (point(i + 900, 9.0), number(i, 9))).collect();
    let mut together = vec![None; points.len()];
    tree.sample_each(points.iter().copied(), |i, found| together[i] = Some(found));
    let alone: Vec<_> = points.iter().map(|&(p, u)| Some(tree.sample_with_rest(p, u))).collect();
    assert_eq!(together, alone);
    let found: Vec<_> = points.iter().filter_map(|&(p, u)| Some((p, tree.sample(p, u)?))).collect();
    assert!(found.len() > 300, "{}", found.len());
    for (p, (light, probability)) in found {
        // The same factors, from the other end.
        assert!((probability / tree.probability(p, light) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_order_of_few_lights_does_not_matter() {
    for count in [2, 3, 4] {
        let lamps = lamps(count);
        let reversed: Vec<_> = lamps.iter().rev().copied().collect();
        let [tree, other] = [&lamps, &reversed].map(|lamps| LightTree::new(lamps));
        for i in 0..500 {
            let (p, u) = (point(i + 600, 9.0), number(i, 8));
            let same = other.sample(p, u).map(|(light, share)| (lamps.len() - 1 - light, share));
            let found = tree.sample(p, u);
            assert_eq!(found.map(|found| found.0), same.map(|found| found.0), "{count} lamps, {p}");
        }
    }
}

/// The strongest may be behind something, and whatever the others bring would be noise.
#[test]
fn the_weakest_of_few_lights_is_chosen_now_and_then() {
    let at = |x: f32, power: f32| (LightExtent::all_around(Aabb::of_points([Vec3::X * x])), power);
    let tree = LightTree::new(&[at(1.0, 1e5), at(2.0, 1.0), at(30.0, 0.01), at(3.0, f32::MAX)]);
    for place in (0..40).map(|i| point(i + 700, 8.0)) {
        for light in 0..4 {
            let probability = tree.probability(place, light);
            assert!((0.04..0.9).contains(&probability), "{light}, {place}: {probability}");
        }
    }
}
