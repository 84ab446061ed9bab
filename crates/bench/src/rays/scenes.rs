//! Scenes to trace: our own, scene files, or meshes and rays from files.

use super::batch::Batch;
use super::options::Options;
use super::{classes, files};
use bilux::accel::TriangleMesh;
use bilux::math::Vec3;
use bilux::scene::error::nearest_name;
use bilux::scene::{Camera, Parameters, SceneBuilder, SceneError, Spec, Value};
use bilux::{Error, Job};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mesh with a name.
pub(super) struct TestMesh {
    pub(super) name: String,
    pub(super) mesh: Arc<TriangleMesh>,
}

/// Source of a test mesh.
pub(super) enum Source {
    Own { name: &'static str, generator: &'static str, parameters: &'static [(&'static str, i64)] },
    Scene(PathBuf),
    Files { mesh: PathBuf, rays: Vec<PathBuf> },
}

/// A name, a generator, and its parameters.
type OwnScene = (&'static str, &'static str, &'static [(&'static str, i64)]);

/// Our own scenes: small and large, uniform and non-uniform. Those after the first [`USUAL`] are traced only when
/// named: one model from a thousand triangles to ten million.
const OWN: [OwnScene; 8] = [
    ("teapots3", "teapots", &[("count", 3), ("tessellation", 8)]),
    ("interior", "interior", &[("detail", 2)]),
    ("scan", "scan", &[("detail", 252)]),
    ("teapot1m", "teapots", &[("count", 1), ("tessellation", 128)]),
    ("teapot1k", "teapots", &[("count", 1), ("tessellation", 4)]),
    ("teapot10k", "teapots", &[("count", 1), ("tessellation", 13)]),
    ("teapot100k", "teapots", &[("count", 1), ("tessellation", 40)]),
    ("teapots10m", "teapots", &[("count", 10), ("tessellation", 125)]),
];
/// Number of our own scenes that are traced unless others are named.
const USUAL: usize = 4;

/// The scenes that the options ask for. The name of one of our own scenes stands for it if there is no such file.
pub(super) fn sources(options: &Options) -> Result<Vec<Source>, Error> {
    let own = |&(name, generator, parameters): &OwnScene| Source::Own { name, generator, parameters };
    if let Some(mesh) = &options.mesh {
        if options.rays.is_empty() {
            return Err(Error::Settings("--mesh needs a file of rays: add --rays FILE".into()));
        }
        return Ok(vec![Source::Files { mesh: mesh.clone(), rays: options.rays.clone() }]);
    }
    if !options.rays.is_empty() || options.hits.is_some() {
        return Err(Error::Settings("files of rays and of hits need a mesh file: add --mesh FILE".into()));
    }
    if options.scenes.is_empty() {
        return Ok(OWN[..USUAL].iter().map(own).collect());
    }
    let find = |path: &PathBuf| match OWN.iter().find(|row| path.as_os_str() == row.0) {
        _ if path.exists() => Ok(Source::Scene(path.clone())),
        Some(row) => Ok(own(row)),
        None => Err(unknown(path)),
    };
    options.scenes.iter().map(find).collect()
}

/// The error for a name that is neither a file nor one of our own scenes.
fn unknown(path: &Path) -> Error {
    let names = OWN.map(|row| row.0.to_owned());
    let hint = match nearest_name(&path.to_string_lossy(), &names) {
        Some(name) => format!("did you mean '{name}'?"),
        None => format!("built-in scenes are {}", names.join(", ")),
    };
    Error::Settings(format!("there is no scene file '{}'; {hint}", path.display()))
}

impl Source {
    pub(super) fn name(&self) -> String {
        let stem = |path: &PathBuf| {
            path.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
        };
        match self {
            Source::Own { name, .. } => (*name).to_owned(),
            Source::Scene(path) | Source::Files { mesh: path, .. } => stem(path),
        }
    }

    /// Loads the mesh, and the rays to trace through it.
    pub(super) fn load(&self, options: &Options) -> Result<(TestMesh, Vec<Batch>), Error> {
        let name = self.name();
        let scene = match self {
            Source::Own { generator, parameters, .. } => {
                let spec = Spec::new("", generator);
                let with = |spec: Spec, &(key, value): &(&str, i64)| spec.with(key, Value::Integer(value));
                bilux::generate(&parameters.iter().fold(spec, with))?
            }
            Source::Scene(path) => bilux::load(path, &options.read)?,
            Source::Files { mesh, rays } => {
                let mesh = Arc::new(files::read_mesh(mesh)?);
                let batches = rays.iter().map(|path| files::read_rays(path)).collect::<Result<_, _>>()?;
                return Ok((TestMesh { name, mesh }, batches));
            }
        };
        let mesh = Arc::new(mesh(&scene)?);
        let batches =
            with_camera(&scene, |camera| classes::make(&mesh, camera, light(&scene), options.count))?
                .ok_or_else(|| Error::Settings(format!("the camera of '{name}' sees nothing of it")))?;
        Ok((TestMesh { name, mesh }, batches))
    }
}

/// All triangles of a scene at time 0, in world space.
fn mesh(scene: &SceneBuilder) -> Result<TriangleMesh, Error> {
    let mut corners = Vec::new();
    for object in &scene.objects {
        let to_world = object.motion.at(0.0);
        let corner = |i: &u32| object.mesh.positions.get(*i as usize).copied().unwrap_or(Vec3::NAN);
        corners.extend(object.mesh.triangles.iter().map(|t| {
            let [a, b, c] = t;
            [a, b, c].map(|i| to_world.point(corner(i)).to_array())
        }));
    }
    TriangleMesh::from_corners(corners)
        .map_err(|e| SceneError::invalid(e.to_string(), &Default::default()).into())
}

/// Calls `work` with the scene's camera, or with the one that a bare model gets, for a square picture.
fn with_camera<T>(scene: &SceneBuilder, work: impl FnOnce(&dyn Camera) -> T) -> Result<T, Error> {
    let mut settings = Parameters::default();
    settings.set("size", Value::Text("64x64".to_owned()));
    let job = Job::new(scene, &settings)?;
    let cameras = job.scene().cameras();
    let camera = cameras.first().ok_or_else(|| Error::Settings("the scene has no camera".to_owned()))?;
    Ok(work(&*camera.1))
}

/// The first rectangular light: its centre and its edges.
fn light(scene: &SceneBuilder) -> Option<[Vec3; 3]> {
    let spec = scene.lights.iter().find(|spec| spec.kind == "rect")?;
    let vector = |key: &str| {
        let Some((Value::List(list), _)) = spec.parameters.find(key) else { return None };
        let number = |value: &Value| match *value {
            Value::Integer(i) => Some(i as f32),
            Value::Number(x) => Some(x as f32),
            _ => None,
        };
        let numbers: Option<Vec<f32>> = list.iter().map(number).collect();
        Some(Vec3::from(<[f32; 3]>::try_from(numbers?).ok()?))
    };
    Some([vector("position")?, vector("edge_u")?, vector("edge_v")?])
}
