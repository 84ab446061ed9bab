//! Weights behind panes, through which lights are sampled.

use super::path::Flaw;
use super::{FOG, MANY, Verdict, cameras, clear_surface, filled, foggy_of, sets, verdict};
use crate::shapes;
use crate::techniques::TechniqueCounts;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{SceneBuilder, Spec};

/// The bodies, behind one pane or two that are not parallel.
fn behind_panes(lights: &[&str], camera: usize) -> SceneBuilder {
    let mut builder = filled(lights, cameras()[camera].clone(), &Spec::new("", "mirror"));
    let pane = Spec::new("", "dielectric").with("thin", true).with("tint", Rgb::new(0.9, 0.6, 0.2));
    let quads = [
        shapes::quad(Vec3::new(-2.2, 1.3, -1.8), Vec3::X * 4.4, Vec3::new(0.0, 0.2, 3.6)),
        shapes::quad(Vec3::new(-0.4, 1.1, -1.8), Vec3::new(2.6, 0.1, 0.0), Vec3::new(0.0, 0.1, 3.0)),
    ];
    for quad in quads {
        shapes::put(&mut builder, "pane", quad, pane.clone());
    }
    builder
}

#[test]
fn every_mis_weight_matches_its_definition_behind_panes() {
    let few: [&[&str]; 3] = [&["rect"], &["point", "rect"], &["environment", "rect"]];
    for (i, lights) in few.into_iter().chain(MANY).enumerate() {
        let scene = shapes::built(&behind_panes(lights, i % 3));
        for techniques in [sets()[i % 4], TechniqueCounts { direct: false, ..sets()[1] }] {
            let Verdict { compared, wrong, worst, telling, .. } =
                verdict(&scene, &techniques, Flaw::None, None);
            assert!(wrong == 0, "{lights:?}: {wrong} of {compared} weights are wrong, by up to {worst}");
            assert!(telling[0] > 50 && telling[7] > 500, "{telling:?}");
        }
    }
    let scene = shapes::built(&behind_panes(MANY[0], 0));
    for flaw in [Flaw::Panes, Flaw::ChoiceAtPane] {
        let Verdict { compared, wrong, .. } = verdict(&scene, &sets()[0], flaw, None);
        assert!(wrong > compared / 50, "{flaw:?}: only {wrong} of {compared} weights differ");
    }
}

/// Points of fog sample no light through panes; surfaces in fog do.
#[test]
fn every_mis_weight_matches_its_definition_behind_panes_in_fog() {
    for (i, lights) in [&["rect"][..], MANY[0]].into_iter().enumerate() {
        let scene = shapes::built(&foggy_of(behind_panes(lights, 2 * i), clear_surface(), FOG));
        let techniques = TechniqueCounts { direct: i == 0, ..sets()[1] };
        let extinction = Some(FOG[0] + FOG[1]);
        let Verdict { compared, wrong, worst, telling, .. } =
            verdict(&scene, &techniques, Flaw::None, extinction);
        assert!(wrong == 0, "{lights:?}: {wrong} of {compared} weights are wrong, by up to {worst}");
        assert!(telling[7] > 500, "{telling:?}");
    }
}
