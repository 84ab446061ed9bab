//! Every registered camera keeps its contract, and every check can fail.

use bilux_math::{DVec2, DVec3, Vec2, Vec3};
use bilux_scene::cameras::{CameraSpec, build};
use bilux_scene::{
    CAMERAS, Camera, CameraConnection, CameraMatrices, CameraSample, Parameters, Ray, Span, Spec, Value,
};
use bilux_validation::camera_contract::CHECKS;
use std::sync::Arc;

fn spec(kind: &str) -> Spec {
    Spec::new("", kind).with("position", Vec3::new(1.0, 2.0, 4.0)).with("look_at", Vec3::new(0.2, 0.5, -0.5))
}

fn shifted(spec: Spec) -> Spec {
    let spec = spec.with("principal_x", 0.4f32).with("principal_y", 0.55f32).with("shift_x", 0.1f32);
    spec.with("shift_y", -0.2f32).with("pixel_aspect", 1.3f32).with("skew", 0.1f32).with("fov", 55.0f32)
}

fn calibrated(kind: &str) -> Spec {
    let spec = spec(kind).with("width", 640).with("height", 480).with("fx", 500.0f32).with("fy", 520.0f32);
    spec.with("cx", 300.5f32).with("cy", 260.0f32).with("skew", 4.0f32)
}

fn with_all(spec: Spec, numbers: &[(&str, f64)]) -> Spec {
    numbers.iter().fold(spec, |spec, (key, value)| spec.with(key, Value::Number(*value)))
}

fn barrel(spec: Spec) -> Spec {
    with_all(spec, &[("k1", -0.31), ("k2", 0.12), ("k3", -0.02), ("p1", 0.001), ("p2", -0.0007)])
}

fn rational(spec: Spec) -> Spec {
    let radial = [("k1", 1.1), ("k2", 0.3), ("k3", 0.02), ("k4", 1.5), ("k5", 0.6), ("k6", 0.05)];
    let rest = [("p1", 2e-3), ("p2", -3e-3), ("s1", 4e-3), ("s2", -1e-3), ("s3", -2e-3), ("s4", 5e-4)];
    with_all(with_all(spec, &radial), &rest)
}

fn fisheye(spec: Spec) -> Spec {
    let lens = [("k1", -0.02), ("k2", 0.004), ("k3", -0.003), ("k4", 0.0004), ("fx", 280.0), ("fy", 285.0)];
    with_all(spec, &lens)
}

fn tilted(spec: Spec) -> Spec {
    spec.with("focus_tilt_x", 30.0f32).with("focus_tilt_y", -20.0f32)
}

fn pair(kind: &str, stereo: &str) -> Spec {
    let spec = spec(kind).with("stereo", stereo).with("eye_distance", 0.2f32);
    // Straight up, f32 points of the world do not tell where on its circle an eye sees them.
    if kind == "perspective" { spec.with("convergence", 3.0f32) } else { spec.with("fov", 165.0f32) }
}

fn still(name: &str, spec: Spec, aspect: f32) -> (String, Arc<dyn Camera>, f32) {
    (name.to_owned(), build(&CameraSpec { spec, keyframes: Vec::new() }, aspect).unwrap(), 0.0)
}

fn moving(name: &str, spec: Spec, changes: &[(&str, Value)], time: f32) -> (String, Arc<dyn Camera>, f32) {
    let mut there = Parameters::default();
    for (key, value) in changes {
        there.set_at(key, value.clone(), Span::default());
    }
    let keyframes = vec![(0.0, Parameters::default()), (1.0, there)];
    (name.to_owned(), build(&CameraSpec { spec, keyframes }, 1.5).unwrap(), time)
}

