//! Warnings before a picture is rendered: what is odd about it, even though it can be rendered.

mod sight;
mod textures;

use crate::preparation::presets::{Ground, Studio};
use bilux_math::transcendental::{asin, atan2};
use bilux_math::{Vec2, Vec3};
use bilux_scene::lights::surrounds;
use bilux_scene::{
    Camera, CameraSample, Mesh, Ray, Scene, SceneBuilder, SceneError, Span, Spec, Surface, Tracer, Warning,
};

/// Warnings about a scene: `given` is the scene before anything missing was added, `scene` is as the camera sees it.
pub(crate) fn oddities(given: &SceneBuilder, scene: &Scene, camera: &dyn Camera) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = of_boundaries(given, scene).into_iter().collect();
    warnings.extend(textures::beyond_range(given));
    let mut warn =
        |message: &str| warnings.push(Warning { message: message.to_owned(), at: Span::default() });
    camera.warnings().iter().for_each(|message| warn(message));
    if camera_is_inside_solid(scene, camera) {
        warn(
            "the camera is inside a transparent object and sees everything through it: move the camera out, unless \
             this is intended",
        );
    } else if sees_only_back_faces(given.objects.len() as u32, scene, camera) {
        let [azimuth, elevation] = from_behind(camera, scene.shutter()[0]);
        warn(&format!(
            "the camera sees only the back faces of single-sided surfaces (doubleSided is false in glTF), so it sees \
             nothing: look from the other side, for example with --orbit {azimuth},{elevation}",
        ));
    } else if sight::is_past_everything(given, scene, camera) {
        warn(sight::MESSAGE);
    } else if given.environment_unspecified && !given.cameras.is_empty() {
        // Authors of such files have rarely looked through the file's camera; scenes in other formats are made for
        // theirs.
        let share = visible_fraction(given.objects.len() as u32, scene, camera);
        if share < SPECK {
            warn(&format!(
                "the model fills only {:.2}% of the picture that the file's own camera takes: --orbit 26.5,17.8 uses \
                 the studio's camera, which frames the model",
                share * 100.0
            ));
        }
    }
    warnings
}

/// Media that scatter and have no inside.
fn of_boundaries(given: &SceneBuilder, scene: &Scene) -> Option<Warning> {
    let scatters = |index: u32| scene.material_of(index).medium().is_some_and(|medium| medium.scatters());
    let all = (0..).zip(&given.objects).filter(|(index, _)| scatters(*index));
    let mut wrong = all.map(|(_, object)| object).filter(|object| !object.mesh.has_inside());
    let first = wrong.next()?;
    let others = match wrong.count() {
        0 => String::new(),
        count => format!(" (and {count} more)"),
    };
    let name = &first.name;
    let message = if first.mesh.is_closed() {
        format!(
            "the faces of '{name}'{others} look inwards, so its medium, which scatters light, is outside of it: turn them"
        )
    } else {
        format!(
            "the mesh of '{name}'{others} is open, or some of its faces look inwards, but it is the boundary of a medium that \
             scatters light: rays do not notice there where the medium begins or ends; close it, or turn them"
        )
    };
    Some(Warning { message, at: Span::default() })
}

/// Warning about the ground that was asked for.
pub(crate) fn of_ground(studio: &Studio, has_ground: bool, has_backdrop: bool) -> Option<Warning> {
    let message = match studio.ground? {
        Ground::None => return None,
        _ if !has_ground => "--ground has no effect: the camera is below the ground and looks up",
        Ground::Mirror if studio.cut_out => {
            "--ground mirror is opaque and hides the background: use --ground shadow to keep it visible"
        }
        _ if has_backdrop => "the ground hides the picture behind the model: leave --ground out",
        _ => return None,
    };
    Some(Warning { message: message.to_owned(), at: Span::default() })
}

/// The kinds of light that are visible themselves, beside those that surround the scene.
const SEEN_LIGHTS: [&str; 2] = ["rect", "sphere"];

/// The kinds of cameras that measure the light that arrives.
const METERS: [&str; 1] = ["irradiance"];

