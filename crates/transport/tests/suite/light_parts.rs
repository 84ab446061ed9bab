//! The light of a picture in parts: they add up to the picture, and each is what its lights alone would give.

use crate::common::{built, diffuse, floor, integrator, look, mixed, put, shoot};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec, Value};
use bilux_transport::{
    Film, LengthBins, LightDivision, LightParts, RenderSettings, Silent, Window, integrators, light_parts,
};

/// By scattering events, and each light for itself; what shines otherwise belongs to one more group.
fn division(scene: &Scene) -> LightDivision {
    let lights = scene.lights().len() as u32;
    LightDivision { by_events: true, groups: (0..lights).collect(), group_count: lights + 1, by_length: None }
}

pub(crate) fn parts(scene: &Scene, integrator: &Spec, settings: &RenderSettings) -> LightParts {
    let integrator = integrators::build(integrator).unwrap();
    let (camera, division) = (&*scene.cameras()[0].1, division(scene));
    light_parts(scene, camera, &*integrator, settings, &division, &Silent).unwrap().unwrap()
}

/// The largest difference between a picture and the sum of films, relative to the picture's own light.
fn off(picture: &Film, films: &[Film]) -> f32 {
    let window = picture.window();
    let at = |i| {
        let (x, y) = window.position(i);
        let sum = films.iter().fold(Rgb::BLACK, |sum, film| sum + film.pixel(x, y));
        let pixel = picture.pixel(x, y);
        (0..3).map(|c| (sum[c] - pixel[c]).abs()).fold(0.0, f32::max) / (1.0 + pixel.max_channel())
    };
    (0..window.pixels()).map(at).fold(0.0, f32::max)
}

#[test]
fn the_parts_add_up_to_the_picture() {
    let mut builder = mixed();
    // A lamp that camera paths hit, also in the mirror.
    put(
        &mut builder,
        "lamp",
        crate::common::ball(Vec3::new(0.2, 0.3, 1.2), 0.2, 8, true),
        diffuse(0.1f32).with("emission", 3.0f32),
    );
    let scene = built(&builder);
    let vcm =
        |connections: bool| Spec::new("", "vcm").with("radius", 0.02f32).with("connections", connections);
    let photons = vcm(false).with("light_paths", Value::Integer(300));
    let crop = Window { x: 5, y: 3, width: 17, height: 11 };
    for integrator in [Spec::new("", "path"), Spec::new("", "bdpt"), vcm(true), vcm(false), photons] {
        for (crop, samples) in [(None, 0..4), (Some(crop), 1..3)] {
            let settings = RenderSettings { crop, samples, ..RenderSettings::new(32, 24, 4) };
            let film = shoot(&scene, &*integrators::build(&integrator).unwrap(), &settings).film;
            let found = parts(&scene, &integrator, &settings);
            let by_events = found.by_events.unwrap();
            for (name, error) in [("events", off(&film, &by_events)), ("groups", off(&film, &found.groups))] {
                assert!(error < 1e-5, "{integrator:?} {crop:?} by {name}: {error}");
            }
            // The test would notice a part that is missing.
            assert!(
                off(&film, &by_events[..1]) > 1e-3 && off(&film, &by_events[1..]) > 1e-3,
                "{integrator:?}"
            );
            for left_out in 0..scene.lights().len() {
                let mut others = found.groups.clone();
                others.remove(left_out);
                assert!(off(&film, &others) > 1e-3, "{integrator:?} without light {left_out}");
            }
        }
    }
}

#[test]
fn what_auto_chooses_is_divided_too() {
    let scene = built(&mixed());
    let settings = RenderSettings::new(24, 16, 4);
    let film = shoot(&scene, &*integrator("auto"), &settings).film;
    let found = parts(&scene, &Spec::new("", "auto"), &settings);
    assert!(off(&film, &found.by_events.unwrap()) < 1e-5 && off(&film, &found.groups) < 1e-5);
}

