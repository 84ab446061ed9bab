//! Everything that one subpath from each end finds, together with the whole path that found it.

use super::path::{Path, PathVertex, Start};
use super::{PANEL_NORMAL, Verdict};
use crate::bidirectional::connect::{Connection, to_camera, to_light, to_vertex};
use crate::bidirectional::light_paths::{LIGHT_STREAM, begin_at_light};
use crate::bidirectional::*;
use crate::media::Arrival;
use crate::media::equiangular::{Departure, Equiangular};
use crate::photons::beam::Beam;
use crate::photons::beams::PhotonBeams;
use crate::photons::grid::PhotonPosition;
use crate::photons::{Photon, PhotonWalk, Photons, TracedPhotons};
use crate::sampling::task::Task;
use crate::techniques::mis::Partial;
use crate::techniques::*;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use bilux_scene::{LightSample, Ray, TransportMode};

pub(super) fn one_sample(ray: &Ray, task: &mut Task, verdict: &mut Verdict) {
    let techniques = &{ verdict.techniques };
    task.sample.sampler.enter(LIGHT_STREAM);
    let Some(subpath) = begin_at_light(task, ray.time, techniques) else { return };
    let index = subpath.light().unwrap();
    let light = &task.context.scene.lights()[index].light;
    let n = if light.is_infinite() || light.is_delta() { None } else { Some(PANEL_NORMAL) };
    let direction = Vec3::from(subpath.walk.ray.direction);
    let start = Start {
        index,
        p: (!light.is_infinite()).then(|| subpath.walk.ray.origin.into()),
        cos: n.map_or(1.0, |n| n.dot(direction).abs()),
    };
    let y = followed(subpath, task, techniques, false);
    let subpath = Subpath::new(TransportMode::Radiance, *ray, Rgb::WHITE, Partial::START, false, techniques);
    let z = followed(subpath, task, techniques, true);
    seen_by_camera(task, verdict, start, &y);
    hit_emitters(task, verdict, &z);
    sampled_lights(task, verdict, &z);
    sampled_equiangularly(task, verdict, &z);
    connected(task, verdict, start, (&y, &z));
}

fn seen_by_camera(task: &mut Task, verdict: &mut Verdict, start: Start, y: &Traced) {
    let techniques = &{ verdict.techniques };
    let is_seen = |vertex: &Vertex| {
        !vertex.at.is_delta() && (vertex.depth > 0 || vertex.at.direct_light(techniques).splats)
    };
    for (i, vertex) in y.vertices.iter().enumerate().filter(|(_, vertex)| is_seen(vertex)) {
        task.sample.enter_light_vertex(vertex.depth);
        let Some((_, connection)) = to_camera(task, vertex, techniques) else { continue };
        let Some((_, found)) = connection.trace(task.tracer) else { continue };
        task.sample.enter_light_vertex(vertex.depth);
        let u = task.sample.sampler.next_2d();
        let lens = if task.context.camera.has_lens() { warp::sample_disc(u) } else { Vec2::ZERO };
        let seen = task.context.camera.connect(vertex.at.p(), lens, vertex.at.time()).unwrap();
        let nodes = y.nodes(i, true, seen.wi, false);
        let path = Path { start, nodes, camera_density: seen.density, fog: verdict.fog_of(task) };
        verdict.look(task, &found, (false, i + 2), &path);
    }
}

fn hit_emitters(task: &mut Task, verdict: &mut Verdict, z: &Traced) {
    for (i, vertex) in z.vertices.iter().enumerate().skip(1) {
        let Some(surface) = vertex.at.surface() else { continue };
        let Some(found) = emitted(
            task,
            surface,
            vertex.wo,
            z.vertices[i - 1].at.is_in_medium(),
            z.vertices[i - 1].approach,
        ) else {
            continue;
        };
        let found = found.by(vertex.beta, &vertex.partial, z.through_panes[i]);
        let index = task.context.scene.light_index_of(surface.object).unwrap();
        let start = Start { index, p: Some(surface.p), cos: surface.n_geom.dot(vertex.wo).abs() };
        let nodes = z.nodes(i - 1, false, -vertex.wo, z.is_delta[i - 1]);
        let path = Path { start, nodes, camera_density: z.camera_density, fog: verdict.fog_of(task) };
        verdict.look(task, &found, (false, 0), &path);
    }
    let (Some(subpath), Some(last)) = (&z.left, z.vertices.len().checked_sub(1)) else { return };
    let lights = task.context.scene.lights();
    let Some(index) = lights.iter().position(|l| l.light.is_infinite() && !l.light.is_delta()) else {
        return;
    };
    let mut founds = Vec::new();
    from_infinity(task, subpath, |hit| {
        let through_panes = subpath.sampled_through_panes(task.context, hit.light, None);
        founds.push(hit.by(subpath.walk.beta, &subpath.partial, through_panes));
    });
    for found in founds {
        let nodes = z.nodes(last, false, subpath.walk.ray.direction.into(), z.is_delta[last]);
        let path = Path {
            start: Start { index, p: None, cos: 1.0 },
            nodes,
            camera_density: z.camera_density,
            fog: verdict.fog_of(task),
        };
        verdict.look(task, &found, (false, 0), &path);
    }
}

