//! Which objects cover how much of a pixel, where it is known without rendering.

use crate::common::{built, diffuse, integrator, put, quad, still_life};
use bilux_math::Vec3;
use bilux_scene::{Scene, SceneBuilder};
use bilux_transport::mattes::{MIN_SAMPLES, Ranks, mattes};
use bilux_transport::{RenderSettings, Silent, Window};

fn seen(scene: &Scene, settings: &RenderSettings, ids: &[Vec<u32>]) -> Vec<Vec<Ranks>> {
    let camera = &*scene.cameras()[0].1;
    let samples = settings.spp;
    mattes(scene, camera, &*integrator("path"), settings, ids, samples, &Silent).unwrap().unwrap()
}

/// A fraction of each pixel of a column lies beyond the edge of a wall, where there is nothing.
#[test]
fn coverage_beside_nothing_is_the_area_of_the_pixel() {
    let mut builder = SceneBuilder::default();
    // 20 pixels of a tenth: the wall ends 0.3 into the column 10.
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 5.03, Vec3::Y * 10.0),
        diffuse(0.5f32),
    );
    let spec = bilux_scene::Spec::new("eye", "orthographic").with("position", Vec3::Z * 5.0);
    let spec = spec.with("look_at", Vec3::ZERO).with("height", 2.0f32);
    builder.cameras.push(bilux_scene::cameras::CameraSpec { spec, keyframes: Vec::new() });
    let scene = built(&builder);
    let filter = bilux_transport::Filter::from_name("box").unwrap();
    let settings = RenderSettings { filter, ..RenderSettings::new(20, 20, 128) };
    let found = seen(&scene, &settings, &[vec![7]]);
    let column = |x: usize| (0..20).map(|y| found[0][y * 20 + x][0].1).sum::<f32>() / 20.0;
    assert_eq!((column(9), column(11)), (1.0, 0.0));
    // 2,560 samples: a standard error of 0.009 if they were random.
    assert!((column(10) - 0.3).abs() < 0.03, "{}", column(10));
}

#[test]
fn coverage_is_exact_where_it_is_known() {
    let scene = built(&still_life());
    let objects = scene.geometry().objects().len() as u32;
    let ids: Vec<u32> = (1..=objects).collect();
    let ids = [ids, vec![7; objects as usize]];
    let found = seen(&scene, &RenderSettings::new(40, 30, 32), &ids);
    let mut edges = 0;
    for (each, together) in found[0].iter().zip(&found[1]) {
        let total: f32 = each.iter().map(|(_, share)| share).sum();
        assert!((together[0].1 - total).abs() < 1e-6 && together[1] == (0, 0.0));
        assert!(together[0].0 == if total > 0.0 { 7 } else { 0 });
        assert!(each.windows(2).all(|pair| pair[0].1 >= pair[1].1), "those that cover most come first");
        edges += u32::from(each[1].1 > 0.0);
    }
    assert!(edges > 20, "{edges}");
}

#[test]
fn the_same_for_any_number_of_threads_and_any_part() {
    let scene = built(&still_life());
    let ids = vec![(1..=scene.geometry().objects().len() as u32).collect()];
    let base = RenderSettings::new(40, 30, 8);
    let all = seen(&scene, &RenderSettings { threads: 1, ..base.clone() }, &ids);
    assert!(seen(&scene, &RenderSettings { threads: 3, ..base.clone() }, &ids) == all);
    assert!(seen(&scene, &RenderSettings { samples: 3..5, ..base.clone() }, &ids) == all);
    let few = RenderSettings { spp: MIN_SAMPLES, samples: 0..1, ..base.clone() };
    assert!(seen(&scene, &few, &ids) == all, "a picture of few samples has no rougher edges");
    let crop = Window { x: 7, y: 5, width: 20, height: 11 };
    let part = seen(&scene, &RenderSettings { crop: Some(crop), ..base }, &ids);
    for (i, ranks) in part[0].iter().enumerate() {
        let (x, y) = crop.position(i);
        assert_eq!(*ranks, all[0][(y * 40 + x) as usize]);
    }
}