/// A floor under lights at these places.
fn lit_from(places: &[[f32; 3]]) -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 6.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    for at in places {
        let light = Spec::new("", "point").with("position", Value::triple(*at));
        builder.lights.push(light.with("intensity", 9.0f32));
    }
    look(&mut builder, Vec3::new(0.0, 3.0, 5.0), Vec3::ZERO, 40.0);
    built(&builder)
}

/// Points and one event leave nothing to chance but the place in the pixel, which is the same for all.
#[test]
fn each_group_is_what_its_light_alone_gives() {
    let (left, right) = ([-2.0, 1.5, 0.0], [2.0, 2.5, 1.0]);
    let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(24, 16, 4) };
    let found = parts(&lit_from(&[left, right]), &Spec::new("", "path"), &settings);
    for (group, alone) in [(0, left), (1, right)] {
        let film = shoot(&lit_from(&[alone]), &*integrator("path"), &settings).film;
        assert!(off(&film, &found.groups[group..=group]) < 1e-5, "{group}");
        assert!(off(&film, &found.groups[1 - group..=1 - group]) > 1e-2, "{group}");
    }
    let [direct, indirect] = found.by_events.unwrap();
    assert!(direct.pixel(12, 8).g > 0.01);
    assert!(indirect.to_rgb().iter().all(|light| light.is_black()), "the light scatters once");
}

/// A corner of two walls, under a red and a green lamp and a blue sky.
fn corner() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.7f32));
    let wall = crate::common::quad(Vec3::new(-3.0, 0.0, -1.0), Vec3::X * 6.0, Vec3::Y * 3.0);
    put(&mut builder, "wall", wall, diffuse(0.7f32));
    let lamp = |name: &str, x: f32, colour: Rgb| {
        let lamp = Spec::new(name, "rect").with("position", Vec3::new(x, 2.0, 1.0));
        lamp.with("edge_u", Vec3::X * 0.5).with("edge_v", Vec3::Z * 0.5).with("radiance", colour)
    };
    builder.lights.push(lamp("red", -1.0, Rgb::new(9.0, 0.0, 0.0)));
    builder.lights.push(Spec::new("sky", "environment").with("radiance", Rgb::new(0.0, 0.0, 0.5)));
    builder.lights.push(lamp("green", 1.0, Rgb::new(0.0, 9.0, 0.0)));
    look(&mut builder, Vec3::new(0.0, 1.5, 4.0), Vec3::new(0.0, 0.6, 0.0), 40.0);
    builder
}

/// Integrators that divide their light, `vcm` with photons and without connections, too.
fn dividing() -> [Spec; 4] {
    let vcm =
        |connections: bool| Spec::new("", "vcm").with("radius", 0.05f32).with("connections", connections);
    [Spec::new("", "path"), Spec::new("", "bdpt"), vcm(true), vcm(false)]
}

/// Grey surfaces keep the colour of light: each group has that of its own lamp, and nothing else.
#[test]
fn the_light_of_each_group_has_the_colour_of_its_lamp() {
    let scene = built(&corner());
    assert_eq!(scene.lights().len(), 3);
    for integrator in dividing() {
        let found = parts(&scene, &integrator, &RenderSettings::new(24, 16, 4));
        let colours = found.groups[..3].iter().map(|group| {
            let light = group.to_rgb().iter().fold(Rgb::BLACK, |sum, pixel| sum + *pixel);
            let channels = [light.r, light.g, light.b];
            let brightest = (0..3).max_by(|&a, &b| channels[a].total_cmp(&channels[b])).unwrap();
            let others: f32 = (0..3).filter(|&i| i != brightest).map(|i| channels[i]).sum();
            assert!(channels[brightest] > 1.0, "{integrator:?}: {light:?}");
            assert!(others < 1e-4 * channels[brightest], "{integrator:?}: {light:?}");
            brightest
        });
        let mut colours: Vec<_> = colours.collect();
        colours.sort_unstable();
        assert_eq!(colours, [0, 1, 2], "{integrator:?}: each lamp has a group of its own");
    }
}