fn sampled_lights(task: &mut Task, verdict: &mut Verdict, z: &Traced) {
    let techniques = &{ verdict.techniques };
    for (i, vertex) in z.vertices.iter().enumerate().filter(|(_, vertex)| !vertex.at.is_delta()) {
        for index in 0..task.context.scene.lights().len() {
            let u = task.sample.sampler.next_2d();
            let chosen = (index, task.context.lights.probability(index, vertex.at.lit_at()));
            let Some(connection) = to_light(task, vertex, chosen, u, techniques) else { continue };
            let Some((technique, found)) = connection.trace(task.tracer) else { continue };
            let light = &task.context.scene.lights()[index].light;
            let sample = light.sample_li(vertex.at.p(), vertex.at.time(), u).unwrap();
            let start = light_start(index, &sample);
            let mut nodes = z.nodes(i, false, sample.wi, false);
            let Technique::Connected { s, .. } = technique else { unreachable!() };
            for pane in panes(task, vertex, sample.wi, s - 1) {
                nodes.insert(0, pane);
            }
            let path = Path { start, nodes, camera_density: z.camera_density, fog: verdict.fog_of(task) };
            verdict.look(task, &found, (false, s as usize), &path);
        }
    }
}

/// So many panes in this direction from a vertex.
fn panes(task: &mut Task, vertex: &Vertex, wi: Vec3, count: u32) -> Vec<PathVertex> {
    let (mut ray, media) = (vertex.at.spawn(wi), vertex.media_towards(task.context.scene, wi));
    let mut pane = || {
        let surface = task.tracer.closest(&ray).unwrap();
        ray = surface.spawn(wi);
        let place = (surface.p, surface.n_geom);
        let arrival = Arrival::Surface(surface);
        let at = media.interaction(task.context.scene, &arrival, &task.sample.wavelength).unwrap();
        PathVertex { from_light: place, from_camera: place, at, to_light: wi, to_camera: -wi, is_delta: true }
    };
    (0..count).map(|_| pane()).collect()
}

/// Connects equiangular points with their lights.
fn sampled_equiangularly(task: &mut Task, verdict: &mut Verdict, z: &Traced) {
    let techniques = &{ verdict.techniques };
    for EquiangularPoint { before, light, ratio, vertex, camera_density } in &z.points {
        let u = task.sample.sampler.next_2d();
        let chosen = (*light, task.context.lights.probability(*light, None));
        let Some(Connection { join, segment }) = to_light(task, vertex, chosen, u, techniques) else {
            continue;
        };
        let Some(passage) = segment.passage(task.tracer) else { continue };
        let (_, found) = join.equiangular(*ratio).along(&passage);
        let sample =
            task.context.scene.lights()[*light].light.sample_li(vertex.at.p(), vertex.at.time(), u).unwrap();
        let start = light_start(*light, &sample);
        let place = (vertex.at.p(), Vec3::ZERO);
        let mut nodes = vec![PathVertex {
            from_light: place,
            from_camera: place,
            at: vertex.at,
            to_light: sample.wi,
            to_camera: vertex.wo,
            is_delta: false,
        }];
        if let Some(last) = before.checked_sub(1) {
            nodes.extend(z.nodes(last, false, -vertex.wo, z.is_delta[last]));
        }
        let path = Path { start, nodes, camera_density: *camera_density, fog: verdict.fog_of(task) };
        verdict.look(task, &found, (true, 1), &path);
    }
}

fn light_start(index: usize, sample: &LightSample) -> Start {
    Start { index, p: sample.point, cos: sample.cos() }
}

