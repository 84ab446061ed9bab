//! Every registered BSDF and material keeps its contract, and every check can fail.

use bilux_math::frame::reflect;
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::{Rgb, Vec2, Vec3, warp};
use bilux_scene::bsdf::{BSDFS, BsdfEntry, Dielectric, Lambert, Lobe, Mirror, PhongLobe};
use bilux_scene::materials::{MATERIALS, MaterialInputs};
use bilux_scene::{Bsdf, Primitive, Spec, Surface, TransportMode, Value};
use bilux_testing::effort;
use bilux_validation::bsdf_contract::{CHECKS, Promise, Scatterer, keeps, the_same_from_both_ends};
use bilux_validation::chi_square::uniforms;

#[test]
fn every_registered_bsdf_keeps_its_contract() {
    for row in BSDFS {
        let promise = Promise { reciprocal: row.reciprocal, lossless: false };
        for (case, lobe) in (row.cases)() {
            let lossless = row.lossless && is_white(&lobe);
            let name = format!("{} ({case})", row.entry.name);
            let result = keeps(&name, &all(), &lobe.into(), Promise { lossless, ..promise });
            assert_eq!(result, Ok(()), "{name}");
        }
    }
}

/// The names of all checks.
fn all() -> Vec<&'static str> {
    CHECKS.iter().map(|(name, _)| *name).collect()
}

fn is_white(lobe: &Lobe) -> bool {
    match lobe {
        Lobe::Lambert(l) => l.albedo == Rgb::WHITE,
        Lobe::Mirror(m) => m.reflectance == Rgb::WHITE,
        Lobe::Dielectric(d) => d.tint == Rgb::WHITE,
        Lobe::MicrofacetReflection(gloss) => gloss.is_white(),
        Lobe::OpaqueBase(base) => base.is_white(),
        Lobe::Phong(_) | Lobe::Conductor(_) | Lobe::RoughDielectric(_) => false,
        Lobe::CoatedDiffuse(_) | Lobe::CoatedDielectric(_) | Lobe::Fuzz(_) => false,
    }
}

#[test]
fn every_registered_material_keeps_the_contract_too() {
    for row in MATERIALS {
        let parts = [Spec::new("", "diffuse"), Spec::new("", "conductor")];
        let mut spec = Spec::new("", row.entry.name);
        if row.entry.name == "mix" {
            spec = spec.with("a", Value::Material(0)).with("b", Value::Material(1));
        }
        let material = bilux_scene::materials::build(&spec, &MaterialInputs::new(&[], &parts)).unwrap();
        let bsdf = material.bsdf(&flat_surface());
        let reciprocal = row.entry.name != "dielectric";
        // Mixtures of delta and non-delta lobes have no density of their own to compare samples with.
        let checks = if row.entry.name == "phong" { vec!["energy"] } else { all() };
        let promise = Promise { reciprocal, lossless: false };
        assert_eq!(keeps(row.entry.name, &checks, &bsdf.into(), promise), Ok(()), "{}", row.entry.name);
    }
}

/// Shading normals as in meshes: barely tilted, tilted, and tilted beyond what a triangle can see.
fn turned() -> [Vec3; 3] {
    [Vec3::new(0.05, 0.0, 1.0), Vec3::new(-0.3, 0.4, 1.0), Vec3::new(0.9, -0.7, 0.6)].map(Vec3::normalize)
}

#[test]
fn a_turned_normal_scatters_the_same_from_both_ends() {
    let checks = ["radiance and importance agree", "weight times pdf is eval"];
    let named =
        |row: &'static BsdfEntry| (row.cases)().into_iter().map(|(case, lobe)| (row.entry.name, case, lobe));
    for (i, (name, case, lobe)) in BSDFS.iter().flat_map(named).enumerate() {
        for n_shade in &turned()[effort(i % 3..i % 3 + 1, 0..3)] {
            let bsdf = Bsdf::of(*n_shade, Vec3::Z, lobe);
            for (bends, bsdf) in [("", bsdf), (", bending", bsdf.bending())] {
                let name = format!("{name} ({case}) about {n_shade}{bends}");
                let promise = Promise { reciprocal: false, lossless: false };
                assert_eq!(keeps(&name, &checks, &bsdf.into(), promise), Ok(()), "{name}");
            }
        }
    }
}

