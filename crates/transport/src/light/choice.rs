//! Which lights to sample: all if there are few; otherwise one, chosen more often the more light it brings to a point. Those that are
//! known to light next to nothing of what is seen share one sample in sixteen vertices.

use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::{Aabb, Vec2, Vec3};
use bilux_scene::lights::{LightExtent, LightTree};
use bilux_scene::{Light, Scene};

/// A probability for every light of a scene, at every point.
///
/// Where there are few lights, each is always sampled: a shadow ray costs less than the noise of a choice. Otherwise each has a share by the
/// unoccluded light that it brings to the scene's objects, with a tenth distributed uniformly. Finite lights put their shares together, and a
/// [tree](LightTree) chooses one of them for the point: the ones close to it are far more likely, and those that face away are left out.
///
/// Points of media have no tree, but the shares: what is chosen for a ray must not depend on where on it the point is.
///
/// Beside few others, [faint](bilux_scene::scene::SceneLight::is_faint) lights are sampled rarely: one of them, at a sixteenth of the vertices. What
/// finds them by chance is weighted accordingly.
#[derive(Clone, Debug)]
pub struct LightChoice {
    /// The share of each light.
    shares: Vec<f32>,
    /// `cdf[i]` is the sum of the shares `0..=i` of all that are not always sampled.
    cdf: Vec<f32>,
    /// The lights that are always sampled, where there are few, each with its probability: 1, or 0 if it does not shine.
    always: Vec<(usize, f32)>,
    few: bool,
    /// One light is chosen: of all, or of the faint ones beside few others.
    draws_one: bool,
    /// Some of them shine into narrow cones through fog.
    has_beams: bool,
    local: Local,
}

/// The lights among which a point chooses.
#[derive(Clone, Debug, Default)]
struct Local {
    tree: LightTree,
    /// Their numbers, in the tree's order.
    lights: Vec<usize>,
    /// The place of each light of the scene in this; `u32::MAX` for those that are not.
    places: Vec<u32>,
    /// The sum of their shares.
    share: f32,
    /// `cdf[i]` is the sum of the shares `0..=i` of all others.
    others: Vec<f32>,
}

/// The lights of the tree, and all others, are chosen at least this often: what is strong by its irradiance may be behind a wall.
const LEAST: f64 = 1.0 / 64.0;

impl Local {
    /// Scales the shares of all lights so that neither these, whose sum this is, nor the others are chosen hardly ever. Returns the new sum.
    fn shares_of_groups(&self, shares: &mut [f32], others: &mut [f32], sum: f64) -> f64 {
        let rest: f64 = others.iter().copied().map(f64::from).sum();
        if sum == 0.0 || rest == 0.0 || sum.min(rest) >= LEAST {
            return sum;
        }
        let wanted = if sum < rest { LEAST } else { 1.0 - LEAST };
        let [here, there] = [wanted / sum, (1.0 - wanted) / rest].map(|factor| factor as f32);
        others.iter_mut().for_each(|share| *share *= there);
        for (share, place) in shares.iter_mut().zip(&self.places) {
            *share *= if *place == u32::MAX { there } else { here };
        }
        wanted
    }

    /// A light of the tree with its probability there, as a light of the scene with its probability.
    fn of(&self, (member, probability): (usize, f32)) -> (usize, f32) {
        (self.lights[member], probability * self.share)
    }
}

/// Up to this many lights are all sampled.
const FEW: usize = 4;

/// The probability that a vertex samples a faint light, where there are few others.
const FAINT: f32 = 1.0 / 16.0;

const SHARED_ALIKE: f64 = 0.1;

impl LightChoice {
    /// Computes the shares of a scene's lights, in their order, and the tree.
    pub fn new(scene: &Scene) -> LightChoice {
        let mut irradiances = Irradiances { scene, places: places(scene), found: Vec::new() };
        let irradiances = scene.lights().iter().map(|l| (irradiances.of(&*l.light), l.is_faint));
        let mut choice = LightChoice::weighted(irradiances);
        choice.has_beams = scene.scatters() && scene.lights().iter().any(|l| l.light.beam().is_some());
        if choice.few {
            return choice;
        }
        let (bounds, shutter) = (scene.bounds(), scene.shutter());
        let extent = |light: &dyn Light| Some((light.extent(shutter)?, light.power(&bounds)));
        choice.with_tree(scene.lights().iter().map(|l| extent(&*l.light)))
    }