/// Connects all ends; and, as if each light vertex lay at each camera vertex, merges them.
fn connected(task: &mut Task, verdict: &mut Verdict, start: Start, (y, z): (&Traced, &Traced)) {
    let techniques = &{ verdict.techniques };
    let open = |subpath: &Traced| {
        (0..subpath.vertices.len()).filter(|&i| !subpath.vertices[i].at.is_delta()).collect::<Vec<_>>()
    };
    for (a, b) in open(z).into_iter().flat_map(|a| open(y).into_iter().map(move |b| (a, b))) {
        let (camera_end, light_end) = (&z.vertices[a], &y.vertices[b]);
        let Some(connection) = to_vertex(task, camera_end, light_end, techniques) else { continue };
        let Some((_, found)) = connection.trace(task.tracer) else { continue };
        let direction = (light_end.at.p() - camera_end.at.p()).normalize();
        let mut nodes = y.nodes(b, true, -direction, false);
        nodes.extend(z.nodes(a, false, direction, false));
        let path = Path { start, nodes, camera_density: z.camera_density, fog: verdict.fog_of(task) };
        verdict.look(task, &found, (false, b + 2), &path);
    }
    if techniques.eta == PerSet::ZERO {
        return;
    }
    crossed_beams(task, verdict, start, (y, z));
    merged_points(task, verdict, start, (y, z));
    for (a, b) in open(z).into_iter().flat_map(|a| open(y).into_iter().map(move |b| (a, b))) {
        let (camera_end, light_end) = (&z.vertices[a], &y.vertices[b]);
        if light_end.depth == 0 && !techniques.direct {
            continue;
        }
        let (Some((position, photon)), Some(surface)) = (light_end.photon(), camera_end.at.surface()) else {
            continue;
        };
        let position = PhotonPosition { p: surface.p, ..position };
        let photon = Photon { n_geom: surface.n_geom, ..photon };
        let walk = PhotonWalk { odds: light_end.odds, channel: task.sample.channel };
        let traced =
            TracedPhotons { surfaces: vec![(position, photon)], walks: vec![walk], ..TracedPhotons::NONE };
        let photons = Photons::new(traced, 1.0, *techniques);
        // One vertex replaces both: it scatters as it does at the camera's end.
        let path = merged_path(task, verdict, start, (y, b), (z, a));
        merged(task, &photons, camera_end, |_, found| {
            verdict.look(task, found, (true, b + 2), &path);
        });
    }
}

/// The points of a subpath in fog, by index.
fn in_fog(subpath: &Traced) -> Vec<usize> {
    let is_in_fog = |i: &usize| subpath.vertices[*i].at.is_in_medium();
    (0..subpath.vertices.len()).filter(is_in_fog).collect()
}

/// The path that two vertices, merged into the one of the camera subpath, are part of.
fn merged_path(
    task: &Task,
    verdict: &Verdict,
    start: Start,
    (y, b): (&Traced, usize),
    (z, a): (&Traced, usize),
) -> Path {
    let mut nodes = y.nodes(b, true, z.vertices[a].wo, false);
    let shared = nodes.pop().unwrap();
    let behind = nodes.len();
    nodes.extend(z.nodes(a, false, y.vertices[b].wo, false));
    nodes[behind].from_light = shared.from_light;
    Path { start, nodes, camera_density: z.camera_density, fog: verdict.fog_of(task) }
}

/// Moves each point of the light subpath in fog to each of the camera subpath.
fn merged_points(task: &mut Task, verdict: &mut Verdict, start: Start, (y, z): (&Traced, &Traced)) {
    let techniques = &{ verdict.techniques };
    for (a, b) in in_fog(z).into_iter().flat_map(|a| in_fog(y).into_iter().map(move |b| (a, b))) {
        let (camera_end, light_end) = (&z.vertices[a], &y.vertices[b]);
        if light_end.depth == 0 && !light_end.at.direct_light(techniques).merges {
            continue;
        }
        let photon = light_end.medium_photon(task.context.scene, task.sample.channel);
        let Some((position, photon)) = photon else { continue };
        let position = PhotonPosition { p: camera_end.at.p(), ..position };
        let traced = TracedPhotons { points: vec![(position, photon)], ..TracedPhotons::NONE };
        let photons = Photons::new(traced, 1.0, *techniques);
        let path = merged_path(task, verdict, start, (y, b), (z, a));
        merged(task, &photons, camera_end, |_, found| {
            verdict.look(task, found, (true, b + 2), &path);
        });
    }
}

/// Moves each beam of the light subpath to where a beam of the camera subpath has an event, so that they cross there.
fn crossed_beams(task: &mut Task, verdict: &mut Verdict, start: Start, (y, z): (&Traced, &Traced)) {
    let techniques = &{ verdict.techniques };
    for (a, b) in in_fog(z).into_iter().flat_map(|a| in_fog(y).into_iter().map(move |b| (a, b))) {
        let (Some(eye), Some(light)) = (z.beams[a].last(), y.beams[b].last()) else { continue };
        let (ray, camera_end) = (&z.rays[a], &z.vertices[a]);
        // Both a bit longer than to their events, where they would end.
        let p = camera_end.at.p();
        let mut moved = *light;
        moved.line.origin = p - light.line.direction * light.line.length;
        moved.line.length *= 1.0 + 1e-5;
        let mut eye = *eye;
        eye.line.length *= 1.0 + 1e-5;
        let path = merged_path(task, verdict, start, (y, b), (z, a));
        // Wide enough for the rounding of where they are.
        let beams = PhotonBeams::new(vec![moved], 1e-4);
        crossed(task, &beams, &eye, ray, techniques, |_, found| {
            verdict.look(task, found, (true, b + 2), &path);
        });
    }
}