#[test]
fn sums_of_lobes_about_a_turned_normal_do_too() {
    let [grey, glass, sheen, metal] = [
        Lobe::Lambert(Lambert { albedo: Rgb::new(0.2, 0.5, 0.7) }),
        Lobe::Dielectric(Dielectric { eta: 1.5, dispersion: 0.0, tint: Rgb::WHITE, thin: false, film: None }),
        Lobe::Phong(PhongLobe { reflectance: Rgb::WHITE, exponent: 20.0 }),
        Lobe::Mirror(Mirror { reflectance: Rgb::new(0.9, 0.6, 0.3) }),
    ];
    for lobes in [[grey, metal, sheen], [glass, grey, metal], [sheen, glass, glass]] {
        for n_shade in turned() {
            for n_geom in [Vec3::Z, -Vec3::Z] {
                let bsdf = Bsdf::new(n_shade, n_geom, lobes.map(Some));
                let result =
                    the_same_from_both_ends(&bsdf.into(), Promise { reciprocal: false, lossless: false });
                assert_eq!(result, Ok(()), "{lobes:?} about {n_shade} on {n_geom}");
            }
        }
    }
}

/// Delta and non-delta lobes, each with its weight.
fn mixture(n_shade: Vec3, n_geom: Vec3) -> Bsdf {
    let cases: Vec<(&str, Lobe)> = BSDFS.iter().flat_map(|row| (row.cases)()).collect();
    let part = |name: &str| {
        let (_, lobe) = cases.iter().find(|(case, _)| *case == name).unwrap();
        Bsdf::new(n_shade, n_geom, [Some(*lobe), None, None]).along(Vec3::new(1.0, 0.5, 0.0))
    };
    let metal = part("polished").mixed(&part("brushed"), 0.7);
    metal.mixed(&part("frosted").mixed(&part("glass"), 0.4), 0.6)
}

#[test]
fn a_normal_that_faces_away_is_bent_back() {
    let lambert = Lobe::Lambert(Lambert { albedo: Rgb::WHITE });
    let n = Vec3::new(0.8, 0.0, 0.6);
    let (plain, bent) = (Bsdf::of(n, Vec3::Z, lambert), Bsdf::of(n, Vec3::Z, lambert).bending());
    let (light, facing) = (Vec3::Z, Vec3::new(0.6, 0.0, 0.8));
    let mode = TransportMode::Radiance;
    assert_eq!(plain.eval(facing, light, mode), bent.eval(facing, light, mode));
    // There is no seam just before and just behind the normal's horizon.
    let seen = |x: f32| bent.eval(Vec3::new(-x, 0.0, 0.8).normalize(), light, mode).g;
    assert!(
        (seen(0.5999) - plain.eval(Vec3::new(-0.5999, 0.0, 0.8).normalize(), light, mode).g).abs() < 1e-3
    );
    assert!((seen(1.068) - seen(1.065)).abs() < 3e-3 && seen(3.0) > 0.05, "{} {}", seen(1.068), seen(1.065));
    assert!(plain.eval(Vec3::new(-3.0, 0.0, 0.8).normalize(), light, mode).is_black());
    let forgetful = {
        let mut scatterer = Scatterer::from(bent);
        let plain = Scatterer::from(plain);
        scatterer.sample = Box::new(move |wo, c, u, mode| {
            if mode == TransportMode::Importance {
                (plain.sample)(wo, c, u, mode)
            } else {
                bent.sample(wo, c, u, mode)
            }
        });
        scatterer
    };
    let promise = Promise { reciprocal: false, lossless: false };
    assert!(the_same_from_both_ends(&forgetful, promise).is_err(), "light paths that never look back pass");
}

#[test]
fn mixtures_scatter_the_same_from_both_ends() {
    let promise = Promise { reciprocal: false, lossless: false };
    for n_shade in turned().into_iter().chain([Vec3::Z]) {
        let result = the_same_from_both_ends(&mixture(n_shade, Vec3::Z).into(), promise);
        assert_eq!(result, Ok(()), "about {n_shade}");
    }
}

#[test]
fn a_mixture_gives_each_part_its_share() {
    let white =
        Bsdf::new(Vec3::Z, Vec3::Z, [Some(Lobe::Lambert(Lambert { albedo: Rgb::WHITE })), None, None]);
    let mirror =
        Bsdf::new(Vec3::Z, Vec3::Z, [Some(Lobe::Mirror(Mirror { reflectance: Rgb::grey(0.2) })), None, None]);
    let both = white.mixed(&mirror, 0.25);
    assert!(!both.is_delta() && mirror.is_delta() && mirror.mixed(&mirror, 0.5).is_delta());
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let mut sums = [0.0f64; 2];
    const N: u64 = 100_000;
    for (choice, u) in (0..N).map(|i| uniforms(700, i)) {
        let sample = both.sample(wo, choice, u, TransportMode::Radiance).unwrap();
        sums[usize::from(sample.is_delta)] += f64::from(sample.weight.g) / N as f64;
        let (f, pdf) = both.eval_and_pdf(wo, sample.wi, TransportMode::Radiance);
        // The density that an MIS weight of a light in that direction uses: that of the non-delta part alone.
        assert!(sample.is_delta || (f.g / pdf - sample.weight.g).abs() < 1e-5);
    }
    assert!((sums[0] - 0.75).abs() < 0.005 && (sums[1] - 0.05).abs() < 0.001, "{sums:?}");
}

