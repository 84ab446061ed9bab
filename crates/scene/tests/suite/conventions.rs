//! Conventions that both ends of a path share, so that no comparison of two of our own images can detect an error in
//! them. Each is tested against an external number, a definition, or a closed form written here independently in f64.

use bilux_math::glam::DQuat;
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::{acos_f64, atan2_f64, cos_f64, sin_cos_f64, sin_f64};
use bilux_math::{DMat4, DVec3, Rgb, Transform, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes::uv_sphere;
use bilux_scene::{
    AccelChoice, CameraSample, Light, Mesh, Object, Ray, Scene, SceneBuilder, Spec, Surface, Texture, Tracer,
    TransportMode, Value,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

fn built(builder: &SceneBuilder) -> Scene {
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

fn light_of(builder: &SceneBuilder) -> Arc<dyn Light> {
    built(builder).lights()[0].light.clone()
}

fn with_light(spec: Spec) -> Arc<dyn Light> {
    light_of(&SceneBuilder { lights: vec![spec], ..SceneBuilder::default() })
}

/// An environment map of eight by four texels, whose red channel numbers them.
fn numbered_sky(rotation: f32) -> Arc<dyn Light> {
    let texels = (0..32).map(|i| Rgb::new((i + 1) as f32, (i % 8) as f32, (i / 8) as f32)).collect();
    let mut builder = SceneBuilder::default();
    builder.textures.push(Arc::new(Texture::new("", 8, 4, texels, false)));
    let spec = Spec::new("", "environment").with("radiance", Value::Texture(0));
    builder.lights.push(spec.with("rotation", rotation));
    light_of(&builder)
}

/// The direction of the texel coordinates `x`, `y` of an eight by four map: its centre is towards -z, its right half
/// towards +x, and its upper edge is straight up.
fn towards(x: f64, y: f64) -> Vec3 {
    let ((sin, cos), (r, up)) = (sin_cos_f64(TAU * (x / 8.0 - 0.5)), sin_cos_f64(PI * y / 4.0));
    DVec3::new(r * sin, up, -r * cos).as_vec3()
}

#[test]
fn environment_texels_are_centred_and_interpolated_bilinearly() {
    let sky = numbered_sky(0.0);
    for (x, y) in (0..4).flat_map(|y| (0..8).map(move |x| (x, y))) {
        let found = sky.le(towards(f64::from(x) + 0.5, f64::from(y) + 0.5));
        assert!((found.r - (8 * y + x + 1) as f32).abs() < 1e-3, "texel {x}, {y}: {found:?}");
    }
    for x in 0..7 {
        let between = sky.le(towards(f64::from(x) + 1.0, 1.5)).g;
        assert!((between - (x as f32 + 0.5)).abs() < 1e-3, "between {x} and the next: {between}");
    }
    for y in 0..3 {
        let between = sky.le(towards(3.5, f64::from(y) + 1.0)).b;
        assert!((between - (y as f32 + 0.5)).abs() < 1e-3, "between row {y} and the next: {between}");
    }
    // The map closes behind the viewer: its first and last columns are neighbours.
    assert!((sky.le(towards(0.0, 1.5)).g - 3.5).abs() < 1e-3);
}

#[test]
fn environment_rotation_turns_to_the_right() {
    // The texel that was straight ahead now appears 45 degrees further to the right: towards +x.
    let (plain, turned) = (numbered_sky(0.0), numbered_sky(45.0));
    let ahead = plain.le(towards(3.5, 1.5));
    assert!((turned.le(towards(4.5, 1.5)) - ahead).map(f32::abs).max_channel() < 1e-3);
    assert!(towards(4.5, 2.0).x > 0.3 && towards(4.5, 2.0).z < -0.9);
}

#[test]
fn the_sky_puts_its_sun_at_the_given_elevation_and_azimuth() {
    // 30 degrees above the horizon, 90 degrees to the right of -z: towards +x.
    let spec = Spec::new("", "sky").with("elevation", 30.0f32).with("azimuth", 90.0f32);
    let scene = built(&SceneBuilder { lights: vec![spec], ..SceneBuilder::default() });
    let sun = &scene.lights()[1].light;
    let wanted = DVec3::new(cos_f64(PI / 6.0), 0.5, 0.0).as_vec3();
    assert!(!sun.le(wanted).is_black() && sun.le(wanted.with_x(-wanted.x)).is_black());
    // The sky itself is brightest around it.
    let sky = &scene.lights()[0].light;
    let beside = |azimuth: f64| {
        let (sin, cos) = sin_cos_f64(azimuth);
        sky.le(DVec3::new(cos_f64(0.7) * sin, sin_f64(0.7), -cos_f64(0.7) * cos).as_vec3()).luminance()
    };
    assert!(beside(FRAC_PI_2) > 1.5 * beside(0.0) && beside(FRAC_PI_2) > 1.5 * beside(-FRAC_PI_2));
}

/// The ground below a sky reflects what it receives of the sky and of the sun, as level paper of its albedo: nothing of a sun below the horizon, but
/// not less than nothing.
#[test]
fn the_ground_below_a_sky_is_lit_by_the_sun_only_above_the_horizon() {
    for (kind, sky, sun) in [("cie-sky", "irradiance", "sun"), ("perez-sky", "diffuse", "direct")] {
        for (degrees, sine) in [(30.0f32, 0.5), (0.0, 0.0), (-30.0, 0.0)] {
            let spec = Spec::new("", kind).with("elevation", degrees).with("ground", 0.3f32);
            let spec = spec.with(sky, Rgb::new(2.0, 3.0, 4.0)).with(sun, Rgb::new(7.0, 5.0, 6.0));
            let scene = built(&SceneBuilder { lights: vec![spec], ..SceneBuilder::default() });
            let ground = scene.lights()[0].light.le(Vec3::new(0.3, -0.9, 0.2).normalize()).to_array();
            for (channel, (sky, sun)) in [(2.0, 7.0), (3.0, 5.0), (4.0, 6.0)].into_iter().enumerate() {
                let (found, wanted) = (f64::from(ground[channel]), 0.3 * (sky + sine * sun) / PI);
                assert!((found / wanted - 1.0).abs() < 1e-4, "{kind}, {degrees}: {found}, not {wanted}");
            }
        }
    }
}

/// The maximum angle from `towards` at which a light shines, by bisection, in radians.
fn edge(light: &dyn Light, towards: DVec3, most: f64) -> f64 {
    let across = towards.any_orthonormal_vector();
    let shines = |angle: f64| {
        let (sin, cos) = sin_cos_f64(angle);
        !light.le((towards * cos + across * sin).as_vec3()).is_black()
    };
    let (mut inside, mut outside) = (0.0, most);
    assert!(shines(inside) && !shines(outside));
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if shines(middle) { inside = middle } else { outside = middle }
    }
    inside
}

#[test]
fn the_suns_edge_is_half_its_diameter_from_its_middle() {
    let towards = DVec3::new(1.0, 2.0, 0.5).normalize();
    for degrees in [0.533f64, 5.0, 60.0] {
        let spec = Spec::new("", "directional").with("direction", (-towards).as_vec3());
        let spec = spec.with("diameter", degrees as f32).with("irradiance", 2.0f32);
        let sun = with_light(spec);
        let (wanted, found) = (0.5 * degrees.to_radians(), edge(&*sun, towards, PI));
        assert!(
            (found / wanted - 1.0).abs() < 1e-3,
            "{degrees} degrees: the edge is at {found}, not {wanted}"
        );
        // Samples fill the disc uniformly up to its edge: half of them lie within the angle of half of the cap's
        // height.
        let angle = |i: u32| {
            let u = Vec2::new((f64::from(i) + 0.5) as f32 / 4096.0, 0.5 + 0.4 * (i % 2) as f32);
            let wi = sun.sample_li(Vec3::ZERO, 0.0, u).unwrap().wi.as_dvec3().normalize();
            (wi - towards).length()
        };
        let mut chords: Vec<f64> = (0..4096).map(angle).collect();
        chords.sort_by(f64::total_cmp);
        let rim = 2.0 * sin_f64(0.5 * wanted);
        assert!((chords[4095] / rim - 1.0).abs() < 2e-3, "{degrees}: {} and {rim}", chords[4095]);
        assert!((chords[2048] / (rim * 0.5f64.sqrt()) - 1.0).abs() < 2e-3, "{degrees}");
        // A surface that faces it receives the specified irradiance: E = π L sin²(diameter / 2).
        let radiance = f64::from(sun.le(towards.as_vec3()).g);
        let irradiance = PI * radiance * sin_f64(wanted) * sin_f64(wanted);
        assert!((irradiance / 2.0 - 1.0).abs() < 1e-4, "{degrees}: {irradiance}");
    }
    let spec = Spec::new("", "sky").with("elevation", 90.0f32).with("sun_diameter", 4.0f32);
    let scene = built(&SceneBuilder { lights: vec![spec], ..SceneBuilder::default() });
    let found = edge(&*scene.lights()[1].light, DVec3::Y, 1.0);
    assert!((found / 2f64.to_radians() - 1.0).abs() < 1e-3, "{found}");
}

#[test]
fn a_spot_falls_off_smoothly_between_the_cosines_of_its_angles() {
    // The smoothstep of pbrt's book, 12.2.2, a choice that glTF leaves to the renderer: at a quarter, half and three
    // quarters of the way between the cosines it is 5/32, 1/2 and 27/32.
    let (outer, inner) = (50f64.to_radians(), 20f64.to_radians());
    let spot = Spec::new("", "spot").with("position", Vec3::Y * 3.0).with("look_at", Vec3::ZERO);
    let spot = spot.with("intensity", 7.0f32).with("angle", 50.0f32).with("inner_angle", 20.0f32);
    let light = with_light(spot);
    let between = |part: f64| acos_f64(cos_f64(outer) + part * (cos_f64(inner) - cos_f64(outer)));
    let cases = [
        (0.0, 1.0),
        (19.9f64.to_radians(), 1.0),
        (between(0.75), 27.0 / 32.0),
        (between(0.5), 0.5),
        (between(0.25), 5.0 / 32.0),
        (50.1f64.to_radians(), 0.0),
    ];
    for (angle, wanted) in cases {
        // Two metres away, a quarter of the intensity arrives.
        let (sin, cos) = sin_cos_f64(angle);
        let from = DVec3::new(2.0 * sin, 3.0 - 2.0 * cos, 0.0).as_vec3();
        let found = light.sample_li(from, 0.0, Vec2::ZERO).map_or(0.0, |sample| f64::from(sample.li.g));
        assert!((found - wanted * 7.0 / 4.0).abs() < 1e-4, "{} degrees: {found}", angle.to_degrees());
    }
}

/// From afar every light of intensity I looks like a point: E = I / d² on a surface that faces it, whatever its size.
#[test]
fn far_irradiance_is_intensity_over_distance_squared() {
    let light_spec = |kind: &str| Spec::new("", kind).with("position", Vec3::ZERO).with("intensity", 8.0f32);
    let panel = light_spec("rect").with("edge_u", Vec3::X * 0.5).with("edge_v", Vec3::Z * 0.3);
    for spec in [
        light_spec("point"),
        light_spec("spot").with("look_at", -Vec3::Y),
        light_spec("sphere").with("radius", 0.2f32),
        panel,
    ] {
        let kind = spec.kind.clone();
        let light = with_light(spec);
        let from = Vec3::new(0.0, -40.0, 0.0);
        let at = |i: u32| {
            let u = Vec2::new(((i % 16) as f32 + 0.5) / 16.0, ((i / 16) as f32 + 0.5) / 16.0);
            light.sample_li(from, 0.0, u).map_or(0.0, |s| s.li.g * s.wi.y / s.pdf_solid_angle)
        };
        let irradiance = (0..256).map(at).sum::<f32>() / 256.0;
        assert!((irradiance / (8.0 / 1600.0) - 1.0).abs() < 2e-3, "{kind}: {irradiance}");
    }
}

fn camera_rays(spec: Spec, aspect: f32) -> impl Fn(f32, f32) -> (Vec3, Vec3) {
    let spec = spec.with("position", Vec3::new(0.0, 0.0, 5.0)).with("look_at", Vec3::ZERO);
    let builder =
        SceneBuilder { cameras: vec![CameraSpec { spec, keyframes: Vec::new() }], ..SceneBuilder::default() };
    let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], aspect).unwrap();
    move |x: f32, y: f32| {
        let sample = CameraSample { film: Vec2::new(x, y), lens: Vec2::ZERO, time: 0.0 };
        let ray = scene.cameras()[0].1.ray(&sample);
        (ray.origin.into(), ray.direction.into())
    }
}