fn cameras() -> Vec<(String, Arc<dyn Camera>, f32)> {
    let mut cameras: Vec<_> =
        CAMERAS.iter().map(|row| still(row.entry.name, Spec::new("", row.entry.name), 1.0)).collect();
    let lens = spec("perspective").with("aperture", 0.3f32);
    let there = [
        ("position", Value::triple([-1.0, 1.5, 3.0])),
        ("fov", Value::Number(70.0)),
        ("aperture", Value::Number(0.1)),
    ];
    let wider = [("position", Value::triple([-1.0, 1.5, 3.0])), ("height", Value::Number(4.0))];
    cameras.extend([
        still("wide", spec("perspective").with("fov", 100.0f32), 2.4),
        still("upright", spec("perspective").with("fov", 20.0f32), 0.5),
        still("mirrored", spec("perspective").with("mirrored", true), 1.6),
        still("shifted", shifted(spec("perspective")), 1.5),
        still("shifted, mirrored", shifted(spec("perspective")).with("mirrored", true), 0.7),
        still("shifted lens", shifted(lens.clone()), 1.5),
        moving("moving shift", shifted(spec("perspective")), &[("shift_x", Value::Number(0.3))], 0.6),
        still("calibrated", calibrated("opencv"), 4.0 / 3.0),
        still("calibrated, mirrored", calibrated("opencv").with("mirrored", true), 4.0 / 3.0),
        still("barrel", barrel(calibrated("opencv")), 4.0 / 3.0),
        still("rational", rational(calibrated("opencv")), 4.0 / 3.0),
        still("rational, of another shape", rational(calibrated("opencv")).with("mirrored", true), 1.0),
        still("folds over", calibrated("opencv").with("k1", -0.3f32), 4.0 / 3.0),
        still("calibrated fisheye", fisheye(calibrated("opencv-fisheye")), 4.0 / 3.0),
        still(
            "narrow fisheye",
            calibrated("opencv-fisheye").with("k1", -0.15f32).with("fx", 170.0f32),
            4.0 / 3.0,
        ),
        still(
            "fisheye all around",
            calibrated("opencv-fisheye").with("fx", 80.0f32).with("fy", 80.0f32),
            4.0 / 3.0,
        ),
        moving("moving fisheye", fisheye(calibrated("opencv-fisheye")), &there[..1], 0.4),
        moving("moving matrix", calibrated("opencv"), &there[..1], 0.4),
        still("lens", lens.clone(), 1.5),
        still("lens, focused near", lens.clone().with("focus", 1.5f32).with("mirrored", true), 1.5),
        still("plan", spec("orthographic").with("height", 3.0f32), 1.7),
        moving("moving panorama", spec("panorama"), &there[..1], 0.4),
        still("part of a panorama", with_all(spec("panorama"), &[("fov_x", 250.0), ("fov", 70.0)]), 2.0),
        still("mirrored panorama", spec("panorama").with("mirrored", true), 2.0),
        still("cylinder", spec("panorama").with("mapping", "cylindrical"), 3.0),
        still(
            "part of a cylinder",
            with_all(spec("panorama"), &[("fov_x", 120.0), ("fov", 60.0)]).with("mapping", "cylindrical"),
            2.0,
        ),
        still("cube", spec("panorama").with("mapping", "cube"), 6.0),
        still("equisolid", spec("fisheye").with("mapping", "equisolid").with("fov", 220.0f32), 1.0),
        still("stereographic", spec("fisheye").with("mapping", "stereographic").with("fov", 240.0f32), 1.5),
        still("orthographic fisheye", spec("fisheye").with("mapping", "orthographic"), 0.7),
        still("full-frame fisheye", spec("fisheye").with("fit", "diagonal").with("mirrored", true), 1.5),
        still("five blades", lens.clone().with("blades", 5).with("blades_rotation", 10.0f32), 1.5),
        still("tilted", tilted(lens.clone()), 1.5),
        still("tilted blades, mirrored", tilted(lens.clone()).with("blades", 3).with("mirrored", true), 0.8),
        still("a floor in focus", lens.clone().with("focus_tilt_y", 80.0f32), 1.5),
        still("left eye", pair("perspective", "left"), 1.5),
        still("right eye, mirrored", pair("perspective", "right").with("mirrored", true), 1.5),
        still("side by side", pair("perspective", "side-by-side"), 2.4),
        still("over and under", pair("perspective", "over-under").with("convergence", 0.0f32), 0.8),
        still(
            "side by side with lenses",
            tilted(pair("perspective", "side-by-side").with("aperture", 0.1f32)),
            3.0,
        ),
        still("turning left eye", pair("panorama", "left"), 2.0),
        still(
            "turning right eye on a cylinder",
            pair("panorama", "right").with("mapping", "cylindrical"),
            3.0,
        ),
        still("turning eyes on a cube", pair("panorama", "over-under").with("mapping", "cube"), 3.0),
        still("turning eyes", pair("panorama", "over-under"), 1.0),
        still(
            "turning eyes side by side, mirrored",
            pair("panorama", "side-by-side").with("mirrored", true),
            4.0,
        ),
        moving("moving pair", pair("perspective", "over-under"), &there[..1], 0.6),
        moving("moving turning eyes", pair("panorama", "over-under"), &there[..1], 0.6),
        moving("moving lens", lens, &there, 0.4),
        moving("moving plan", spec("orthographic"), &wider, 0.7),
    ]);
    cameras
}

