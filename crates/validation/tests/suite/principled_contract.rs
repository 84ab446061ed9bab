//! `principled` keeps the BSDF contract over its parameters, at their extremes and in between.

use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::materials::{MaterialInputs, build};
use bilux_scene::{Bsdf, Primitive, Spec, Surface, TransportMode, Wavelength};
use bilux_testing::effort;
use bilux_validation::SUITE;
use bilux_validation::bsdf_contract::{CHECKS, Promise, Scatterer, keeps};
use bilux_validation::chi_square::uniforms;

/// A point at which a normal map, if there is one, has turned the mesh's normal.
fn surface(n_shade: Vec3, n_smooth: Vec3) -> Surface {
    Surface {
        t: 1.0,
        p: Vec3::ZERO,
        p_error: Vec3::ZERO,
        n_geom: Vec3::Z,
        n_shade,
        n_smooth,
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

fn principled(numbers: &[(&str, f32)], base: Rgb) -> Bsdf {
    about(Vec3::Z, numbers, base)
}

fn about(n_shade: Vec3, numbers: &[(&str, f32)], base: Rgb) -> Bsdf {
    at(&surface(n_shade, n_shade), numbers, base)
}

fn at(surface: &Surface, numbers: &[(&str, f32)], base: Rgb) -> Bsdf {
    let spec = Spec::new("", "principled").with("base_color", base);
    let spec = numbers.iter().fold(spec, |spec, (key, number)| spec.with(key, *number));
    build(&spec, &MaterialInputs::default()).unwrap().bsdf(surface)
}

const ORANGE: Rgb = Rgb { r: 0.9, g: 0.5, b: 0.1 };

/// Name and parameters of a material, and whether it refracts light.
type Case = (&'static str, &'static [(&'static str, f32)], bool);

const CASES: &[Case] = &[
    ("rough plastic", &[("specular_roughness", 0.7)], false),
    ("metal in part, brushed", &[("base_metalness", 0.5), ("specular_roughness_anisotropy", 0.8)], false),
    ("coated paint", &[("specular_roughness", 0.5), ("coat_weight", 0.8), ("coat_roughness", 0.3)], false),
    ("frosted", &[("transmission_weight", 0.7), ("specular_roughness", 0.4), ("coat_weight", 0.5)], true),
    (
        "oily glass",
        &[("transmission_weight", 0.8), ("specular_roughness", 0.4), ("thin_film_weight", 0.7)],
        true,
    ),
    ("velvet", &[("fuzz_weight", 0.9), ("fuzz_roughness", 0.4), ("coat_weight", 0.5)], false),
    ("leaf", &[("diffuse_transmission_weight", 0.6), ("fuzz_weight", 0.3)], false),
    ("oily", &[("thin_film_weight", 0.8), ("base_metalness", 0.5), ("specular_roughness", 0.4)], false),
    ("rough clay", &[("base_diffuse_roughness", 1.0), ("specular_weight", 0.0)], false),
    ("glazed clay", &[("base_diffuse_roughness", 0.6), ("coat_weight", 0.7), ("fuzz_weight", 0.3)], false),
    ("dense", &[("specular_ior", 2.4), ("specular_weight", 0.4), ("base_metalness", 0.2)], false),
];

/// The names of all checks.
fn all() -> Vec<&'static str> {
    CHECKS.iter().map(|(name, _)| *name).collect()
}

#[test]
fn its_parameters_keep_the_contract() {
    for (name, numbers, refracts) in CASES {
        let bsdf = principled(numbers, ORANGE);
        let promise = Promise { reciprocal: !refracts, lossless: false };
        assert_eq!(keeps(name, &all(), &bsdf.into(), promise), Ok(()), "{name}");
    }
}

#[test]
fn dispersive_bsdfs_keep_their_contract_at_every_wavelength() {
    let parted = ("transmission_dispersion_scale", 1.0);
    let frosted = [("transmission_weight", 0.8), ("specular_roughness", 0.4), ("coat_weight", 0.5), parted];
    let clear = [("transmission_weight", 1.0), ("specular_roughness", 0.0), parted, ("specular_ior", 1.9)];
    for numbers in [frosted, clear] {
        let bsdf = principled(&numbers, ORANGE);
        assert!(!bsdf.splits());
        for nm in effort(vec![460.0, 690.0], vec![400.0, 460.0, 530.0, 600.0, 690.0]) {
            // In air, and in a medium denser than the material.
            for outside in [1.0, 2.1] {
                let one = bsdf.refracting(&Wavelength::of(nm), outside);
                assert!(one.splits());
                let name =
                    format!("{} at {nm} nm in {outside}", if numbers == clear { "clear" } else { "frosted" });
                let promise = Promise { reciprocal: false, lossless: false };
                assert_eq!(keeps(&name, &all(), &one.into(), promise), Ok(()), "{name}");
            }
        }
    }
    // Without transmission, or without an interior, nothing is split.
    for numbers in [[parted, ("transmission_weight", 0.0)], [parted, ("coat_weight", 1.0)]] {
        assert!(!principled(&numbers, ORANGE).refracting(&Wavelength::of(450.0), 1.0).splits());
    }
    let pane = Spec::new("", "principled").with("transmission_weight", 1.0f32).with("thin_walled", true);
    let pane = pane.with("transmission_dispersion_scale", 1.0f32);
    assert!(!build(&pane, &MaterialInputs::default()).unwrap().disperses());
}

#[test]
fn turned_normals_keep_it_too() {
    let n_shade = Vec3::new(-0.3, 0.4, 1.0).normalize();
    for (name, numbers, _) in &CASES[1..4] {
        let promise = Promise { reciprocal: false, lossless: false };
        let bsdf = about(n_shade, numbers, ORANGE);
        assert_eq!(keeps(name, &["radiance and importance agree"], &bsdf.into(), promise), Ok(()), "{name}");
    }
}

/// A rough base below a coat that is as smooth as the mesh, both tilted against the triangle.
#[test]
fn a_coat_with_a_normal_of_its_own_keeps_it_too() {
    let coats: [&[(&str, f32)]; 4] = [
        &[("coat_weight", 0.8), ("coat_roughness", 0.3)],
        &[("coat_weight", 1.0), ("coat_roughness", 0.0), ("fuzz_weight", 0.4)],
        &[("coat_weight", 0.6), ("base_metalness", 0.5), ("specular_roughness", 0.0)],
        &[("coat_weight", 0.5), ("transmission_weight", 0.7), ("specular_roughness", 0.4)],
    ];
    let checks = ["weight times pdf is eval", "radiance and importance agree"];
    let (bump, tilt) = (Vec3::new(-0.3, 0.4, 1.0).normalize(), Vec3::new(0.1, 0.05, 1.0).normalize());
    for numbers in coats {
        for (n_shade, n_smooth) in [(bump, Vec3::Z), (bump, tilt), (Vec3::Z, tilt)] {
            let bsdf = at(&surface(n_shade, n_smooth), numbers, ORANGE);
            for (bends, bsdf) in [("", bsdf), (", bending", bsdf.bending())] {
                let name = format!("{numbers:?} about {n_shade} and {n_smooth}{bends}");
                let promise = Promise { reciprocal: false, lossless: false };
                assert_eq!(keeps(&name, &checks, &bsdf.into(), promise), Ok(()), "{name}");
            }
        }
    }
}

/// A polished coat reflects about the normal of the mesh, and the base below it about that of the normal map.
#[test]
fn a_coat_mirrors_about_its_own_normal() {
    let n_shade = Vec3::new(0.3, 0.0, 1.0).normalize();
    let numbers = [("coat_weight", 1.0), ("base_metalness", 1.0), ("specular_roughness", 0.0)];
    let bsdf = at(&surface(n_shade, Vec3::Z), &numbers, Rgb::grey(0.5));
    let wo = Vec3::new(-0.2, 0.3, 0.9).normalize();
    let mirrored = |n: Vec3| n * (2.0 * n.dot(wo)) - wo;
    let mut seen = [0.0f64; 2];
    const N: u64 = 20_000;
    for k in 0..N {
        let (choice, u) = uniforms(77, k);
        let sample = bsdf.sample(wo, choice, u, TransportMode::Radiance).unwrap();
        let which = [Vec3::Z, n_shade].iter().position(|n| sample.wi.distance(mirrored(*n)) < 1e-4);
        seen[which.expect("one of the two")] += f64::from(sample.weight.g) / N as f64;
    }
    // Fresnel at an index of 1.6 near normal incidence; the metal below loses only its own half and what the coat took.
    assert!((seen[0] - 0.0533).abs() < 0.003 && (0.42..0.5).contains(&seen[1]), "{seen:?}");
}

/// A white furnace: what samples bring along steep and grazing directions.
fn weights(bsdf: &Bsdf, count: u32) -> Vec<Vec<f32>> {
    let along = |cos: f32| {
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let samples = (0..u64::from(count)).map(|k| uniforms(900, k));
        let weight = |(c, u)| bsdf.sample(wo, c, u, TransportMode::Radiance).map(|s| s.weight.g);
        samples.filter_map(weight).collect()
    };
    [1.0f32, 0.8, 0.5, 0.25, 0.12].map(along).to_vec()
}

/// The number of samples along each direction.
const SAMPLES: u32 = 30_000;

/// The minimum and the maximum of what is seen.
fn range(weights: &[Vec<f32>]) -> [f64; 2] {
    let seen = weights.iter().map(|of| of.iter().map(|w| f64::from(*w)).sum::<f64>() / f64::from(SAMPLES));
    [seen.clone().fold(f64::INFINITY, f64::min), seen.fold(0.0, f64::max)]
}

/// Range of the light seen in a furnace: by the record of these parameters, where the first samples are as they were.
fn furnace(numbers: &[(&str, f32)]) -> [f64; 2] {
    let bsdf = principled(numbers, Rgb::WHITE);
    let found = SUITE.numbers(
        &format!("{numbers:?}"),
        "furnace of samples",
        SAMPLES,
        |n| weights(&bsdf, n),
        |all| range(all).to_vec(),
    );
    [found[0], found[1]]
}

#[test]
fn white_plastic_and_white_metal_lose_nothing_in_a_furnace() {
    for roughness in [0.0f32, 0.2, 0.45, 0.7, 1.0] {
        for metalness in effort(vec![0.0, 1.0], vec![0.0, 0.5, 1.0]) {
            for ior in effort(vec![1.2, 2.5], vec![1.2, 1.5, 2.5]) {
                let numbers =
                    [("specular_roughness", roughness), ("base_metalness", metalness), ("specular_ior", ior)];
                let [least, most] = furnace(&numbers);
                assert!(least > 0.985 && most < 1.012, "{numbers:?}: {least:.4} to {most:.4}");
            }
        }
    }
    // Nor does a rough base lose anything, alone or below a layer that lets light through to it.
    for roughness in [0.3f32, 1.0] {
        for weight in [0.0, 1.0] {
            let numbers = [("base_diffuse_roughness", roughness), ("specular_weight", weight)];
            let [least, most] = furnace(&numbers);
            assert!(least > 0.97 && most < 1.012, "{numbers:?}: {least:.4} to {most:.4}");
        }
    }
    // A sheet loses nothing over its two sides together.
    let [least, most] = furnace(&[("diffuse_transmission_weight", 0.6)]);
    assert!(least > 0.985 && most < 1.012, "a sheet: {least:.4} to {most:.4}");
    for roughness in [0.0f32, 0.3, 0.6, 1.0] {
        let numbers = [("fuzz_weight", 1.0), ("fuzz_roughness", roughness), ("specular_weight", 0.0)];
        let [least, most] = furnace(&numbers);
        assert!(least > 0.97 && most < 1.03, "fuzz of {roughness}: {least:.4} to {most:.4}");
    }
    for thickness in [0.1f32, 0.3, 0.6] {
        for metalness in [0.0, 1.0] {
            let numbers = [
                ("thin_film_weight", 1.0),
                ("thin_film_thickness", thickness),
                ("base_metalness", metalness),
            ];
            let [_, most] = furnace(&numbers);
            assert!(most < 1.012, "film of {thickness}: {most:.4}");
        }
    }
    // A film on glass transmits what it does not reflect.
    for thickness in [0.1f32, 0.4] {
        let film = [("thin_film_weight", 1.0), ("thin_film_thickness", thickness), ("thin_film_ior", 1.8)];
        let clear = [("transmission_weight", 1.0), ("specular_roughness", 0.0), ("specular_ior", 1.0)];
        let [least, most] = furnace(&[film, clear].concat());
        assert!(least > 0.985 && most < 1.012, "bubble of {thickness}: {least:.4} to {most:.4}");
    }
    let grey = range(&weights(&principled(&[("specular_roughness", 0.7)], Rgb::grey(0.9)), SAMPLES));
    assert!(grey[0] < 0.985, "a grey one passes for white: {grey:?}");
}

#[test]
fn a_coat_takes_little_from_white() {
    for roughness in [0.0f32, 0.3, 0.8] {
        for coat_roughness in [0.0, 0.4, 1.0] {
            for metalness in [0.0, 1.0] {
                let numbers = [
                    ("specular_roughness", roughness),
                    ("coat_roughness", coat_roughness),
                    ("base_metalness", metalness),
                    ("coat_weight", 1.0),
                ];
                let [least, most] = furnace(&numbers);
                assert!(least > 0.75 && most < 1.015, "{numbers:?}: {least:.4} to {most:.4}");
            }
        }
    }
}

#[test]
fn nothing_on_top_leaves_the_diffuse_base() {
    let bare = principled(&[("specular_weight", 0.0)], ORANGE);
    let spec = Spec::new("", "diffuse").with("reflectance", ORANGE);
    let diffuse = build(&spec, &MaterialInputs::default()).unwrap().bsdf(&surface(Vec3::Z, Vec3::Z));
    for (c, u) in (0..500).map(|k| uniforms(901, k)) {
        let wo = bilux_math::warp::sample_sphere(u);
        let found = bare.sample(wo, c, u, TransportMode::Radiance);
        assert_eq!(found, diffuse.sample(wo, c, u, TransportMode::Radiance));
    }
}

#[test]
fn every_corner_is_finite() {
    let keys = [
        "base_diffuse_roughness",
        "base_metalness",
        "specular_weight",
        "specular_roughness",
        "specular_roughness_anisotropy",
        "transmission_weight",
        "coat_weight",
        "coat_roughness",
        "fuzz_weight",
        "diffuse_transmission_weight",
        "thin_film_weight",
    ];
    for corner in 0..1u32 << keys.len() {
        for ior in [1.0f32, 10.0] {
            let mut numbers: Vec<(&str, f32)> =
                keys.iter().enumerate().map(|(i, key)| (*key, (corner >> i & 1) as f32)).collect();
            numbers.extend([("specular_ior", ior), ("coat_ior", 11.0 - ior)]);
            let bsdf = principled(&numbers, Rgb::WHITE);
            for (k, z) in [1.0f32, 0.3, 1e-3, 1e-20, -0.5, 0.0].into_iter().enumerate() {
                let wo = Vec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
                for (c, u) in (0..16).map(|i| uniforms(910 + k as u64, i)) {
                    for mode in [TransportMode::Radiance, TransportMode::Importance] {
                        let sample = bsdf.sample(wo, c, u, mode);
                        let sound = sample.is_none_or(|s| {
                            s.weight.is_finite() && s.pdf_solid_angle > 0.0 && s.weight.r >= 0.0
                        });
                        assert!(sound, "{numbers:?} from {wo}: {sample:?}");
                        let (f, pdf) = bsdf.eval_and_pdf(wo, bilux_math::warp::sample_sphere(u), mode);
                        assert!(f.is_finite() && pdf.is_finite() && pdf >= 0.0, "{numbers:?} from {wo}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_checks_see_bugs_in_it() {
    let bsdf = principled(CASES[2].1, ORANGE);
    let mut one_way = Scatterer::from(bsdf);
    one_way.eval = Box::new(move |wo, wi, mode| bsdf.eval(wo, wi, mode) * (1.0 - 0.1 * wo.z.abs()));
    // A choice of lobe that mistakes the direction from which it was made.
    let mut other_view = Scatterer::from(bsdf);
    other_view.pdf = Box::new(move |wo, wi, mode| bsdf.pdf_solid_angle(wi, wo, mode));
    let mut bright = Scatterer::from(principled(&[("specular_roughness", 0.6)], Rgb::WHITE));
    let sample = bright.sample;
    bright.sample = Box::new(move |wo, c, u, mode| {
        sample(wo, c, u, mode).map(|s| bilux_scene::BsdfSample { weight: s.weight * 1.03, ..s })
    });
    let planted = [
        (one_way, "reciprocity, or else the adjoint"),
        (other_view, "samples follow the pdf"),
        (bright, "energy"),
    ];
    for (scatterer, name) in planted {
        let (_, run) = CHECKS.iter().find(|(check, _)| *check == name).unwrap();
        assert!(run(&scatterer, Promise { reciprocal: true, lossless: false }).is_err(), "{name}");
    }
}

#[test]
fn parameters_out_of_range_are_reported() {
    for (key, number, range) in [
        ("specular_roughness", -0.1, "0 to 1"),
        ("specular_ior", 0.0, "1 to 10"),
        ("coat_weight", f32::NAN, "0 to 1"),
    ] {
        let error = build(&Spec::new("", "principled").with(key, number), &MaterialInputs::default()).err();
        let message = error.map(|e| e.to_string()).unwrap_or_default();
        assert!(message.contains(key) && message.contains(range), "{message}");
    }
}
