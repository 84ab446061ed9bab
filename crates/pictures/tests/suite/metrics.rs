//! Metrics against values that other programs computed for the same pictures.

use bilux_math::Rgb;
use bilux_pictures::metrics::{HeatMap, METRICS, Pair, compare, heat_map, ramp};
use bilux_pictures::{ColourSpace, Picture, PictureError, TONEMAPS};

const WIDTH: usize = 96;
const HEIGHT: usize = 64;

/// An encoded picture, given the byte of every pixel and channel.
fn picture(byte: impl Fn(i64, i64, i64) -> i64) -> Picture {
    let mut picture = Picture::new(WIDTH, HEIGHT).unwrap();
    picture.colour_space = ColourSpace::Srgb;
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let sample = |i: usize| byte((i % WIDTH) as i64, (i / WIDTH) as i64, channel as i64) as f32 / 255.0;
        picture.push_channel(name, (0..WIDTH * HEIGHT).map(sample).collect()).unwrap();
    }
    picture
}

fn gradient(x: i64, y: i64, channel: i64) -> i64 {
    let (right, bottom) = (WIDTH as i64 - 1, HEIGHT as i64 - 1);
    [x * 255 / right, y * 255 / bottom, (x + y) * 255 / (right + bottom)][channel as usize]
}

fn hash(x: i64, y: i64, channel: i64) -> i64 {
    let mixed = ((x * 73_856_093) ^ (y * 19_349_663) ^ (channel * 83_492_791)) & 0xffff_ffff;
    let mixed = ((mixed ^ (mixed >> 15)) * 0x2c1b_3c6d) & 0xffff_ffff;
    (mixed ^ (mixed >> 12)) & 255
}

fn noisy(x: i64, y: i64, channel: i64) -> i64 {
    (gradient(x, y, channel) + hash(x, y, channel) / 4 - 32).clamp(0, 255)
}

fn checks(x: i64, y: i64, channel: i64) -> i64 {
    if (x / 8 + y / 8) % 2 == 0 { 230 } else { 25 + 10 * channel }
}

fn only(channel: i64) -> impl Fn(i64, i64, i64) -> i64 {
    move |_, _, c| if c == channel { 255 } else { 0 }
}

/// FLIP by flip-evaluator 1.7; SSIM and PSNR by scikit-image 0.26 (Gaussian window, sigma 1.5, Rec. 709
/// luma, no sample covariance); the others by NumPy from their definitions.
#[test]
fn figures_of_other_programs() {
    let cases: [(Picture, Picture, [f64; 6]); 4] = [
        (
            picture(noisy),
            picture(gradient),
            [0.07986080, 0.05638754, 0.26208959, 23.018076, 0.36122175, 0.151622],
        ),
        (
            picture(|x, y, c| gradient(x, y, c) * 3 / 4),
            picture(gradient),
            [0.19049654, 0.13990736, 0.47900443, 16.900429, 0.94453137, 0.553578],
        ),
        (
            picture(|x, y, c| checks(x + 3, y, c)),
            picture(checks),
            [0.47381557, 11.02710024, 0.78157672, 6.582191, 0.18183702, 0.564170],
        ),
        (picture(only(2)), picture(only(1)), [0.81649658, 33.66336634, 1.0, 1.760913, 0.20001955, 1.0]),
    ];
    for (i, (a, b, expected)) in cases.iter().enumerate() {
        let report = compare(a, b).unwrap();
        for ((name, value), expected) in report.values.iter().zip(*expected) {
            // flip-evaluator computes in f32, we in f64: where features hardly differ, the square root amplifies its
            // rounding errors to as much as 1e-4 in single pixels of the checks, 5e-6 in the mean.
            let tolerance = if *name == "flip" { 1e-5 } else { 1e-6 * expected.max(1.0) };
            assert!((value - expected).abs() <= tolerance, "{name} of case {i}: {value}, not {expected}");
        }
    }
}

#[test]
fn equal_pictures_do_not_differ() {
    for reference in [picture(noisy), picture(checks), picture(only(0)).into_linear()] {
        let report = compare(&reference, &reference).unwrap();
        for name in ["rmse", "relmse", "max", "flip"] {
            assert_eq!(report.value(name), Some(0.0), "{name}");
        }
        assert_eq!((report.value("ssim"), report.value("psnr")), (Some(1.0), Some(f64::INFINITY)));
        assert_eq!(report.finite("psnr"), None);
        assert_eq!(report.values.len(), METRICS.len());
    }
}