#[test]
fn every_camera_keeps_its_contract() {
    for (name, camera, time) in cameras() {
        for (check, run) in CHECKS {
            assert_eq!(run(&*camera, time), Ok(()), "{name}: {check}");
        }
    }
}

/// A camera whose connections have a bug.
struct BuggyCamera {
    camera: Arc<dyn Camera>,
    defect: Defect,
}

type Defect = fn(&dyn Camera, Vec3, Vec2, f32) -> Option<CameraConnection>;

impl Camera for BuggyCamera {
    fn ray(&self, sample: &CameraSample) -> Ray {
        self.camera.ray(sample)
    }

    fn connect(&self, from: Vec3, lens: Vec2, time: f32) -> Option<CameraConnection> {
        (self.defect)(&*self.camera, from, lens, time)
    }

    fn density(&self, ray: &Ray, t: f32) -> f32 {
        self.camera.density(ray, t)
    }

    fn project(&self, p: Vec3, time: f32) -> Option<Vec2> {
        (self.defect)(&*self.camera, p, Vec2::ZERO, time).map(|seen| seen.film)
    }

    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2> {
        (self.defect)(&*self.camera, p.as_vec3(), Vec2::ZERO, time).map(|seen| seen.film.as_dvec2())
    }

    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]> {
        self.camera.ray_f64(film, time)
    }

    fn lens_of(&self, film: Vec2, lens: Vec2) -> Vec2 {
        self.camera.lens_of(film, lens)
    }

    fn project_beside(&self, p: DVec3, time: f32, film: DVec2) -> Option<DVec2> {
        let lens = self.camera.lens_of(film.as_vec2(), Vec2::ZERO);
        (self.defect)(&*self.camera, p.as_vec3(), lens, time).map(|seen| seen.film.as_dvec2())
    }

    fn repeats(&self, film: Vec2) -> [Option<Vec2>; 3] {
        self.camera.repeats(film)
    }

    fn matrices(&self, time: f32) -> CameraMatrices {
        self.camera.matrices(time)
    }

    fn height_at(&self, p: Vec3, time: f32) -> f32 {
        self.camera.height_at(p, time)
    }

    fn has_lens(&self) -> bool {
        self.camera.has_lens()
    }

    fn forward(&self, time: f32) -> Vec3 {
        self.camera.forward(time)
    }
}