/// Refuses a scene with nothing to see.
pub(crate) fn check_not_empty(scene: &SceneBuilder) -> Result<(), SceneError> {
    let is_seen = |light: &Spec| surrounds(&light.kind) || SEEN_LIGHTS.contains(&light.kind.as_str());
    let is_full = |mesh: &Mesh| !mesh.triangles.is_empty() || mesh.stroke_count() > 0;
    let has_shapes = scene.objects.iter().any(|object| is_full(&object.mesh));
    if scene.objects.iter().any(|object| shows_something(&object.mesh)) {
        return Ok(());
    }
    // A meter needs no surface to see.
    let has_meter = scene.cameras.iter().any(|camera| METERS.contains(&camera.spec.kind.as_str()));
    if has_meter && !has_shapes && !scene.lights.is_empty() {
        return Ok(());
    }
    let message = match (has_shapes, scene.lights.iter().any(is_seen)) {
        (true, _) => "nothing is visible: no triangle, point or line has finite coordinates",
        // An environment alone makes a picture, if the format has a way to say so.
        (false, true) if !scene.environment_unspecified => return Ok(()),
        (false, _) => {
            "the scene is empty: it has no triangles, points or lines to render; `bilux info` shows what the file holds"
        }
    };
    Err(SceneError::invalid(message, &Span::default()))
}

/// A model that fills less of the picture than this is a speck.
const SPECK: f32 = 0.003;

/// The fraction of a camera's picture that a scene's first objects fill.
fn visible_fraction(objects: u32, scene: &Scene, camera: &dyn Camera) -> f32 {
    const GRID: usize = 96;
    let mut tracer = Tracer::new(scene, false);
    let mut is_hit = |i: &usize| {
        let film = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
        let ray = camera.ray(&CameraSample { film, lens: Vec2::splat(0.5), time: scene.shutter()[0] });
        tracer.closest(&ray).is_some_and(|surface| surface.object < objects)
    };
    (0..GRID * GRID).filter(&mut is_hit).count() as f32 / (GRID * GRID) as f32
}

fn shows_something(mesh: &Mesh) -> bool {
    let is_finite = |&i: &u32| mesh.positions.get(i as usize).is_some_and(|p| p.is_finite());
    mesh.triangles.iter().any(|triangle| triangle.iter().all(is_finite))
        || mesh.points.iter().any(is_finite)
        || mesh.lines.iter().any(|line| line.iter().all(is_finite))
}

/// True if the camera would see some of a scene's first objects if it did not see through their backs.
fn sees_only_back_faces(objects: u32, scene: &Scene, camera: &dyn Camera) -> bool {
    const GRID: usize = 32;
    let mut tracer = Tracer::new(scene, false);
    let mut is_culled = false;
    for i in 0..GRID * GRID {
        let film = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
        let ray = camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: scene.shutter()[0] });
        let mut closest_surface = |ray: &Ray| tracer.closest(ray).filter(|surface| surface.object < objects);
        let Some(first) = closest_surface(&ray) else { continue };
        if !scene.camera_sees_through(&first, -Vec3::from(ray.direction))
            || closest_surface(&scene.from_camera(ray)).is_some()
        {
            return false;
        }
        is_culled = true;
    }
    is_culled
}

/// The orbit of the studio's camera that looks from the opposite side, in tenths of a degree: what shows its back to one shows
/// its front to the other.
fn from_behind(camera: &dyn Camera, time: f32) -> [f32; 2] {
    let middle = CameraSample { film: Vec2::splat(0.5), lens: Vec2::splat(0.5), time };
    let towards = -Vec3::from(camera.ray(&middle).direction).normalize();
    let azimuth = atan2(towards.x, towards.z).to_degrees() + 180.0;
    let elevation = -asin(towards.y.clamp(-1.0, 1.0)).to_degrees();
    [azimuth, elevation].map(|angle| (angle * 10.0).round() / 10.0 + 0.0)
}