/// Each metric must detect a small change, and report a larger error for one twice as large.
#[test]
fn more_error_is_worse() {
    let reference = picture(gradient);
    let changed =
        |by: i64| picture(move |x, y, c| (gradient(x, y, c) + by * (hash(x, y, c) % 3 - 1)).clamp(0, 255));
    let reports = [1, 8, 16].map(|by| compare(&changed(by), &reference).unwrap());
    for row in METRICS {
        let [a, b, c] = [0, 1, 2].map(|i: usize| reports[i].value(row.entry.name).unwrap());
        assert!(if row.higher_is_better { a > b && b > c } else { a < b && b < c }, "{}", row.entry.name);
    }
}

#[test]
fn relmse_is_relative_to_the_second() {
    let grey = |value| Picture::from_rgb(1, 1, vec![Rgb::grey(value)]).unwrap();
    let relmse = |a, b| compare(&grey(a), &grey(b)).unwrap().value("relmse").unwrap();
    assert!((relmse(1.0, 2.0) - 1.0 / 4.01).abs() < 1e-7);
    assert!((relmse(2.0, 1.0) - 1.0 / 1.01).abs() < 1e-7);
}

#[test]
fn nan_is_not_hidden() {
    let reference = picture(gradient).into_linear();
    let mut broken = reference.clone();
    broken.channel_mut("G").unwrap()[WIDTH * 3 + 5] = f32::NAN;
    let report = compare(&broken, &reference).unwrap();
    assert_eq!(report.non_finite, [1, 0]);
    for name in ["rmse", "relmse", "max"] {
        assert!(report.value(name).unwrap().is_nan() && report.finite(name).is_none(), "{name}");
    }
    let found = broken.non_finite();
    assert_eq!((found.count, found.first), (1, Some(("G".to_owned(), 5, 3))));
}

#[test]
fn alpha_alone_can_differ() {
    let mut a = Picture::from_rgb(2, 2, vec![Rgb::BLACK; 4]).unwrap();
    let mut b = a.clone();
    a.push_channel("A", vec![1.0; 4]).unwrap();
    b.push_channel("A", vec![1.0, 0.25, 1.0, 1.0]).unwrap();
    assert_eq!(compare(&a, &b).unwrap().value("max"), Some(0.75));
}

#[test]
fn sizes_have_to_agree() {
    let small = Picture::from_rgb(1, 2, vec![Rgb::BLACK; 2]).unwrap();
    let error = compare(&picture(gradient), &small).unwrap_err();
    assert!(matches!(error, PictureError::SizesDiffer { a: (WIDTH, HEIGHT), b: (1, 2) }));
    assert!(error.to_string().contains("96 x 64") && error.to_string().contains("1 x 2"));
    let mut depth = Picture::new(1, 2).unwrap();
    depth.push_channel("Z", vec![0.0; 2]).unwrap();
    assert!(compare(&small, &depth).is_err());
}

#[test]
fn tiny_pictures_have_metrics_too() {
    for (width, height) in [(1, 1), (1, 9), (3, 2), (12, 4)] {
        let grey = |value| Picture::from_rgb(width, height, vec![Rgb::grey(value); width * height]).unwrap();
        let report = compare(&grey(0.5), &grey(0.25)).unwrap();
        assert!(report.values.iter().all(|(_, value)| value.is_finite()), "{report:?}");
    }
}

#[test]
fn heat_maps_show_where() {
    let reference = picture(|_, _, _| 100);
    let changed = picture(|x, y, c| if (x - 70).abs() < 5 && (y - 20).abs() < 5 { 200 - c } else { 100 });
    let pair = Pair::new(&changed, &reference, 0.0, &TONEMAPS[0]).unwrap();
    for kind in [HeatMap::Flip, HeatMap::Absolute] {
        let map = heat_map(&pair, kind).unwrap();
        assert_eq!(map.colour_space, ColourSpace::Srgb);
        assert_eq!(map.rgb(10, 50), ramp(0.0));
        assert!(map.rgb(70, 20).luminance() > 0.5, "{kind:?}");
    }
    let steps: Vec<f32> = (0..=100).map(|i| ramp(i as f32 / 100.0).luminance()).collect();
    assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
}