#[test]
fn the_field_of_view_is_vertical_and_row_zero_is_at_the_top() {
    // Twice as wide as high: 60 degrees from the lower to the upper edge.
    let ray = camera_rays(Spec::new("", "perspective").with("fov", 60.0f32), 2.0);
    let half = 1.0 / 3f32.sqrt();
    for (x, y, wanted) in [
        (0.5, 0.0, Vec3::new(0.0, half, -1.0)),
        (0.5, 1.0, Vec3::new(0.0, -half, -1.0)),
        (1.0, 0.5, Vec3::new(2.0 * half, 0.0, -1.0)),
        (0.0, 0.0, Vec3::new(-2.0 * half, half, -1.0)),
    ] {
        let (_, direction) = ray(x, y);
        assert!((direction - wanted.normalize()).length() < 1e-5, "{x}, {y}: {direction}");
    }
    let ray = camera_rays(Spec::new("", "orthographic").with("height", 3.0f32), 2.0);
    for (x, y, wanted) in [(0.5, 0.0, Vec3::new(0.0, 1.5, 5.0)), (1.0, 1.0, Vec3::new(3.0, -1.5, 5.0))] {
        let (origin, direction) = ray(x, y);
        assert!((origin - wanted).length() < 1e-5 && direction == -Vec3::Z, "{x}, {y}: {origin} {direction}");
    }
    let mirrored = camera_rays(Spec::new("", "perspective").with("fov", 60.0f32).with("mirrored", true), 2.0);
    assert!(mirrored(1.0, 0.5).1.x < -0.5 && mirrored(0.5, 0.0).1.y > 0.4);
}