/// Directions whose rays hit no wall of an ordinary room at an edge.
const AROUND: [Vec3; 6] = [
    Vec3::new(0.91, 0.11, 0.4),
    Vec3::new(-0.93, -0.13, 0.34),
    Vec3::new(0.21, 0.92, -0.33),
    Vec3::new(-0.17, -0.94, -0.3),
    Vec3::new(0.31, -0.23, 0.92),
    Vec3::new(-0.37, 0.19, -0.91),
];

/// True if the rays in all these directions leave some transparent solid once more than they enter it.
fn camera_is_inside_solid(scene: &Scene, camera: &dyn Camera) -> bool {
    let sample = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: scene.shutter()[0] };
    let eye = camera.ray(&sample);
    let inside_of = |direction: &Vec3| solids_around(scene, Ray { direction: direction.to_array(), ..eye });
    let mut around = inside_of(&AROUND[0]);
    for direction in &AROUND[1..] {
        if around.is_empty() {
            return false;
        }
        let also = inside_of(direction);
        around.retain(|object| also.contains(object));
    }
    !around.is_empty()
}

/// The maximum number of surfaces that a ray is followed through; solids behind more surfaces are not looked for.
const MAX_SURFACES: usize = 256;

/// Transparent objects that a ray leaves more often than it enters.
fn solids_around(scene: &Scene, mut ray: Ray) -> Vec<u32> {
    let mut tracer = Tracer::new(scene, false);
    let mut left: Vec<(u32, i32)> = Vec::new();
    for _ in 0..MAX_SURFACES {
        let Some(surface) = tracer.closest(&ray) else { break };
        let direction = Vec3::from(ray.direction);
        if is_solid_glass(scene, &surface) {
            let step = if surface.n_geom.dot(direction) > 0.0 { 1 } else { -1 };
            match left.iter_mut().find(|(object, _)| *object == surface.object) {
                Some((_, count)) => *count += step,
                None => left.push((surface.object, step)),
            }
        }
        ray = surface.spawn(direction);
    }
    left.into_iter().filter(|(_, count)| *count > 0).map(|(object, _)| object).collect()
}

/// Fog is meant to be around cameras.
fn is_solid_glass(scene: &Scene, surface: &Surface) -> bool {
    let material = scene.material(surface);
    let classic = material.classic(surface);
    !classic.kt.is_black() && !classic.thin && !material.is_interface()
}

#[cfg(test)]
mod tests {
    use crate::Job;
    use bilux_math::Vec3;
    use bilux_scene::cameras::CameraSpec;
    use bilux_scene::{LIGHTS, Mesh, Object, Parameters, SceneBuilder, Spec, Value, mesh::shapes};
    use std::sync::Arc;