    /// Of lights with these irradiances, some of which are faint.
    fn weighted(irradiances: impl Iterator<Item = (f32, bool)>) -> LightChoice {
        let (irradiances, mut is_faint): (Vec<f32>, Vec<bool>) = irradiances.unzip();
        let mut shares = weights(irradiances.iter().copied());
        let strong = (0..shares.len()).filter(|&i| shares[i] > 0.0 && !is_faint[i]).count();
        if strong == 0 || strong > FEW {
            is_faint.fill(false);
        }
        let has_faint = is_faint.contains(&true);
        let few = has_faint || strong <= FEW;
        let mut always = Vec::new();
        if few {
            let of_faint = irradiances.iter().zip(&is_faint).map(|(i, faint)| if *faint { *i } else { 0.0 });
            let faint = weights(of_faint);
            for (light, share) in shares.iter_mut().enumerate() {
                if is_faint[light] {
                    *share = FAINT * faint[light];
                    continue;
                }
                *share = if *share > 0.0 { 1.0 } else { 0.0 };
                always.push((light, *share));
            }
        }
        let drawn = shares.iter().zip(&is_faint).map(|(p, faint)| if few && !faint { 0.0 } else { *p });
        let cdf = sums(&drawn.collect::<Vec<f32>>());
        let draws_one = !few || has_faint;
        LightChoice { cdf, shares, always, few, draws_one, has_beams: false, local: Local::default() }
    }

    /// This choice with a tree over lights of these extents and powers.
    fn with_tree(mut self, extents: impl Iterator<Item = Option<(LightExtent, f32)>>) -> LightChoice {
        let mut members = Vec::new();
        let mut local = Local { places: vec![u32::MAX; self.shares.len()], ..Local::default() };
        let (mut others, mut sum) = (self.shares.clone(), 0.0);
        for (light, extent) in extents.enumerate() {
            let is_somewhere = |extent: &LightExtent| {
                let Aabb { min, max } = extent.bounds;
                min.is_finite() && max.is_finite() && self.shares[light] > 0.0
            };
            let Some((extent, power)) = extent.filter(|(extent, _)| is_somewhere(extent)) else { continue };
            local.places[light] = members.len() as u32;
            local.lights.push(light);
            members.push((extent, if power.is_finite() { power.max(f32::MIN_POSITIVE) } else { f32::MAX }));
            // There may be a million.
            sum += f64::from(std::mem::take(&mut others[light]));
        }
        let sum = local.shares_of_groups(&mut self.shares, &mut others, sum);
        self.cdf = sums(&self.shares);
        local.share = sum as f32;
        local.tree = LightTree::new(&members);
        local.others = sums(&others);
        self.local = local;
        self
    }

    /// True when all lights are always sampled, whatever the random number.
    #[inline]
    pub fn takes_all(&self) -> bool {
        !self.draws_one
    }

    /// True when all lights are always sampled that light more than next to nothing.
    #[inline]
    pub(crate) fn is_few(&self) -> bool {
        self.few
    }

    /// The lights that are sampled from every point, each with its probability: 1, or 0 if it does not shine.
    #[inline]
    pub(crate) fn always(&self) -> &[(usize, f32)] {
        &self.always
    }

    /// True where some lights shine into narrow cones through fog: few of the points that are lit there are found by light samples.
    #[inline]
    pub(crate) fn has_beams(&self) -> bool {
        self.has_beams
    }