/// A bug, the camera that has it, and the check that must detect it.
const PLANTED: &[(&str, &str, &str, Defect)] = &[
    ("a lens not looked at", "lens", "points on a ray project to its film position", |c, from, _, time| {
        c.connect(from, Vec2::ZERO, time)
    }),
    ("round blades", "five blades", "points on a ray project to its film position", |c, from, lens, time| {
        c.connect(from, lens * 0.9, time)
    }),
    (
        "the other eye",
        "side by side",
        "points on a ray project to its film position",
        |c, from, lens, time| c.connect(from, -lens, time),
    ),
    (
        "the density of a plane of focus that is upright",
        "tilted",
        "the density matches that of neighbouring rays",
        |c, from, lens, time| {
            let density = c.connect(from, Vec2::ZERO, time)?.density;
            Some(CameraConnection { density, ..c.connect(from, lens, time)? })
        },
    ),
    (
        "an eye that does not turn",
        "turning left eye",
        "points on a ray project to its film position",
        |c, from, lens, time| {
            let eye = Vec3::from(c.ray(&CameraSample { film: Vec2::splat(0.5), lens, time }).origin);
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { p: eye, ..seen })
        },
    ),
    ("a film upside down", "plan", "points on a ray project to its film position", |c, from, lens, time| {
        let seen = c.connect(from, lens, time)?;
        Some(CameraConnection { film: Vec2::new(seen.film.x, (1.0 - seen.film.y).min(0.999)), ..seen })
    }),
    (
        "a shift of a ten-thousandth",
        "wide",
        "points on a ray project to its film position",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { film: seen.film + Vec2::splat(1e-4), ..seen })
        },
    ),
    (
        "half a pixel aside",
        "rational",
        "in double precision, pixels come back exactly",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { film: seen.film + Vec2::splat(0.5 / 1000.0), ..seen })
        },
    ),
    (
        "y down for up",
        "calibrated fisheye",
        "points on a ray project to its film position",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { film: Vec2::new(seen.film.x, 1.0 - seen.film.y), ..seen })
        },
    ),
    (
        "a rotation transposed",
        "rational",
        "points on a ray project to its film position",
        |c, from, lens, time| {
            let to_camera = c.matrices(time).to_camera;
            let eye = to_camera.inverse().transform_point3(Vec3::ZERO);
            let turned = to_camera.transform_vector3(to_camera.transform_vector3(from - eye));
            c.connect(eye + turned, lens, time)
        },
    ),
    (
        "the Jacobian of distortion left out",
        "barrel",
        "the density matches that of neighbouring rays",
        |c, from, lens, time| {
            // The density of the same camera without distortion.
            let seen = c.connect(from, lens, time)?;
            let distance2 = from.distance_squared(seen.p);
            let cos = -seen.wi.dot(c.forward(time));
            let density = 500.0 * 520.0 / (640.0 * 480.0 * cos * cos * cos * distance2);
            Some(CameraConnection { density, ..seen })
        },
    ),
    (
        "3% of importance too much",
        "calibrated fisheye",
        "every ray reaches the film once",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { density: seen.density * 1.03, ..seen })
        },
    ),
    ("a cosine too few", "wide", "the density matches that of neighbouring rays", |c, from, lens, time| {
        let seen = c.connect(from, lens, time)?;
        Some(CameraConnection { density: seen.density * -seen.wi.dot(c.forward(time)), ..seen })
    }),
    ("the density of another time", "moving lens", "a ray reports its own density", |c, from, lens, time| {
        let density = c.connect(from, lens, 0.0).map_or(0.0, |seen| seen.density);
        Some(CameraConnection { density, ..c.connect(from, lens, time)? })
    }),
    (
        "4% too dense",
        "lens",
        "points of a plane are sampled as often as rays hit them",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { density: seen.density * 1.04, ..seen })
        },
    ),
    (
        "the film's edge clamped",
        "upright",
        "nothing behind the camera is visible, and what is beside the film is found beside it",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { film: seen.film.clamp(Vec2::ZERO, Vec2::splat(0.999)), ..seen })
        },
    ),
    (
        "nothing is found beside the film",
        "upright",
        "nothing behind the camera is visible, and what is beside the film is found beside it",
        |c, from, lens, time| c.connect(from, lens, time).filter(CameraConnection::is_on_film),
    ),
    (
        "a film 2% too wide",
        "mirrored",
        "the matrices put points where the middle of the lens sees them",
        |c, from, lens, time| {
            let seen = c.connect(from, lens, time)?;
            Some(CameraConnection { film: seen.film * 1.02, ..seen })
        },
    ),
    (
        "what is behind is seen",
        "lens",
        "nothing behind the camera is visible, and what is beside the film is found beside it",
        |c, from, lens, time| {
            let eye = Vec3::from(c.ray(&CameraSample { film: Vec2::splat(0.5), lens, time }).origin);
            c.connect(from, lens, time).or_else(|| c.connect(eye * 2.0 - from, lens, time))
        },
    ),
];

#[test]
fn every_check_catches_its_planted_bugs() {
    for (bug, name, check, defect) in PLANTED {
        let (_, camera, time) = cameras().into_iter().find(|(found, ..)| found == name).unwrap();
        let (_, run) = CHECKS.iter().find(|(name, _)| name == check).unwrap();
        assert!(run(&BuggyCamera { camera, defect: *defect }, time).is_err(), "{check} does not see {bug}");
    }
    for (check, _) in CHECKS {
        assert!(PLANTED.iter().any(|(_, _, name, _)| *name == check), "{check}");
    }
}