    /// The warnings for a camera at this position, with a ball of this material at the origin.
    fn reported(material: Spec, position: [f32; 3]) -> Vec<String> {
        let mut scene = SceneBuilder::default();
        let material = scene.add_material(material);
        scene.objects.push(Object::new("ball", Arc::new(shapes::icosphere(Vec3::ZERO, 1.0, 3)), material));
        let camera = Spec::new("", "perspective").with("position", Value::triple(position));
        let camera = camera.with("look_at", Value::triple([0.0, 0.1, 9.0]));
        scene.cameras.push(CameraSpec { spec: camera, ..CameraSpec::default() });
        let job = Job::new(&scene, &Parameters::default()).unwrap();
        job.warnings().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_camera_that_sees_only_back_faces_gets_a_warning() {
        let shell = || Spec::new("shell", "diffuse").with("visible_sides", "front");
        assert!(reported(shell(), [0.1, 0.2, 0.0])[0].contains("single-sided"));
        assert!(reported(shell(), [0.0, 0.0, -3.0]).is_empty(), "outside");
        assert!(reported(Spec::new("clay", "diffuse"), [0.1, 0.2, 0.0]).is_empty(), "both sides");
    }

    /// A light that is seen makes a picture without any surface: a panel, a ball, an environment, and every kind of sky.
    #[test]
    fn lights_that_are_seen_need_no_surface() {
        for row in LIGHTS {
            let kind = row.entry.name;
            let mut spec = Spec::new("it", kind);
            if ["rect", "sphere"].contains(&kind) {
                spec = spec.with("intensity", 3.0f32);
            }
            let scene = SceneBuilder { lights: vec![spec], ..SceneBuilder::default() };
            let is_seen = ["rect", "sphere", "environment", "sky", "cie-sky", "perez-sky"].contains(&kind);
            assert_eq!(Job::new(&scene, &Parameters::default()).is_ok(), is_seen, "{kind}");
        }
    }

    #[test]
    fn media_in_open_meshes_and_outside_of_their_own_are_named() {
        let reported = |change: fn(&mut Mesh), material: Spec| {
            let (mut scene, mut ball) = (SceneBuilder::default(), shapes::icosphere(Vec3::ZERO, 1.0, 2));
            change(&mut ball);
            let material = scene.add_material(material);
            scene.objects.push(Object::new("ball", Arc::new(ball), material));
            let job = Job::new(&scene, &Parameters::default()).unwrap();
            job.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("")
        };
        let milk = || Spec::new("milk", "dielectric").with("scattering", 3.0);
        let fog = || Spec::new("fog", "interface").with("scattering", 3.0);
        let open: fn(&mut Mesh) = |mesh| mesh.triangles.truncate(mesh.triangles.len() - 1);
        for medium in [milk, fog] {
            assert_eq!(reported(|_| {}, medium()), "");
            assert!(reported(open, medium()).contains("'ball' is open"));
            let turned = reported(|mesh| mesh.triangles.iter_mut().for_each(|t| t.reverse()), medium());
            assert!(turned.contains("look inwards"), "{turned}");
        }
        assert_eq!(reported(open, Spec::new("glass", "dielectric")), "");
    }

    #[test]
    fn the_advice_to_look_from_the_other_side_works() {
        let side = |at: [f32; 3]| Vec3::from(at);
        // A card that faces away from the studio's camera, one that faces the ground, and one that faces the sky.
        for corners in [
            [side([0.0, 0.0, 0.0]), side([0.0, 1.0, 0.0]), side([1.0, 0.0, 0.0])],
            [side([0.0, 0.0, 0.0]), side([1.0, 0.0, 0.0]), side([0.0, 0.0, 1.0])],
            [side([0.0, 0.0, 0.0]), side([0.0, 0.0, 1.0]), side([1.0, 0.0, 0.0])],
        ] {
            let mut scene = SceneBuilder::default();
            let card = scene.add_material(Spec::new("card", "diffuse").with("visible_sides", "front"));
            let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            scene.objects.push(Object::new("card", Arc::new(mesh), card));
            let warnings = |orbit: &str| {
                let mut user = Parameters::default();
                user.set("orbit", Value::from(orbit));
                // Otherwise `auto` would turn the cards round, and the ground would hide one that lies on it.
                for (key, value) in [("up", "y"), ("front", "z"), ("ground", "none")] {
                    user.set(key, value);
                }
                let job = Job::new(&scene, &user).unwrap();
                job.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("")
            };
            let blind = ["26.5,17.8", "10,80", "10,-80"].map(warnings).join("");
            let advice = blind
                .split("--orbit ")
                .nth(1)
                .unwrap_or_else(|| panic!("one of them sees its back: {corners:?}: {blind}"))
                .trim();
            let advice = advice.split(|c: char| !"0123456789.,-".contains(c)).next().unwrap();
            assert_eq!(warnings(advice), "", "--orbit {advice}");
        }
    }

    /// The side of a card that faces +x is seen from there, wherever a moving camera that sees its back was at first.
    #[test]
    fn the_other_side_of_a_moving_camera_is_that_of_the_moment() {
        let mut scene = SceneBuilder::default();
        let card = scene.add_material(Spec::new("card", "diffuse").with("visible_sides", "front"));
        let corners = [Vec3::ZERO, Vec3::Y, Vec3::Z].map(|corner| 2.0 * corner - Vec3::new(0.0, 0.6, 0.6));
        let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
        scene.objects.push(Object::new("card", Arc::new(mesh), card));
        let at = |x: f32, z: f32| Spec::new("", "perspective").with("position", Vec3::new(x, 0.0, z));
        let keyframes = [(0.0, at(-1.0, 6.0)), (2.0, at(-6.0, 0.0))].map(|(time, at)| (time, at.parameters));
        let spec = at(-1.0, 6.0).with("look_at", Vec3::ZERO);
        scene.cameras.push(CameraSpec { spec, keyframes: keyframes.into() });
        let mut user = Parameters::default();
        user.set("time", 2.0f32);
        let job = Job::new(&scene, &user).unwrap();
        let said = job.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert!(said.ends_with("for example with --orbit 90,0"), "{said}");
    }

    #[test]
    fn a_speck_in_the_camera_of_a_gltf_is_reported_with_the_way_to_the_studio() {
        let warnings = |distance: f32, unsaid: bool| {
            let mut scene = SceneBuilder { environment_unspecified: unsaid, ..SceneBuilder::default() };
            let clay = scene.add_material(Spec::new("", "diffuse"));
            scene.objects.push(Object::new("ball", Arc::new(shapes::icosphere(Vec3::ZERO, 1.0, 3)), clay));
            let camera = Spec::new("", "perspective").with("position", Value::triple([0.0, 0.0, distance]));
            let camera = camera.with("look_at", Value::triple([0.0, 0.0, 0.0]));
            scene.cameras.push(CameraSpec { spec: camera, ..CameraSpec::default() });
            let job = Job::new(&scene, &Parameters::default()).unwrap();
            job.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
        };
        assert!(warnings(100.0, true).contains("--orbit 26.5,17.8"), "{}", warnings(100.0, true));
        assert_eq!(warnings(10.0, true), "");
        assert_eq!(warnings(100.0, false), "", "whoever writes a scene means what it shows");
    }

    #[test]
    fn only_a_camera_inside_glass_gets_the_warning() {
        let glass = || Spec::new("glass", "dielectric");
        assert!(reported(glass(), [0.1, 0.2, 0.0])[0].contains("inside a transparent object"));
        assert!(reported(glass(), [0.0, 0.0, -3.0]).is_empty(), "outside");
        assert!(reported(Spec::new("clay", "diffuse"), [0.1, 0.2, 0.0]).is_empty(), "a room");
    }

    /// The warnings for a ball in the studio, with these settings.
    fn warnings_of_ground(settings: &[(&str, &str)], lights: Vec<Spec>) -> String {
        let mut scene = SceneBuilder { environment_unspecified: true, lights, ..SceneBuilder::default() };
        let clay = scene.add_material(Spec::new("", "diffuse"));
        scene.objects.push(Object::new("ball", Arc::new(shapes::icosphere(Vec3::ZERO, 1.0, 3)), clay));
        let mut user = Parameters::default();
        settings.iter().for_each(|(key, value)| user.set(key, *value));
        let job = Job::new(&scene, &user).unwrap();
        job.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_ground_that_is_seen_from_below_is_left_out_with_a_warning() {
        for ground in ["shadow", "mirror"] {
            let from = |orbit| warnings_of_ground(&[("ground", ground), ("orbit", orbit)], Vec::new());
            assert!(from("30,-20").contains("--ground has no effect"), "{ground}");
            assert_eq!(from("30,20"), "", "{ground}, from above");
        }
        assert_eq!(warnings_of_ground(&[("ground", "none"), ("orbit", "30,-20")], Vec::new()), "");
        assert_eq!(warnings_of_ground(&[("orbit", "30,-20")], Vec::new()), "", "nobody asked for a ground");
    }

    #[test]
    fn a_ground_that_hides_the_background_gets_a_warning() {
        let transparent =
            |ground| warnings_of_ground(&[("ground", ground), ("background", "transparent")], Vec::new());
        assert!(transparent("mirror").contains("use --ground shadow"));
        assert_eq!(transparent("shadow"), "");
        let picture = || {
            let light = Spec::new("", "environment").with("radiance", 0.5f32);
            vec![light.with("backdrop", true), Spec::new("", "environment")]
        };
        assert!(warnings_of_ground(&[("ground", "mirror")], picture()).contains("leave --ground out"));
        assert_eq!(warnings_of_ground(&[], picture()), "");
    }
}