#[test]
fn importance_that_comes_along_the_surface_is_finite() {
    for (_, lobe) in BSDFS.iter().flat_map(|row| (row.cases)()) {
        for n_shade in turned() {
            let bsdf = Bsdf::new(n_shade, Vec3::Z, [Some(lobe), None, None]);
            for (i, z) in [0.0, -0.0, f32::MIN_POSITIVE, 1e-30, -1e-30, 1e-20, 1e-7].into_iter().enumerate() {
                let wo = Vec3::new(0.6, 0.8, z);
                for u in (0..64).map(|k| uniforms(i as u64, k)) {
                    let sample = bsdf.sample(wo, u.0, u.1, TransportMode::Importance);
                    assert!(sample.is_none_or(|s| s.weight.is_finite()), "{lobe:?} from {wo}: {sample:?}");
                    let wi = warp::sample_sphere(u.1);
                    assert!(
                        bsdf.eval(wo, wi, TransportMode::Importance).is_finite(),
                        "{lobe:?}: {wo} to {wi}"
                    );
                }
            }
        }
    }
}

#[test]
fn importance_is_the_adjoint_of_radiance_for_any_two_normals() {
    let number = |i: u64, k: u64| unit_f32(hash_words([i, k]) as u32) * 2.0 - 1.0;
    let direction = |i, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2)).normalize();
    let (mut scattered, mut far) = (0, 0);
    for (i, (_, lobe)) in (0..5000).flat_map(|i| BSDFS.iter().flat_map(|r| (r.cases)()).map(move |c| (i, c)))
    {
        let (wo, wi, n_geom) = (direction(i, 0), direction(i, 3), direction(i, 6));
        let bsdf = Bsdf::of(direction(i, 9), n_geom, lobe);
        let bsdf = if i % 2 == 0 { bsdf } else { bsdf.bending() };
        let importance = bsdf.eval(wo, wi, TransportMode::Importance) * wo.dot(n_geom).abs();
        let radiance = bsdf.eval(wi, wo, TransportMode::Radiance) * wi.dot(n_geom).abs();
        assert!(importance.is_finite(), "wo {wo}, wi {wi}");
        let (a, b) = (importance.luminance(), radiance.luminance());
        scattered += usize::from(a > 0.0);
        far += usize::from((a - b).abs() > 1e-3 * a.max(b).max(1e-9));
    }
    assert!(scattered > 1000 && far == 0, "{far} of {scattered} differ");
}

fn flat_surface() -> Surface {
    Surface {
        t: 1.0,
        p: Vec3::ZERO,
        p_error: Vec3::ZERO,
        n_geom: Vec3::Z,
        n_shade: Vec3::Z,
        n_smooth: Vec3::Z,
        tangent: Vec3::X,
        handedness: 1.0,
        uv: Vec2::ZERO,
        uv2: Vec2::ZERO,
        uv_width: [Vec2::ZERO; 2],
        vertex_kd: None,
        vertex_ks: None,
        primitive: Primitive { instance: 0, index: 0 },
        object: 0,
        time: 0.0,
    }
}

