//! Weights where fog does not fill the scene: rays come into it away from where they begin.

use super::path::Flaw;
use super::{FOG, GREY_FOG, Verdict, cameras, filled, foggy, sets, verdict, verdict_in};
use crate::shapes;
use crate::techniques::TechniqueCounts;
use bilux_math::{Aabb, Vec3};
use bilux_scene::Spec;
use bilux_scene::mesh::shapes::cuboid;
use std::sync::Arc;

/// Two banks of fog, with clear air around them and between: rays come into the second away from where they begin.
const BANKS: [Aabb; 2] = [
    Aabb { min: Vec3::new(-3.0, -0.5, 0.9), max: Vec3::new(2.9, 1.7, 2.2) },
    Aabb { min: Vec3::new(-2.8, -0.6, -1.7), max: Vec3::new(3.1, 2.1, 0.35) },
];

#[test]
fn every_mis_weight_matches_its_definition_in_banks_of_fog() {
    for (i, [absorption, scattering]) in [FOG, GREY_FOG].into_iter().enumerate() {
        let mut builder = filled(&["rect"], cameras()[0].clone(), &Spec::new("", "mirror"));
        let fog = Spec::new("", "interface").with("absorption", absorption * 2.0);
        let fog = fog.with("scattering", scattering * 2.0).with("scattering_anisotropy", 0.4f32);
        for bank in BANKS {
            shapes::put(&mut builder, "bank", Arc::new(cuboid(bank)), fog.clone());
        }
        let scene = shapes::built(&builder);
        let techniques = TechniqueCounts { direct: i == 0, ..sets()[1 + i] };
        let extinction = Some((absorption + scattering) * 2.0);
        let Verdict { compared, wrong, worst, telling, .. } =
            verdict_in(&scene, &techniques, Flaw::None, extinction, &BANKS);
        assert!(wrong == 0, "fog {i}: {wrong} of {compared} weights are wrong, by up to {worst}");
        assert!(compared > 3000 && telling[5] > 100, "{telling:?}");
        // Fog that fills the scene is another.
        let Verdict { compared, wrong, .. } = verdict(&scene, &techniques, Flaw::None, extinction);
        assert!(wrong > compared / 20, "only {wrong} of {compared} weights differ");
    }
}

/// A hundred mean free paths and more lie between bodies and lamps: 32-bit numbers run out where the densities of walks are divisors. An exponent of a
/// hundred is rounded by some 10⁻⁵.
#[test]
fn every_mis_weight_matches_its_definition_in_fog_that_nothing_passes() {
    let thick = GREY_FOG.map(|coefficient| coefficient * 150.0);
    let scene = foggy(&["point", "rect"], &cameras()[0], Spec::new("", "interface"), thick);
    let Verdict { compared, wrong, worst, telling, .. } =
        verdict(&scene, &sets()[0], Flaw::None, Some(thick[0] + thick[1]));
    assert!(worst < 1e-5, "{wrong} of {compared} weights are wrong, by up to {worst}");
    assert!(compared > 3000 && telling[6] > 200, "{telling:?}");
}