    /// The lights to sample from a point, in metres, each with its probability there: all that always are, and one by a random number, of probability 0
    /// where none is chosen. `None` stands for the points of media.
    #[inline]
    pub fn sample(&self, u: f32, at: Option<Vec3>) -> impl Iterator<Item = (usize, f32)> + use<'_> {
        let one = self.draws_one.then(|| self.pick(u, at).unwrap_or_default());
        self.always.iter().copied().chain(one)
    }

    /// Number of random numbers and points that it takes to sample lights from a point.
    #[inline]
    pub(crate) fn draws(&self) -> u32 {
        1 + self.count() as u32
    }

    /// Number of lights that are sampled from a point.
    #[inline]
    pub fn count(&self) -> usize {
        self.always.len() + usize::from(self.draws_one)
    }

    /// Picks for each point with its number the light that [`LightChoice::sample`] gives, where one is chosen: faster than one by one.
    pub(crate) fn pick_each(&self, points: impl Iterator<Item = (Vec3, f32)>, picked: &mut [(usize, f32)]) {
        if self.few {
            let one = |u: f32| self.pick(u, None).unwrap_or_default();
            return points.zip(picked).for_each(|((_, u), picked)| *picked = one(u));
        }
        let local = &self.local;
        let mut walks = Vec::with_capacity(picked.len());
        for (i, (p, u)) in points.enumerate() {
            if u < local.share {
                walks.push((i, p, u / local.share));
            } else {
                picked[i] = self.pick_other(u).unwrap_or_default();
            }
        }
        let points = walks.iter().map(|&(_, p, u)| (p, u));
        local.tree.sample_each(points, |walk, found| {
            picked[walks[walk].0] =
                found.map_or_else(Default::default, |(member, share, _)| local.of((member, share)));
        });
    }

    /// One light for a point, of those that are not always sampled.
    #[inline]
    fn pick(&self, u: f32, at: Option<Vec3>) -> Option<(usize, f32)> {
        if self.few {
            let light = (u < FAINT).then(|| pick(&self.cdf, u / FAINT)).flatten()?;
            return Some((light, self.shares[light]));
        }
        let Some(p) = at else {
            let light = pick(&self.cdf, u)?;
            return Some((light, self.shares[light]));
        };
        let local = &self.local;
        if u < local.share {
            return Some(local.of(local.tree.sample(p, u / local.share)?));
        }
        self.pick_other(u)
    }

    /// One light that is not in the tree.
    fn pick_other(&self, u: f32) -> Option<(usize, f32)> {
        let local = &self.local;
        let light = pick(&local.others, (u - local.share) / (1.0 - local.share))?;
        (local.places[light] == u32::MAX).then(|| (light, self.shares[light]))
    }

    /// The probability that a light is sampled from a point, in metres; `None` stands for the points of media.
    #[inline]
    pub fn probability(&self, light: usize, at: Option<Vec3>) -> f32 {
        match (at, self.local.places.get(light)) {
            (Some(p), Some(&place)) if place != u32::MAX => {
                self.local.share * self.local.tree.probability(p, place as usize)
            }
            _ => self.shares[light],
        }
    }
}

/// The index that a random number selects from cumulative sums.
#[inline]
pub(crate) fn pick(cdf: &[f32], u: f32) -> Option<usize> {
    let wanted = u * cdf.last()?;
    Some(cdf.partition_point(|&sum| sum <= wanted).min(cdf.len() - 1))
}

/// Number of points at which lights are compared.
const PLACES: u64 = 64;
/// One point of so many is left out, those where a light is strongest: nothing but its own shade is that close to a light.
const ONE_CLOSEST_OF: usize = 8;
/// With more lights than this, each is compared at fewer points: it makes less of a difference.
const MANY: usize = 1 << 12;
const FEWER_PLACES: usize = 16;

/// Vertices of some objects, each object equally likely, and two random numbers for each. Power would be no measure: for infinite lights it grows with
/// the scene's bounds, and so with every empty yard of a floor.
fn places(scene: &Scene) -> Vec<(Vec3, Vec2)> {
    let (objects, spheres) = (scene.geometry().objects(), scene.geometry().spheres());
    let count = (objects.len() + spheres.len()) as u64;
    let place = |i: u64| {
        let picked = (hash_words([i, 0]) % count.max(1)) as usize;
        let Some(object) = objects.get(picked) else {
            return spheres.get(picked - objects.len()).map(|s| s.centre);
        };
        let vertex = hash_words([i, 1]) % (object.mesh.positions.len() as u64).max(1);
        let p = *object.mesh.positions.get(vertex as usize)?;
        Some(object.motion.at(scene.shutter()[0]).point(p))
    };
    let found: Vec<Vec3> = (0..PLACES).filter_map(place).collect();
    let few = if scene.lights().len() > MANY { FEWER_PLACES } else { found.len() };
    let number = |i: usize, k: u64| unit_f32(hash_words([i as u64, k]) as u32);
    let with_numbers = |(i, p)| (p, Vec2::new(number(i, 2), number(i, 3)));
    found.into_iter().take(few).enumerate().map(with_numbers).collect()
}