/// A subpath with all surfaces that it hits.
struct Traced<'w> {
    vertices: Vec<Vertex>,
    /// The ray to each, and its beams.
    rays: Vec<Ray>,
    beams: Vec<Vec<Beam>>,
    /// Which events were delta events.
    is_delta: Vec<bool>,
    /// The subpath with which it left the scene.
    left: Option<Subpath<'w>>,
    camera_density: f32,
    points: Vec<EquiangularPoint>,
    /// Frequency with which the emitter at each vertex is sampled through panes.
    through_panes: Vec<f32>,
}

/// An equiangular point on the ray that leaves the last of so many vertices before.
struct EquiangularPoint {
    before: usize,
    light: usize,
    /// Number of such points there, for each event of a walk.
    ratio: f32,
    vertex: Vertex,
    /// The density of camera rays at the camera subpath's first vertex, which may be this one.
    camera_density: f32,
}

impl Traced<'_> {
    /// The vertices up to and including index `upto`.
    fn nodes(&self, upto: usize, from_light: bool, onwards: Vec3, is_delta: bool) -> Vec<PathVertex> {
        let node = |i: usize| {
            let vertex = &self.vertices[i];
            let next = if i < upto { -self.vertices[i + 1].wo } else { onwards };
            let (to_light, to_camera) = if from_light { (vertex.wo, next) } else { (next, vertex.wo) };
            let is_delta = if i < upto { self.is_delta[i] } else { is_delta };
            let place = (vertex.at.p(), vertex.at.surface().map_or(Vec3::ZERO, |surface| surface.n_geom));
            let at = vertex.at;
            PathVertex { from_light: place, from_camera: place, at, to_light, to_camera, is_delta }
        };
        let nodes = (0..=upto).map(node);
        if from_light { nodes.collect() } else { nodes.rev().collect() }
    }
}

fn followed<'w>(
    mut subpath: Subpath<'w>,
    task: &mut Task,
    techniques: &TechniqueCounts,
    is_camera: bool,
) -> Traced<'w> {
    let (mut vertices, mut is_delta, mut left, mut camera_density) = (Vec::new(), Vec::new(), None, 0.0);
    let (mut rays, mut beams) = (Vec::new(), Vec::new());
    subpath = subpath.keeping_beams(techniques.beams != PerSet::ZERO);
    let (mut points, mut through_panes) = (Vec::new(), Vec::new());
    if is_camera {
        subpath = subpath.with_equiangular_points();
    }
    loop {
        rays.push(subpath.walk.ray);
        let next = subpath.next_vertex(task);
        let ray = *rays.last().unwrap();
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        for light in 0..task.context.scene.lights().len() {
            let u = task.sample.sampler.next_1d();
            let departure = Departure { origin, direction, leaves_medium: false };
            let Some(angle) = Equiangular::new(task.context.scene, light, &departure) else {
                continue;
            };
            let distance = angle.sample(u);
            let Some(mut vertex) = subpath.equiangular_vertex(distance, task) else { continue };
            let mut camera_density = camera_density;
            if vertex.depth == 0 {
                camera_density = task.context.camera.density(&ray, distance);
                let density = camera_density * vertex.arriving;
                vertex.partial = Partial::of_camera(density, techniques, vertex.partial.merged);
            }
            let ratio = angle.density(distance) / vertex.arriving;
            points.push(EquiangularPoint { before: vertices.len(), light, ratio, vertex, camera_density });
        }
        let Some(mut vertex) = next else {
            left = Some(subpath);
            break;
        };
        beams.push(std::mem::take(&mut subpath.beams));
        let light = vertex.at.surface().and_then(|hit| task.context.scene.light_index_of(hit.object));
        through_panes.push(subpath.sampled_through_panes(task.context, light, vertex.at.surface()));
        if is_camera && vertex.depth == 0 {
            camera_density = task.context.camera.density(&subpath.walk.ray, vertex.at.t());
            vertex.partial =
                Partial::of_camera(camera_density * vertex.arriving, techniques, vertex.partial.merged);
            subpath.partial = vertex.partial;
        }
        let stream = if is_camera { 1 } else { LIGHT_STREAM + 1 };
        task.sample.sampler.enter(stream + u64::from(vertex.depth));
        let goes_on = vertex.depth < 4 && subpath.scatter(&vertex, 1000, task);
        vertices.push(vertex);
        is_delta.push(subpath.partial.d_vcm == 0.0);
        if !goes_on {
            break;
        }
    }
    Traced { vertices, rays, beams, is_delta, left, camera_density, points, through_panes }
}