/// A lobe with a bug in one of its functions, and the check that must detect it.
fn planted() -> Vec<(&'static str, &'static str, Scatterer, Promise)> {
    let lambert = Lobe::Lambert(Lambert { albedo: Rgb::WHITE });
    let glass =
        Lobe::Dielectric(Dielectric { eta: 1.5, dispersion: 0.0, tint: Rgb::WHITE, thin: false, film: None });
    let mirror = Lobe::Mirror(Mirror { reflectance: Rgb::WHITE });
    let white = Promise { reciprocal: true, lossless: true };
    let adjoint = Promise { reciprocal: false, lossless: true };
    let defective = |defect: &dyn Fn(&mut Scatterer)| {
        let mut scatterer = Scatterer::from(lambert);
        defect(&mut scatterer);
        scatterer
    };
    let tilted = defective(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| lambert.sample(wo, c, Vec2::new(u.x, u.y * u.y), mode));
    });
    let denser = defective(&|s| s.pdf = Box::new(move |wo, wi, _| 1.05 * lambert.pdf_solid_angle(wo, wi)));
    let no_cosine = defective(&|s| {
        s.eval = Box::new(move |wo, wi, mode| lambert.eval(wo, wi, mode) / wi.z.abs().max(1e-3))
    });
    let one_way = defective(&|s| {
        s.eval = Box::new(move |wo, wi, mode| lambert.eval(wo, wi, mode) * (1.0 + 0.1 * wo.z));
    });
    let counted_twice = defective(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| {
            lambert.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { weight: x.weight * 1.02, ..x })
        });
    });
    let leaking = defective(&|s| {
        s.sample = Box::new(move |wo, c, u, mode| {
            lambert.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { weight: x.weight * 0.98, ..x })
        });
    });
    let mut wrong_choice = Scatterer::from(glass);
    wrong_choice.sample = Box::new(move |wo, c, u, mode| glass.sample(wo, c * 0.9, u, mode));
    let mut no_eta = Scatterer::from(glass);
    no_eta.sample = Box::new(move |wo, c, u, _| glass.sample(wo, c, u, TransportMode::Importance));
    let Some((_, frosted)) =
        BSDFS.iter().flat_map(|row| (row.cases)()).find(|(case, _)| *case == "diamond, scratched")
    else {
        unreachable!()
    };
    let mut not_divided = Scatterer::from(frosted);
    not_divided.eval = Box::new(move |wo, wi, _| frosted.eval(wo, wi, TransportMode::Importance));
    let mut round = Scatterer::from(frosted);
    // Microfacets rotated about the normal: right on average over all directions, and nowhere.
    let across = |v: Vec3| Vec3::new(-v.y, v.x, v.z);
    round.pdf = Box::new(move |wo, wi, _| frosted.pdf_solid_angle(across(wo), across(wi)));
    let mut forgetful = Scatterer::from(Bsdf::new(turned()[1], Vec3::Z, [Some(lambert), None, None]));
    let as_radiance = forgetful.sample;
    forgetful.sample = Box::new(move |wo, c, u, _| as_radiance(wo, c, u, TransportMode::Radiance));
    let mut shown = Scatterer::from(mirror);
    shown.pdf = Box::new(|_, _, _| 1.0);
    let mut through = Scatterer::from(mirror);
    through.sample = Box::new(move |wo, c, u, mode| {
        mirror.sample(wo, c, u, mode).map(|x| bilux_scene::BsdfSample { wi: -x.wi, ..x })
    });
    vec![
        ("a tilted warp", "samples follow the pdf", tilted, white),
        ("pdf × 1.05", "weight times pdf is eval", denser, white),
        ("pdf × 1.05", "samples follow the pdf", defective_pdf(lambert), white),
        ("a cosine divided out", "weight times pdf is eval", no_cosine, white),
        ("a factor of one side only", "reciprocity, or else the adjoint", one_way, white),
        ("2% too much", "energy", counted_twice, white),
        ("2% lost", "energy", leaking, white),
        ("a wrong share of refraction", "samples follow the pdf", wrong_choice, adjoint),
        ("η² forgotten", "reciprocity, or else the adjoint", no_eta, adjoint),
        ("η² forgotten in rough glass", "reciprocity, or else the adjoint", not_divided, adjoint),
        ("scratches across each other", "samples follow the pdf", round, adjoint),
        ("a turned normal's adjoint forgotten", "radiance and importance agree", forgetful, white),
        (
            "a camera's rule for a light's mirror",
            "radiance and importance agree",
            ruled_as_from_a_camera(),
            white,
        ),
        ("η² forgotten", "radiance and importance agree", no_eta_either(glass), adjoint),
        ("a delta lobe with a density", "eval and pdf exclude delta lobes", shown, white),
        ("a mirror that transmits", "lobes with zero probability give no samples", through, white),
    ]
}

/// A mirror that applies the camera's rule to light subpaths too: it uses the triangle's normal only where the
/// interpolated one fails.
fn ruled_as_from_a_camera() -> Scatterer {
    let (n_shade, n_geom) = (turned()[1], Vec3::Z);
    let mirror = Lobe::Mirror(Mirror { reflectance: Rgb::WHITE });
    let bsdf = Bsdf::new(n_shade, n_geom, [Some(mirror), None, None]);
    let mut scatterer = Scatterer::from(bsdf);
    scatterer.sample = Box::new(move |wo, c, u, mode| {
        let mut sample = bsdf.sample(wo, c, u, TransportMode::Radiance)?;
        let about_shading = (sample.wi - reflect(wo, n_shade)).length() < 1e-4;
        if about_shading && mode == TransportMode::Importance {
            sample.weight *= (sample.wi.z / wo.z).abs();
        }
        Some(sample)
    });
    scatterer
}

fn no_eta_either(lobe: Lobe) -> Scatterer {
    let mut scatterer = Scatterer::from(lobe);
    scatterer.sample = Box::new(move |wo, c, u, _| lobe.sample(wo, c, u, TransportMode::Radiance));
    scatterer
}

fn defective_pdf(lobe: Lobe) -> Scatterer {
    let mut scatterer = Scatterer::from(lobe);
    scatterer.pdf = Box::new(move |wo, wi, _| 1.05 * lobe.pdf_solid_angle(wo, wi));
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