/// Computes irradiances of lights.
struct Irradiances<'a> {
    scene: &'a Scene,
    places: Vec<(Vec3, Vec2)>,
    /// Irradiance of one light at each place.
    found: Vec<f32>,
}

impl Irradiances<'_> {
    /// The mean unoccluded irradiance of a light at some points, as luminance; never 0 for a light that emits.
    fn of(&mut self, light: &dyn Light) -> f32 {
        let time = self.scene.shutter()[0];
        let at = |&(place, u): &(Vec3, Vec2)| {
            let sample = light.sample_li(place, time, u)?;
            let irradiance = sample.li.luminance() / sample.pdf_solid_angle;
            irradiance.is_finite().then_some(irradiance)
        };
        self.found.clear();
        self.found.extend(self.places.iter().map(|place| at(place).unwrap_or(0.0)));
        self.found.sort_unstable_by(f32::total_cmp);
        let sum: f32 = self.found[..self.found.len() - self.found.len() / ONE_CLOSEST_OF].iter().sum();
        let least = if light.power(&self.scene.bounds()) > 0.0 { f32::MIN_POSITIVE } else { 0.0 };
        sum.max(least)
    }
}

/// Probabilities for lights of these powers.
pub(crate) fn weights(powers: impl Iterator<Item = f32>) -> Vec<f32> {
    let sound = |p: f32| if p.is_finite() && p > 0.0 { f64::from(p) } else { 0.0 };
    let powers: Vec<f64> = powers.map(sound).collect();
    let total: f64 = powers.iter().sum();
    let shining = powers.iter().filter(|p| **p > 0.0).count().max(1) as f64;
    let by_power = |p: &f64| match *p {
        p if p > 0.0 => (p / total * (1.0 - SHARED_ALIKE) + SHARED_ALIKE / shining) as f32,
        _ => 0.0,
    };
    powers.iter().map(by_power).collect()
}