/// Direct light is the picture of at most one scattering event, and where surfaces see nothing but lights it is all there is.
#[test]
fn direct_light_is_that_of_one_event() {
    let (corner, open) = (corner(), {
        let mut open = corner();
        open.objects.pop();
        open
    });
    for integrator in dividing() {
        let settings = |max_depth| RenderSettings { max_depth, ..RenderSettings::new(24, 16, 64) };
        let [direct, indirect] = parts(&built(&open), &integrator, &settings(6)).by_events.unwrap();
        let brightest = indirect.to_rgb().iter().fold(0.0, |most: f32, light| most.max(light.max_channel()));
        assert!(brightest < 1e-5, "{integrator:?}: a floor sees no floor, but {brightest}");
        assert!(direct.pixel(12, 12).max_channel() > 0.05, "{integrator:?}");
        let scene = built(&corner);
        let [direct, indirect] = parts(&scene, &integrator, &settings(6)).by_events.unwrap();
        let once = shoot(&scene, &*integrators::build(&integrator).unwrap(), &settings(1)).film;
        let mean = |film: &Film| film.to_rgb().iter().map(|light| light.g).sum::<f32>() / (24.0 * 16.0);
        let (direct, indirect, once) = (mean(&direct), mean(&indirect), mean(&once));
        assert!((direct / once - 1.0).abs() < 0.03, "{integrator:?}: {direct} for {once}");
        assert!(indirect > 0.1 * direct, "{integrator:?}: {indirect} beside {direct}");
    }
}

/// Light that paths meet by chance is direct after one event, too: with the random numbers of a picture of one event, bit for bit
/// but for the steps of films.
#[test]
fn what_a_path_meets_by_chance_is_direct_after_one_event() {
    let scene = built(&corner());
    for sampling in ["scattering", "mis"] {
        let integrator = Spec::new("", "path").with("sampling", sampling);
        let settings = |max_depth| RenderSettings { max_depth, ..RenderSettings::new(24, 16, 16) };
        let [direct, indirect] = parts(&scene, &integrator, &settings(6)).by_events.unwrap();
        let [once, twice] = [1, 2]
            .map(|depth| shoot(&scene, &*integrators::build(&integrator).unwrap(), &settings(depth)).film);
        assert!(off(&once, &[direct]) < 1e-4, "{sampling}");
        assert!(off(&twice, std::slice::from_ref(&once)) > 0.01, "{sampling}: two events bring light");
        assert!(off(&twice, &[once, indirect]) > 1e-4, "{sampling}: more than two, too");
    }
}

/// Light that is divided in several ways at once is divided in each as by that alone.
#[test]
fn groups_and_lengths_together_are_those_of_each_alone() {
    let scene = lit_from(&[[0.0, 2.0, 0.0], [1.5, 1.0, 0.5]]);
    let settings = RenderSettings::new(12, 8, 8);
    let bins = LengthBins { begin: 0.5, width: 0.7, count: 9 };
    let of = |division: LightDivision| {
        let (camera, path) = (&*scene.cameras()[0].1, integrator("path"));
        light_parts(&scene, camera, &*path, &settings, &division, &Silent).unwrap().unwrap()
    };
    let groups = division(&scene);
    let lengths = LightDivision { by_length: Some(bins), ..LightDivision::default() };
    let both = of(LightDivision { by_length: Some(bins), ..groups.clone() });
    let (groups, lengths) = (of(groups), of(lengths).by_length);
    assert!(both.by_events.unwrap() == groups.by_events.unwrap());
    assert!(both.groups == groups.groups && both.by_length == lengths);
    let is_lit = |film: &&Film| film.to_rgb().iter().any(|light| !light.is_black());
    assert!(groups.groups.iter().filter(is_lit).count() > 1 && lengths.iter().filter(is_lit).count() > 1);
}

#[test]
fn the_same_for_any_number_of_threads() {
    let scene = built(&mixed());
    let films = |threads| {
        let settings = RenderSettings { threads, ..RenderSettings::new(40, 24, 3) };
        let LightParts { by_events, groups, .. } = parts(&scene, &Spec::new("", "vcm"), &settings);
        (by_events.unwrap(), groups)
    };
    assert!(films(1) == films(3));
}

