//! How subpaths are joined: with the camera, with a point on a light, or with each other.

use super::walk::Vertex;
use super::{Partial, Photons};
use crate::medium::transmittance;
use crate::task::Task;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use bilux_scene::{Ray, TransportMode};

/// The vertex of a light path seen from the camera (t = 1): where on the film, the light there (as an integral over the
/// whole film), and the weights of all other ways as a part of this one's.
pub(crate) fn to_camera(task: &mut Task, y: &Vertex) -> Option<(Vec2, Rgb, f32)> {
    let u_lens = task.sampler.next_2d();
    let lens = if task.camera.has_lens() { warp::sample_disc(u_lens) } else { Vec2::ZERO };
    let seen = task.camera.connect(y.surface.p, lens, y.surface.time)?;
    let scattered = y.bsdf.eval(y.wo, seen.wi, TransportMode::Importance);
    if scattered.is_black() || task.tracer.occluded(&y.surface.spawn_to(seen.p)) {
        return None;
    }
    let pdf_area = seen.density * y.surface.n_geom.dot(seen.wi).abs();
    let others = y.partial.others(pdf_area, y.bsdf.pdf_solid_angle(seen.wi, y.wo));
    let passed = transmittance(y.sigma_a, seen.p.distance(y.surface.p));
    Some((seen.film, y.beta * scattered * passed * seen.density, others))
}

/// A point sampled on a light (s = 1): the light that comes from there along the camera path, weighted.
pub(crate) fn to_light(task: &mut Task, z: &Vertex, index: usize, u: Vec2) -> Rgb {
    let probability = task.lights.probability(index);
    let scene = task.scene();
    let light = &scene.lights()[index].light;
    if probability == 0.0 {
        return Rgb::BLACK;
    }
    let Some(sample) = light.sample_li(z.surface.p, z.surface.time, u) else { return Rgb::BLACK };
    let (scattered, pdf) = z.bsdf.eval_and_pdf(z.wo, sample.wi, TransportMode::Radiance);
    if scattered.is_black() || task.tracer.occluded(&z.surface.spawn_to_light(&sample)) {
        return Rgb::BLACK;
    }
    let distance = sample.point.map_or(0.0, |point| point.distance(z.surface.p));
    let cos_light = sample.cos();
    // Of a light without extent the point is certain: its density over solid angle grows with the distance alone.
    let area_to_angle = if sample.point.is_some() { distance * distance / cos_light } else { 1.0 };
    let pdf_direct = if light.is_delta() { area_to_angle } else { sample.pdf_solid_angle };
    let pdf_emission = light.emission_pdf(&scene.bounds(), pdf_direct / area_to_angle, -sample.wi, cos_light)
        * task.lights.emission_probability(index);
    let by_scattering = if light.is_delta() { 0.0 } else { pdf / (pdf_direct * probability) };
    let cos = z.surface.n_geom.dot(sample.wi).abs();
    let arriving = pdf_emission * cos / (pdf_direct * probability * cos_light);
    let by_light_path = z.partial.others(arriving, z.bsdf.pdf_solid_angle(sample.wi, z.wo));
    let weight = 1.0 / (1.0 + by_scattering + by_light_path);
    let passed = transmittance(z.sigma_a, distance);
    z.beta * scattered * sample.li * passed * (weight / (sample.pdf_solid_angle * probability))
}

/// A camera vertex and a light vertex (s, t > 1): the light between them, weighted.
pub(crate) fn to_vertex(task: &mut Task, z: &Vertex, y: &Vertex) -> Rgb {
    let between = y.surface.p - z.surface.p;
    let distance2 = between.length_squared();
    let Some(direction) = between.try_normalize() else { return Rgb::BLACK };
    let (f_z, pdf_z) = z.bsdf.eval_and_pdf(z.wo, direction, TransportMode::Radiance);
    if f_z.is_black() {
        return Rgb::BLACK;
    }
    let (f_y, pdf_y) = y.bsdf.eval_and_pdf(y.wo, -direction, TransportMode::Importance);
    if f_y.is_black() || task.tracer.occluded(&spawn_between(z, y)) {
        return Rgb::BLACK;
    }
    let cos = |vertex: &Vertex| vertex.surface.n_geom.dot(direction).abs();
    let by_camera_path =
        y.partial.others(pdf_z * cos(y) / distance2, y.bsdf.pdf_solid_angle(-direction, y.wo));
    let by_light_path = z.partial.others(pdf_y * cos(z) / distance2, z.bsdf.pdf_solid_angle(direction, z.wo));
    let weight = 1.0 / (1.0 + by_camera_path + by_light_path);
    let passed = transmittance(z.sigma_a, distance2.sqrt());
    z.beta * f_z * f_y * y.beta * passed * (weight / distance2)
}

/// A camera vertex and all photons around it: the light that they bring, weighted where there are other ways.
pub(crate) fn merged(task: &Task, photons: &Photons, z: &Vertex, is_only_way: bool) -> Rgb {
    let (mut sum, per_eta) = (Rgb::BLACK, 1.0 / photons.eta());
    photons.around(z.surface.p, |y| {
        // On the same surface, not on the other side of a sheet or around a corner.
        if z.depth + y.depth + 1 > task.max_depth || z.surface.n_geom.dot(y.n_geom) < 0.5 {
            return;
        }
        let (scattered, pdf) = z.bsdf.eval_and_pdf(z.wo, y.wo, TransportMode::Radiance);
        if scattered.is_black() {
            return;
        }
        // Photons come per area of the surface itself; `eval` has the cosine to the shading normal in it.
        let cos = z.surface.n_geom.dot(y.wo).abs();
        let others = if is_only_way {
            0.0
        } else {
            let back = z.bsdf.pdf_solid_angle(y.wo, z.wo);
            let by_camera_path = Partial::others_than_merging(y.d_vcm, y.d_vm, pdf, per_eta);
            by_camera_path + Partial::others_than_merging(z.partial.d_vcm, z.partial.d_vm, back, per_eta)
        };
        sum += scattered * y.beta * (1.0 / (cos * (1.0 + others)));
    });
    z.beta * sum * per_eta
}

/// From one surface to another, ending just before the second.
fn spawn_between(z: &Vertex, y: &Vertex) -> Ray {
    let ray = z.surface.spawn_to(y.surface.p);
    let direction = Vec3::from(ray.direction);
    let length = direction.length();
    let cos = y.surface.n_geom.dot(direction).abs() / length;
    let error = y.surface.n_geom.abs().dot(y.surface.p_error)
        + f32::EPSILON * (length + z.surface.p.abs().max_element() + y.surface.p.abs().max_element());
    // A ray meets the second surface within the error of the point there, over the cosine.
    let clearance = (8.0 * error / (cos * length)).min(0.5);
    Ray { t_max: 1.0 - clearance, ..ray }
}