#[test]
fn transmission_color_is_reached_at_transmission_depth() {
    // After two metres a half, a quarter and all of the light remain, by Beer's law.
    let spec =
        Spec::new("", "principled").with("transmission_weight", 1.0f32).with("transmission_depth", 2.0f32);
    let spec = spec.with("transmission_color", Rgb::new(0.5, 0.25, 1.0));
    let (scene, surface) = brushed(spec, UPRIGHT, DMat4::IDENTITY);
    let sigma = scene.material(&surface).medium().unwrap().sigma_a;
    let ln_2 = std::f32::consts::LN_2;
    for (found, wanted) in sigma.to_array().into_iter().zip([ln_2 / 2.0, ln_2, 0.0]) {
        assert!((found - wanted).abs() < 1e-5, "{sigma:?}");
    }
}

/// A smaller error than tessellation causes: the angle between the normals of neighbouring vertices.
const COARSE: f64 = 0.01;

/// A sphere of radius 1 with normals.
fn sphere() -> Mesh {
    uv_sphere(Vec3::ZERO, 1.0, 128, 64)
}

fn scale() -> DVec3 {
    DVec3::new(1.0, 2.0, 0.5)
}

fn turn() -> DQuat {
    DQuat::from_euler(bilux_math::glam::EulerRot::XYZ, 0.5, -0.8, 0.3)
}

