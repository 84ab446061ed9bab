use super::*;
use crate::texture::{Channel, UvTransform};
use crate::{Span, Value};
use bilux_math::Rgb;

fn spec(kind: &str, given: &[(&str, Value)]) -> Spec {
    let mut spec = Spec::new("", kind);
    given.iter().for_each(|(key, value)| spec.parameters.set(key, value.clone()));
    spec
}

fn texture(kind: &str, given: &[(&str, Value)], parts: &[Texture]) -> Texture {
    let parts = parts.iter().cloned().map(Arc::new).collect();
    Texture::by_formula(spec(kind, given), parts, false).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(kind: &str, given: &[(&str, Value)]) -> String {
    Texture::by_formula(spec(kind, given), Vec::new(), false).unwrap_err().to_string()
}

fn number(x: f32) -> Value {
    x.into()
}

fn stop(at: f32, colour: [f32; 3]) -> Value {
    Value::List(vec![number(at), Value::triple(colour)])
}

fn red_green() -> Value {
    Value::List(vec![stop(0.25, [1.0, 0.0, 0.0]), stop(0.75, [0.0, 1.0, 0.0])])
}

fn near(got: Rgb, wanted: [f32; 3]) {
    let off = got.to_array().iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(off < 1e-6, "{got:?} and not {wanted:?}");
}

#[test]
fn checkers_and_their_images_have_squares_in_place() {
    let [su, sv, du, dv] = [3.0f32, 2.0, 0.0, 0.25];
    let lies = [
        ("u_scale", number(su)),
        ("v_scale", number(sv)),
        ("u_offset", number(du)),
        ("v_offset", number(dv)),
    ];
    let board = texture("checker", &lies, &[]);
    let (picture, is_same) = board.baked(true).unwrap();
    assert!(is_same && picture.width() == 2);
    for (i, k) in (0..40).flat_map(|i| (0..40).map(move |k| (i, k))) {
        let uv = Vec2::new(i as f32 * 0.073 - 1.0, k as f32 * 0.0513 - 0.7);
        let is_first = ((su * uv.x + du).floor() + (sv * uv.y + dv).floor()) % 2.0 == 0.0;
        let wanted = Rgb::grey(if is_first { 1.0 } else { 0.0 });
        assert_eq!(board.at(uv), wanted, "{uv}");
        assert_eq!(picture.at(uv), wanted, "{uv}");
    }
}

#[test]
fn ramps_go_from_stop_to_stop() {
    let ramp = |more: &[(&str, Value)]| texture("ramp", &[&[("stops", red_green())], more].concat(), &[]);
    let along_u = ramp(&[]);
    for (u, wanted) in [
        (-9.0, [1.0, 0.0, 0.0]),
        (0.25, [1.0, 0.0, 0.0]),
        (0.375, [0.75, 0.25, 0.0]),
        (0.5, [0.5, 0.5, 0.0]),
        (0.75, [0.0, 1.0, 0.0]),
        (2.0, [0.0, 1.0, 0.0]),
    ] {
        near(along_u.at(Vec2::new(u, 0.1)), wanted);
    }
    let along = |word: &str| ramp(&[("along", word.into())]);
    near(along("v").at(Vec2::new(0.0, 0.5)), [0.5, 0.5, 0.0]);
    near(along("radius").at(Vec2::new(0.75, 0.5)), [0.5, 0.5, 0.0]);
    near(along("radius").at(Vec2::new(0.5, 0.5)), [1.0, 0.0, 0.0]);
    near(
        ramp(&[("u_scale", number(2.0)), ("u_offset", number(-0.5))]).at(Vec2::new(0.5, 0.0)),
        [0.5, 0.5, 0.0],
    );
    // Two stops at the same position make an edge.
    let edge = Value::List(vec![stop(0.5, [0.0; 3]), stop(0.5, [1.0; 3])]);
    let edge = texture("ramp", &[("stops", edge)], &[]);
    assert_eq!([0.4999, 0.5].map(|u| edge.at(Vec2::new(u, 0.0)).r), [0.0, 1.0]);
    // Another texture gives the position.
    let steps =
        Texture { filter: Filter::Nearest, ..Texture::new("", 2, 1, vec![Rgb::grey(0.5), Rgb::WHITE], true) };
    let led = texture("ramp", &[("stops", red_green()), ("input", Value::Texture(0))], &[steps]);
    near(led.at(Vec2::new(0.25, 0.9)), [0.5, 0.5, 0.0]);
    near(led.at(Vec2::new(0.75, 0.9)), [0.0, 1.0, 0.0]);
}

#[test]
fn noise_is_balanced_smooth_and_seeded() {
    let noise = |octaves: i64, seed: i64| {
        let given = [
            ("octaves", Value::Integer(octaves)),
            ("seed", Value::Integer(seed)),
            ("u_scale", number(1.0)),
            ("v_scale", number(1.0)),
        ];
        texture("noise", &given, &[])
    };
    for octaves in [1, 6, 16] {
        let clouds = noise(octaves, 3);
        let at = |i: usize| clouds.at(Vec2::new((i % 256) as f32 * 0.21 + 0.05, (i / 256) as f32 * 0.19)).r;
        let all: Vec<f32> = (0..65536).map(at).collect();
        let mean = all.iter().map(|x| f64::from(*x)).sum::<f64>() / all.len() as f64;
        let spread = all.iter().map(|x| (f64::from(*x) - mean) * (f64::from(*x) - mean)).sum::<f64>()
            / all.len() as f64;
        let ends = all.iter().filter(|x| **x <= 0.0 || **x >= 1.0).count();
        assert!(all.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!((mean - 0.5).abs() < 0.01, "{octaves}: {mean}");
        assert!((0.1..0.25).contains(&spread.sqrt()), "{octaves}: {spread}");
        assert!(ends * 200 < all.len(), "{octaves}: {ends}");
    }
    let clouds = noise(1, 3);
    // The noise is 0 at grid corners, and steps between neighbours are small.
    near(clouds.at(Vec2::new(5.0, -7.0)), [0.5; 3]);
    for i in 0..4000 {
        let at = Vec2::new(i as f32 * 0.001 - 2.0, 0.3);
        let step = clouds.at(at + Vec2::new(0.001, 0.0)).r - clouds.at(at).r;
        assert!(step.abs() < 0.003, "{at}: {step}");
    }
    let at = Vec2::new(0.3, 0.6);
    assert_eq!(clouds.at(at), noise(1, 3).at(at));
    assert!((0..20).filter(|seed| noise(1, *seed).at(at) == clouds.at(at)).count() == 1);
    // Nothing overflows far away.
    assert!([1e9, -1e30, f32::MAX].iter().all(|x| noise(6, 1).at(Vec2::splat(*x)).is_finite()));
}

#[test]
fn mix_and_scale_combine_two_textures() {
    let board = || texture("checker", &[("u_scale", number(2.0)), ("v_scale", number(2.0))], &[]);
    let (white, black) = (Vec2::new(0.25, 0.25), Vec2::new(0.75, 0.25));
    let mix = [
        ("a", Value::triple([1.0, 0.0, 0.0])),
        ("b", Value::triple([0.0, 0.0, 1.0])),
        ("amount", Value::Texture(0)),
    ];
    let mixed = texture("mix", &mix, &[board()]);
    near(mixed.at(white), [0.0, 0.0, 1.0]);
    near(mixed.at(black), [1.0, 0.0, 0.0]);
    near(texture("mix", &[("amount", number(0.25))], &[]).at(white), [0.25; 3]);
    let scale = [("a", Value::Texture(0)), ("b", Value::Texture(1))];
    let both = texture("scale", &scale, &[mixed, board()]);
    near(both.at(white), [0.0, 0.0, 1.0]);
    near(both.at(black), [0.0; 3]);
}

#[test]
fn texture_options_apply_to_procedural_textures() {
    let ramp = texture("ramp", &[("stops", red_green())], &[]);
    let part = Texture { channel: Some(Channel::G), factor: Rgb::grey(0.5), ..ramp.clone() };
    assert_eq!(part.number(Vec2::new(0.5, 0.5)), 0.25);
    let cut = Texture { threshold: Some(0.4), ..part };
    assert_eq!(cut.number(Vec2::new(0.9, 0.5)), 1.0);
    // Shifted by a quarter, as images are; downwards where their coordinates point down.
    let moved = Texture { transform: Some(UvTransform::new([0.25, 0.25], 0.0, [1.0; 2])), ..ramp };
    near(moved.at(Vec2::new(0.25, 0.5)), [0.5, 0.5, 0.0]);
    let upwards = texture("ramp", &[("stops", red_green()), ("along", "v".into())], &[]);
    let moved = Texture { transform: Some(UvTransform::new([0.25, 0.25], 0.0, [1.0; 2])), ..upwards };
    near(moved.at(Vec2::new(0.25, 0.75)), [0.5, 0.5, 0.0]);
    let (picture, is_same) = moved.baked(true).unwrap();
    assert!(!is_same && picture.formula().is_none() && picture.width() == 1024);
    for uv in [Vec2::new(0.3, 0.75), Vec2::new(0.1, 0.9)] {
        let (a, b) = (picture.at(uv), moved.at(uv));
        assert!((a.r - b.r).abs() < 2e-3, "{a:?} {b:?}");
    }
    assert_eq!(
        moved.texel(3, 512),
        moved.formula().unwrap().at(Vec2::new(3.5 / 1024.0, 1.0 - 512.5 / 1024.0))
    );
}

#[test]
fn errors_are_reported() {
    assert!(refusal("cheker", &[]).contains("there is no texture 'cheker'; did you mean 'checker'?"));
    assert!(refusal("noise", &[("octave", number(3.0))]).contains("did you mean 'octaves'?"));
    assert!(refusal("noise", &[("octaves", Value::Integer(17))]).contains("a whole number from 1 to 16"));
    assert!(refusal("mix", &[("amount", number(1.5))]).contains("from 0 to 1"));
    assert!(refusal("ramp", &[]).contains("ramp.stops"));
    let falling = Value::List(vec![stop(0.5, [0.0; 3]), stop(0.2, [1.0; 3])]);
    for stops in [falling, Value::List(Vec::new()), number(1.0), Value::List(vec![stop(f32::NAN, [0.0; 3])])]
    {
        let reported = refusal("ramp", &[("stops", stops)]);
        assert!(reported.contains("whose positions never decrease"), "{reported}");
    }
    // A texture that contains itself twice, again and again, would take hours.
    let mut doubled = texture("checker", &[], &[]);
    let twice = [("a", Value::Texture(0)), ("b", Value::Texture(0))];
    let reported = (0..20).find_map(|_| {
        let parts = vec![Arc::new(doubled.clone()), Arc::new(doubled.clone())];
        let given = [twice[0].clone(), ("b", Value::Texture(1))];
        match Texture::by_formula(Spec { span: Span::default(), ..spec("scale", &given) }, parts, false) {
            Ok(texture) => {
                doubled = texture;
                None
            }
            Err(error) => Some(error.to_string()),
        }
    });
    assert!(reported.unwrap().contains("more than 256"));
}
