//! Every registered BSDF and material keeps its contract, and every check of it can fail.

use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::bsdf::{BSDFS, Dielectric, Lambert, Lobe, Mirror};
use bilux_scene::materials::MATERIALS;
use bilux_scene::{Primitive, Spec, Surface, TransportMode};
use bilux_validation::bsdf_contract::{CHECKS, Promise, Scatterer};

#[test]
fn every_registered_bsdf_keeps_its_contract() {
    for row in BSDFS {
        let promise = Promise { reciprocal: row.reciprocal, lossless: false };
        for (case, lobe) in (row.cases)() {
            let lossless = row.lossless && is_white(&lobe);
            for (check, run) in CHECKS {
                let result = run(&lobe.into(), Promise { lossless, ..promise });
                assert_eq!(result, Ok(()), "{} ({case}): {check}", row.entry.name);
            }
        }
    }
}

fn is_white(lobe: &Lobe) -> bool {
    match lobe {
        Lobe::Lambert(l) => l.albedo == Rgb::WHITE,
        Lobe::Mirror(m) => m.reflectance == Rgb::WHITE,
        Lobe::Dielectric(d) => d.tint == Rgb::WHITE,
        Lobe::Phong(_) => false,
    }
}

#[test]
fn every_registered_material_keeps_the_contract_too() {
    for row in MATERIALS {
        let material = bilux_scene::materials::build(&Spec::new("", row.entry.name), &[]).unwrap();
        let bsdf = material.bsdf(&flat_surface());
        let reciprocal = row.entry.name != "dielectric";
        for (check, run) in CHECKS {
            // Mixtures of delta and wide lobes have no density of their own to hold samples against.
            if row.entry.name == "phong" && check != "energy" {
                continue;
            }
            let result = run(&bsdf.into(), Promise { reciprocal, lossless: false });
            assert_eq!(result, Ok(()), "{}: {check}", row.entry.name);
        }
    }
}

fn flat_surface() -> Surface {
    Surface {
        t: 1.0,
        p: Vec3::ZERO,
        p_error: Vec3::ZERO,
        n_geom: Vec3::Z,
        n_shade: Vec3::Z,
        uv: Vec2::ZERO,
        vertex_kd: None,
        vertex_ks: None,
        primitive: Primitive { instance: 0, index: 0 },
        object: 0,
        time: 0.0,
    }
}

/// A lobe with one of its functions spoilt, and the check that has to see it.
fn planted() -> Vec<(&'static str, &'static str, Scatterer, Promise)> {
    let lambert = Lobe::Lambert(Lambert { albedo: Rgb::WHITE });
    let glass = Lobe::Dielectric(Dielectric { eta: 1.5, tint: Rgb::WHITE, thin: false });
    let mirror = Lobe::Mirror(Mirror { reflectance: Rgb::WHITE });
    let white = Promise { reciprocal: true, lossless: true };
    let adjoint = Promise { reciprocal: false, lossless: true };
    let spoilt = |spoil: &dyn Fn(&mut Scatterer)| {
        let mut scatterer = Scatterer::from(lambert);
        spoil(&mut scatterer);
        scatterer
    };
    let tilted = spoilt(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| lambert.sample(wo, c, Vec2::new(u.x, u.y * u.y), mode));
    });
    let denser = spoilt(&|s| s.pdf = Box::new(move |wo, wi| 1.05 * lambert.pdf_solid_angle(wo, wi)));
    let no_cosine =
        spoilt(&|s| s.eval = Box::new(move |wo, wi, mode| lambert.eval(wo, wi, mode) / wi.z.abs().max(1e-3)));
    let one_way = spoilt(&|s| {
        s.eval = Box::new(move |wo, wi, mode| lambert.eval(wo, wi, mode) * (1.0 + 0.1 * wo.z));
    });
    let counted_twice = spoilt(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| {
            lambert.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { weight: x.weight * 1.02, ..x })
        });
    });
    let leaking = spoilt(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| {
            lambert.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { weight: x.weight * 0.98, ..x })
        });
    });
    let mut wrong_choice = Scatterer::from(glass);
    wrong_choice.sample = Box::new(move |wo, c, u, mode| glass.sample(wo, c * 0.9, u, mode));
    let mut no_eta = Scatterer::from(glass);
    no_eta.sample = Box::new(move |wo, c, u, _| glass.sample(wo, c, u, TransportMode::Importance));
    let mut shown = Scatterer::from(mirror);
    shown.pdf = Box::new(|_, _| 1.0);
    let mut through = Scatterer::from(mirror);
    through.sample = Box::new(move |wo, c, u, mode| {
        mirror.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { wi: -x.wi, ..x })
    });
    vec![
        ("a tilted warp", "samples follow the density", tilted, white),
        ("pdf × 1.05", "weight times density is eval", denser, white),
        ("pdf × 1.05", "samples follow the density", spoilt_pdf(lambert), white),
        ("a cosine divided out", "weight times density is eval", no_cosine, white),
        ("a factor of one side only", "reciprocity, or else the adjoint", one_way, white),
        ("2% too much", "energy", counted_twice, white),
        ("2% lost", "energy", leaking, white),
        ("a wrong share of refraction", "samples follow the density", wrong_choice, adjoint),
        ("η² forgotten", "reciprocity, or else the adjoint", no_eta, adjoint),
        ("a delta lobe with a density", "delta lobes hide from eval", shown, white),
        ("a mirror that transmits", "lobes of zero chance give no sample", through, white),
    ]
}

fn spoilt_pdf(lobe: Lobe) -> Scatterer {
    let mut scatterer = Scatterer::from(lobe);
    scatterer.pdf = Box::new(move |wo, wi| 1.05 * lobe.pdf_solid_angle(wo, wi));
    scatterer
}

#[test]
fn every_check_catches_its_planted_bug() {
    for (bug, name, scatterer, promise) in planted() {
        let (_, run) = CHECKS.iter().find(|(check, _)| *check == name).unwrap();
        assert!(run(&scatterer, promise).is_err(), "{name} does not see {bug}");
    }
}

#[test]
fn every_check_has_a_planted_bug() {
    for (check, _) in CHECKS {
        assert!(planted().iter().any(|(_, name, ..)| *name == check), "{check}");
    }
}