/// Traces rays at an ellipsoid, the unit sphere scaled, rotated and translated, and returns the maximum angles of
/// shading and geometric normals to the gradient of x²/a² + y²/b² + z²/c².
fn worst_normals(scene: &Scene, scale: DVec3, turn: DQuat, middle: DVec3) -> [f64; 2] {
    let (mut tracer, mut worst, mut hits) = (Tracer::new(scene, false), [0.0f64; 2], 0);
    for i in 0..400 {
        let (up, (sin, cos)) = (1.0 - (f64::from(i) + 0.5) / 200.0, sin_cos_f64(2.4 * f64::from(i)));
        let r = (1.0 - up * up).sqrt();
        let out = DVec3::new(r * cos, up, r * sin);
        let from = middle + out * 5.0;
        let ray = Ray::new(from.as_vec3().to_array(), (-out).as_vec3().to_array());
        let Some(surface) = tracer.closest(&ray) else { continue };
        hits += 1;
        let local = turn.inverse() * (surface.p.as_dvec3() - middle);
        let wanted = (turn * (local / (scale * scale))).normalize();
        let apart = |n: Vec3| (n.as_dvec3() - wanted).length();
        worst = [worst[0].max(apart(surface.n_shade)), worst[1].max(apart(surface.n_geom))];
    }
    assert_eq!(hits, 400);
    worst
}

