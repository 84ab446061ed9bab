//! Every registered camera keeps its contract, and every check can fail.

use bilux_math::{Vec2, Vec3};
use bilux_scene::cameras::{CameraSpec, build};
use bilux_scene::{
    CAMERAS, Camera, CameraConnection, CameraMatrices, CameraSample, Parameters, Ray, Span, Spec, Value,
};
use bilux_validation::camera_contract::CHECKS;
use std::sync::Arc;

fn spec(kind: &str) -> Spec {
    Spec::new("", kind).with("position", Vec3::new(1.0, 2.0, 4.0)).with("look_at", Vec3::new(0.2, 0.5, -0.5))
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
        still("lens", lens.clone(), 1.5),
        still("lens, focused near", lens.clone().with("focus", 1.5f32).with("mirrored", true), 1.5),
        still("plan", spec("orthographic").with("height", 3.0f32), 1.7),
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