#[test]
fn those_that_cannot_divide_their_light_say_so() {
    assert_eq!(integrators::with_light_parts().collect::<Vec<_>>(), ["auto", "path", "bdpt", "vcm"]);
    let scene = lit_from(&[[0.0, 2.0, 0.0]]);
    let (settings, division) = (RenderSettings::new(4, 4, 1), division(&scene));
    let camera = &*scene.cameras()[0].1;
    for name in ["cast", "light", "sppm", "occlusion"] {
        let found = light_parts(&scene, camera, &*integrator(name), &settings, &division, &Silent);
        assert!(found.unwrap().is_none(), "{name}");
    }
}

/// A lamp without a surface comes before the sky, which the camera sees too: all of the sky's light is in its own group, and
/// nothing in that of lights without one.
#[test]
fn the_sky_is_in_its_own_group_wherever_it_is_seen() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.7f32));
    let lamp = Spec::new("lamp", "point").with("position", Vec3::Y * 2.0);
    builder.lights.push(lamp.with("intensity", Rgb::new(9.0, 0.0, 0.0)));
    builder.lights.push(Spec::new("sky", "environment").with("radiance", Rgb::new(0.0, 0.0, 0.5)));
    look(&mut builder, Vec3::new(0.0, 1.0, 4.0), Vec3::Y, 60.0);
    let scene = built(&builder);
    for integrator in dividing() {
        let found = parts(&scene, &integrator, &RenderSettings::new(24, 16, 4));
        let sum = |film: &Film| film.to_rgb().iter().fold(Rgb::BLACK, |sum, pixel| sum + *pixel);
        let [lamp, sky, others] = [0, 1, 2].map(|group| sum(&found.groups[group]));
        assert!(lamp.r > 1.0 && lamp.g == 0.0 && lamp.b == 0.0, "{integrator:?}: {lamp:?}");
        assert!(sky.b > 1.0 && sky.r == 0.0 && sky.g == 0.0, "{integrator:?}: {sky:?}");
        assert!(others.is_black(), "{integrator:?}: {others:?}");
        // Nothing but sky is seen there.
        assert!((found.groups[1].pixel(0, 0).b - 0.5).abs() < 1e-4, "{integrator:?}");
    }
}

/// Light that fire emits, L (1 - exp(-σ d)) before black, is in the last group, and no lamp's, whichever integrator finds it.
#[test]
fn fire_is_in_a_group_of_its_own() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 9.0), diffuse(0.0f32));
    let (emission, absorption) = (Rgb::new(3.0, 2.0, 1.0), Rgb::new(0.4, 0.9, 1.7));
    let fire = Spec::new("", "interface").with("absorption", absorption).with("medium_emission", emission);
    let [min, max] = [Vec3::new(-3.0, 0.2, -3.0), Vec3::new(3.0, 1.0, 3.0)];
    put(&mut builder, "fire", crate::common::media::boxed(min, max), fire);
    for (x, intensity) in [(1.0, 5.0f32), (-2.0, 3.0)] {
        let lamp = Spec::new("", "point").with("position", Vec3::new(x, 2.0, 1.0));
        builder.add_light(lamp.with("intensity", intensity));
    }
    look(&mut builder, Vec3::new(0.0, 4.0, 0.01), Vec3::ZERO, 1.0);
    let scene = built(&builder);
    let wanted =
        Rgb::from_array([0, 1, 2].map(|c| {
            emission[c] * (1.0 - bilux_math::transcendental::exp(-absorption[c] * (max.y - min.y)))
        }));
    for name in ["path", "bdpt", "vcm", "auto"] {
        let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(8, 8, 16) };
        let groups = parts(&scene, &Spec::new("", name), &settings).groups;
        for (group, film) in groups.iter().enumerate() {
            let mean = film.to_rgb().into_iter().sum::<Rgb>() * (1.0 / 64.0);
            let wanted = if group == 2 { wanted } else { Rgb::BLACK };
            let off = (0..3).map(|c| (mean[c] - wanted[c]).abs()).fold(0.0, f32::max);
            assert!(off < 0.03, "{name}, group {group}: {mean:?}, not {wanted:?}");
        }
    }
}