#[test]
fn normals_are_correct_under_non_uniform_scale() {
    let middle = DVec3::new(0.3, -0.2, 0.1);
    let mirrored = DVec3::new(-1.0, 1.0, 1.0);
    for (name, scale) in [("scaled", scale()), ("mirrored", scale() * mirrored)] {
        let matrix = DMat4::from_scale_rotation_translation(scale, turn(), middle);
        let still = Object::new("", Arc::new(sphere()), 0).placed(Transform::from_matrix(matrix).unwrap());
        let key = |time_seconds: f32, aside: f64| MotionKey {
            time_seconds,
            translation: (middle + DVec3::X * aside).as_vec3(),
            rotation: turn().as_quat(),
            scale: scale.as_vec3(),
        };
        let moving = Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 3.0)]).unwrap();
        let places = [
            ("in the common tree", still.clone()),
            ("in its own tree", Object { instanced: true, ..still.clone() }),
            ("moving", Object { motion: moving, ..still.clone() }),
        ];
        for (place, object) in places {
            let mut builder = SceneBuilder::default();
            builder.add_material(Spec::new("", "diffuse"));
            builder.objects.push(object);
            let [shading, own] = worst_normals(&built(&builder), scale, turn(), middle);
            assert!(shading < COARSE, "{name}, {place}: shading normals are off by {shading}");
            assert!(own < 0.15, "{name}, {place}: triangles' normals are off by {own}");
        }
    }
}

/// A brushed silver square towards +z with texture coordinates, and the hit of a ray from straight above.
fn brushed(material: Spec, uvs: [Vec2; 4], transform: DMat4) -> (Scene, Surface) {
    let mut builder = SceneBuilder::default();
    let material = builder.add_material(material);
    let mesh = Mesh {
        positions: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec(),
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let transform = Transform::from_matrix(transform).unwrap();
    builder.objects.push(Object::new("", Arc::new(mesh), material).placed(transform));
    let scene = built(&builder);
    let surface = Tracer::new(&scene, false).closest(&Ray::new([0.1, 0.2, 5.0], [0.0, 0.0, -1.0])).unwrap();
    (scene, surface)
}

/// The light reflected from a quarter of a radian off the normal, by the azimuth from +x to +y.
fn highlight(scene: &Scene, surface: &Surface, angle: f64) -> f64 {
    let ((sin, cos), (aside, up)) = (sin_cos_f64(angle), sin_cos_f64(0.25));
    let wi = DVec3::new(aside * cos, aside * sin, up).as_vec3();
    let bsdf = scene.material(surface).bsdf(surface);
    f64::from(bsdf.eval(Vec3::Z, wi, TransportMode::Radiance).g)
}

/// The azimuth at which a highlight is longest, 0..π.
fn direction_of_highlight(scene: &Scene, surface: &Surface) -> f64 {
    // The phase of the second harmonic: the light is the same in opposite directions.
    let mut sum = [0.0; 2];
    for i in 0..360 {
        let angle = TAU * f64::from(i) / 360.0;
        let ((sin, cos), light) = (sin_cos_f64(2.0 * angle), highlight(scene, surface, angle));
        sum = [sum[0] + cos * light, sum[1] + sin * light];
    }
    (0.5 * atan2_f64(sum[1], sum[0])).rem_euclid(PI)
}

const UPRIGHT: [Vec2; 4] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];