/// Cumulative sums.
pub(crate) fn sums(probabilities: &[f32]) -> Vec<f32> {
    let mut sum = 0.0;
    let add = |p: &f32| {
        sum += p;
        sum
    };
    probabilities.iter().map(add).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POWERS: [f32; 7] = [3.0, 0.0, 1.0, f32::NAN, 80.0, 12.0, 4.0];

    /// Lamps in a row, and two lights from infinity.
    fn choice() -> LightChoice {
        let extent = |i: usize| {
            let at = Aabb::of_points([Vec3::X * i as f32]);
            (i != 2 && i != 6).then(|| (LightExtent::all_around(at), POWERS[i]))
        };
        LightChoice::weighted(POWERS.map(|power| (power, false)).into_iter()).with_tree((0..7).map(extent))
    }

    #[test]
    fn each_light_is_picked_as_often_as_it_says() {
        let choice = choice();
        for at in [None, Some(Vec3::ZERO), Some(Vec3::new(5.0, 0.1, 0.0)), Some(Vec3::Y * 100.0)] {
            let mut counts = [0; 7];
            for i in 0..100_000 {
                let (light, probability) = choice.sample((i as f32 + 0.5) / 100_000.0, at).next().unwrap();
                assert!((probability - choice.probability(light, at)).abs() < 1e-6);
                counts[light] += 1;
            }
            for (light, n) in counts.into_iter().enumerate() {
                let share = n as f32 / 100_000.0;
                assert!((share - choice.probability(light, at)).abs() < 1e-4, "light {light}: {share}");
            }
            assert!(choice.probability(2, at) > 0.02 && choice.probability(1, at) == 0.0);
        }
    }

    #[test]
    fn near_lights_are_picked_more_often_and_those_from_infinity_as_often_everywhere() {
        let choice = choice();
        let [near, far] = [Vec3::new(5.0, 0.1, 0.0), Vec3::new(-3.0, 0.1, 0.0)].map(Some);
        assert!(choice.probability(5, near) > 5.0 * choice.probability(5, far));
        assert_eq!(choice.probability(6, near), choice.probability(6, far));
    }

    #[test]
    fn lights_from_infinity_are_sampled_however_strong_a_lamp_is_and_lamps_however_strong_they_are() {
        for powers in [[1e8, 1.0, 2.0, 1.0, 3.0, 1.0], [1.0, 1.0, 2.0, 1.0, 3.0, 1e9]] {
            let extent = |i: usize| {
                let at = Aabb::of_points([Vec3::X * i as f32]);
                (i < 4).then(|| (LightExtent::all_around(at), powers[i]))
            };
            let choice = LightChoice::weighted(powers.map(|power| (power, false)).into_iter());
            let choice = choice.with_tree((0..6).map(extent));
            for at in [None, Some(Vec3::Y)] {
                let of = |range: std::ops::Range<usize>| -> f32 {
                    range.map(|light| choice.probability(light, at)).sum()
                };
                let [lamps, others] = [of(0..4), of(4..6)];
                assert!((lamps + others - 1.0).abs() < 1e-5, "{lamps} and {others}");
                assert!(lamps.min(others) > 0.99 / 64.0, "{powers:?}: {lamps} and {others}");
                let mut counts = [0; 6];
                for i in 0..20_000 {
                    let (light, _) = choice.sample((i as f32 + 0.5) / 20_000.0, at).next().unwrap();
                    counts[light] += 1;
                }
                for (light, n) in counts.into_iter().enumerate() {
                    let said = choice.probability(light, at);
                    assert!(
                        (n as f32 / 20_000.0 - said).abs() < 5e-4,
                        "{powers:?}, light {light}: {n}, {said}"
                    );
                }
            }
        }
    }

    #[test]
    fn few_emitting_lights_are_all_sampled() {
        let choice = LightChoice::weighted([1.0, 0.0, 1e9].map(|power| (power, false)).into_iter());
        assert!(choice.takes_all());
        assert_eq!(choice.sample(0.5, None).collect::<Vec<_>>(), [(0, 1.0), (1, 0.0), (2, 1.0)]);
    }

    #[test]
    fn without_emission_no_light_is_sampled() {
        let dark = LightChoice::weighted([(0.0, false)].into_iter());
        assert_eq!(dark.probability(0, None), 0.0);
        assert_eq!(LightChoice::weighted([].into_iter()).sample(0.5, None).count(), 0);
    }

    #[test]
    fn faint_lights_share_a_sixteenth_of_a_sample_and_all_others_have_one_each() {
        let lights = [(2.0, false), (3.0, true), (0.0, false), (1.0, true), (5.0, false)];
        let choice = LightChoice::weighted(lights.into_iter());
        assert!(!choice.takes_all() && choice.is_few());
        let mut counts = [0.0; 5];
        const DRAWS: usize = 100_000;
        for i in 0..DRAWS {
            let u = (i as f32 + 0.5) / DRAWS as f32;
            let sampled: Vec<_> = choice.sample(u, Some(Vec3::ONE)).collect();
            assert_eq!(sampled.len(), choice.count());
            let mut picked = [(0, 0.0)];
            choice.pick_each([(Vec3::ONE, u)].into_iter(), &mut picked);
            assert_eq!(sampled.last(), Some(&picked[0]));
            for (light, probability) in sampled.into_iter().filter(|(_, probability)| *probability > 0.0) {
                counts[light] += 1.0 / DRAWS as f32;
                assert_eq!(probability, choice.probability(light, None));
            }
        }
        // By irradiance, with a tenth shared alike: 0.9 · 3/4 + 0.05, and 0.9 · 1/4 + 0.05.
        for (count, wanted) in counts.into_iter().zip([1.0, 0.725 / 16.0, 0.0, 0.275 / 16.0, 1.0]) {
            assert!((count - wanted).abs() < 1e-4 + 1e-3 * wanted, "{count}, {wanted}");
        }
    }

    #[test]
    fn lights_are_not_faint_beside_none_and_not_beside_many() {
        let alone = LightChoice::weighted([(1.0, true), (2.0, true)].into_iter());
        assert!(alone.takes_all());
        let many = LightChoice::weighted((0..6).map(|i| (1.0, i == 5)));
        assert!(!many.is_few());
        assert_eq!(many.probability(5, None), many.probability(0, None));
    }
}