#[test]
fn a_brushed_highlight_extends_across_the_brushing() {
    let kinds = [
        ("conductor", "rotation", 360.0f32, &["roughness", "anisotropy"]),
        ("principled", "anisotropy_rotation", 1.0, &["specular_roughness", "specular_roughness_anisotropy"]),
    ];
    for (kind, rotation, turn, [roughness, anisotropy]) in kinds {
        let metal = Spec::new("", kind).with(roughness, 0.4f32).with(anisotropy, 0.7f32);
        let metal = if kind == "principled" { metal.with("base_metalness", 1.0f32) } else { metal };
        // If the brushing is rotated by 30 degrees from u towards v, it is at 30 degrees, and the highlight at 120.
        for degrees in [0.0f64, 30.0] {
            let spec = metal.clone().with(rotation, (degrees / 360.0) as f32 * turn);
            let (scene, surface) = brushed(spec, UPRIGHT, DMat4::IDENTITY);
            let found = direction_of_highlight(&scene, &surface).to_degrees();
            assert!((found - degrees - 90.0).abs() < 0.5, "{kind} turned by {degrees}: {found}");
        }
        // u along +y: the brushing is vertical, and the highlight horizontal.
        let sideways = UPRIGHT.map(|uv| Vec2::new(uv.y, -uv.x));
        let (scene, surface) = brushed(metal.clone(), sideways, DMat4::IDENTITY);
        let found = direction_of_highlight(&scene, &surface).to_degrees();
        assert!(found.min(180.0 - found) < 0.5, "{kind} with u upwards: {found}");
        // u to the left: 30 degrees from there towards v is 150, and perpendicular to that is 60.
        let mirrored = UPRIGHT.map(|uv| Vec2::new(1.0 - uv.x, uv.y));
        let spec = metal.clone().with(rotation, turn / 12.0);
        let (scene, surface) = brushed(spec, mirrored, DMat4::IDENTITY);
        let found = direction_of_highlight(&scene, &surface).to_degrees();
        assert!((found - 60.0).abs() < 0.5, "{kind} with u to the left: {found}");
        // The brushing rotates with its surface.
        let (scene, surface) = brushed(metal, UPRIGHT, DMat4::from_rotation_z(0.5));
        let found = direction_of_highlight(&scene, &surface);
        assert!((found - 0.5 - FRAC_PI_2).abs() < 0.01, "{kind} on a turned surface: {found}");
    }
}

/// A rough metal seen at normal incidence, by the definition of anisotropic GGX. [Walter 2007; Heitz 2014]
fn ggx(alpha: [f64; 2], wi: DVec3) -> f64 {
    let h = (wi + DVec3::Z).normalize();
    let sum = h.x * h.x / (alpha[0] * alpha[0]) + h.y * h.y / (alpha[1] * alpha[1]) + h.z * h.z;
    let d = 1.0 / (PI * alpha[0] * alpha[1] * sum * sum);
    let (tilt_x, tilt_y) = (alpha[0] * wi.x, alpha[1] * wi.y);
    let tilt = tilt_x * tilt_x + tilt_y * tilt_y;
    let lambda = 0.5 * ((1.0 + tilt / (wi.z * wi.z)).sqrt() - 1.0);
    d / (1.0 + lambda) / 4.0
}

#[test]
fn a_brushed_metal_is_as_wide_as_openpbr_says() {
    // α = r² √(2 / (1 + (1 - a)²)) along the highlight, and (1 - a) times that across it. [OpenPBR 1.1]
    let (roughness, anisotropy) = (0.5f64, 0.6f64);
    let narrowed = 1.0 - anisotropy;
    let wide = roughness * roughness * (2.0 / (1.0 + narrowed * narrowed)).sqrt();
    let spec = Spec::new("", "conductor").with("reflectance", 0.999f32).with("roughness", roughness as f32);
    let (scene, surface) = brushed(spec.with("anisotropy", anisotropy as f32), UPRIGHT, DMat4::IDENTITY);
    let at = |angle: f64| {
        let ((sin, cos), (aside, up)) = (sin_cos_f64(angle), sin_cos_f64(0.25));
        ggx([narrowed * wide, wide], DVec3::new(aside * cos, aside * sin, up))
    };
    for (a, b) in [(0.0, FRAC_PI_2), (0.3, FRAC_PI_2), (0.0, 1.2)] {
        let found = highlight(&scene, &surface, a) / highlight(&scene, &surface, b);
        // Multiple scattering between microfacets is left out here: a few thousandths.
        assert!((found / (at(a) / at(b)) - 1.0).abs() < 0.02, "{a} and {b}: {found}, not {}", at(a) / at(b));
    }
    assert!(at(0.0) < 0.5 * at(FRAC_PI_2));
}
