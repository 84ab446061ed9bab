//! Whitted's ray tree: Equation 2, I = Ia + kd Σ(N·L) + ks S + kt T.
//!
//! S is the clamped sum of highlight and reflected light, and T is the refracted light. In glass, Fresnel's law splits
//! the light between them. With extents above zero the rays spread, and the tree is that of distributed ray tracing
//! [Cook 1984]; with all extents zero it uses no random numbers.

use super::{Local, LocalRules};
use crate::sampling::sampler::PixelSampler;
use crate::sampling::task::{PathVertex, Task, VertexKind};
use bilux_math::hash::hash_words;
use bilux_math::transcendental::{cos, sin_cos};
use bilux_math::{Frame, Rgb, Vec3, frame::reflect};
use bilux_scene::bsdf::{fresnel_dielectric, refract, schlick};
use bilux_scene::media::beer;
use bilux_scene::{ClassicMaterial, Ray, Surface};

/// Interpretation of Equation 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayTree {
    pub(crate) local: LocalRules,
    pub(crate) fresnel: FresnelLaw,
    /// Rays of less weight are not traced.
    pub(crate) cutoff: f32,
    /// The fraction of the material's gloss that reflected rays have, 0..=1.
    pub(crate) gloss_extent: f32,
    /// The fraction of the material's translucency that refracted rays have, 0..=1.
    pub(crate) translucency_extent: f32,
}

/// The law that splits light between reflection and refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FresnelLaw {
    Schlick,
    Exact,
}

/// A ray in the tree.
#[derive(Clone, Copy)]
struct RayNode {
    /// Selects the ray's stream of random numbers.
    id: u64,
    /// Scattering events before it.
    depth: u32,
    /// Upper bound of its contribution to the picture.
    weight: f32,
    /// Absorption of the medium that it travels through, as far as it is known.
    sigma_a: Rgb,
}

impl RayNode {
    fn child(&self, branch: u64, weight: f32, sigma_a: Rgb) -> RayNode {
        RayNode { id: hash_words([self.id, branch]), depth: self.depth + 1, weight, sigma_a }
    }
}

/// A shading point with what both branches need: above all the side that the ray came from.
struct ShadingPoint<'a> {
    surface: &'a Surface,
    material: &'a ClassicMaterial,
    /// The direction back along the ray.
    eye: Vec3,
    /// The shading normal on the side of `eye`.
    n: Vec3,
    /// The triangle's normal on the side of `eye`.
    n_flat: Vec3,
    outside: bool,
}

impl RayTree {
    /// The intensity that arrives along a camera ray.
    pub(crate) fn intensity(&self, task: &mut Task, ray: &Ray) -> Rgb {
        self.trace(task, ray, RayNode { id: 1, depth: 0, weight: 1.0, sigma_a: Rgb::BLACK })
    }

    fn trace(&self, task: &mut Task, ray: &Ray, node: RayNode) -> Rgb {
        let direction = Vec3::from(ray.direction);
        let Some(surface) = task.tracer.closest(ray) else {
            task.sample.note(node.depth, || format!("leaves the scene towards {direction}"));
            return task.context.scene.background(direction, node.depth);
        };
        task.sample.vertices += 1;
        let outside = surface.n_geom.dot(direction) <= 0.0;
        let material = task.context.scene.material(&surface);
        let sigma_a = if outside {
            node.sigma_a
        } else {
            material.medium().map_or(Rgb::BLACK, |medium| medium.sigma_a)
        };
        let left = beer(sigma_a, surface.t);
        let emission = task.context.scene.emission(&surface, -direction);
        if !emission.is_black() {
            let vertex = PathVertex::new(VertexKind::Emitter, surface.p);
            task.sample.note_vertex(node.depth, || (vertex, format!("reaches a light at {}", surface.p)));
            return left * emission.clamp(0.0, 1.0);
        }
        if node.depth >= task.context.max_depth {
            task.sample.note(node.depth, || format!("is not traced beyond {}", surface.p));
            return Rgb::BLACK;
        }
        left * self.shade(task, &surface, &material.classic(&surface), -direction, node)
    }

    /// Equation 2.
    fn shade(
        &self,
        task: &mut Task,
        surface: &Surface,
        material: &ClassicMaterial,
        eye: Vec3,
        node: RayNode,
    ) -> Rgb {
        task.sample.sampler.enter(node.id);
        let place = ShadingPoint::new(surface, material, eye);
        let least = self.cutoff / (16.0 * node.weight);
        let Local { ambient, diffuse, highlight } =
            self.local.illuminate(task, surface, material, eye, least);
        task.sample.note_vertex(node.depth, || {
            let (name, side) = (task_name(surface), if place.outside { "outside" } else { "inside" });
            let vertex = PathVertex::new(VertexKind::Surface, surface.p);
            (vertex, format!("hits {name} at {}, {side}", surface.p))
        });
        let mut sum = ambient + diffuse;
        let share = self.reflected_share(&place);
        if !material.ks.is_black() {
            let reflected = self.reflected(task, &place, share * material.reflectivity, node);
            sum += material.ks * (highlight + reflected).clamp(0.0, 1.0);
        }
        if !material.kt.is_black() {
            let through = if material.fresnel { 1.0 - share } else { 1.0 };
            sum += material.kt * self.refracted(task, &place, through, node);
        }
        sum
    }

    /// The fraction of light that is reflected: all of it where the material does not use Fresnel's law.
    fn reflected_share(&self, place: &ShadingPoint) -> f32 {
        let material = place.material;
        if !material.fresnel {
            return 1.0;
        }
        let cos = place.n.dot(place.eye);
        let share = match self.fresnel {
            FresnelLaw::Schlick => schlick(cos, place.eta()),
            FresnelLaw::Exact => fresnel_dielectric(cos, place.eta()),
        };
        // Light that bounces between the two faces of a pane adds up. [pbrt 2023, eq. 9.12]
        if material.thin { 2.0 * share / (1.0 + share) } else { share }
    }

    /// Light from the reflected direction, times `share`.
    fn reflected(&self, task: &mut Task, place: &ShadingPoint, share: f32, node: RayNode) -> Rgb {
        let weight = node.weight * share * place.material.ks.max_channel();
        if share <= 0.0 || weight < self.cutoff {
            return Rgb::BLACK;
        }
        let spread = place.material.gloss * self.gloss_extent;
        let direction = place.spread(place.mirrored(), spread, &mut task.sample.sampler);
        let sigma_a = if place.outside { node.sigma_a } else { place.material.sigma_a };
        let child = node.child(0, weight, sigma_a);
        task.sample.note(node.depth, || format!("reflects towards {direction}, share {share}"));
        self.trace(task, &place.surface.spawn(direction), child) * share
    }

    /// Light from the refracted direction, times `share`; black under total internal reflection.
    fn refracted(&self, task: &mut Task, place: &ShadingPoint, share: f32, node: RayNode) -> Rgb {
        let weight = node.weight * share * place.material.kt.max_channel();
        if share <= 0.0 || weight < self.cutoff {
            return Rgb::BLACK;
        }
        let Some(straight) = place.refracted() else {
            return Rgb::BLACK;
        };
        let spread = place.material.translucency * self.translucency_extent;
        let direction = place.spread(straight, spread, &mut task.sample.sampler);
        let sigma_a = match place.outside {
            _ if place.material.thin => node.sigma_a,
            true => place.material.sigma_a,
            false => Rgb::BLACK,
        };
        let child = node.child(1, weight, sigma_a);
        task.sample.note(node.depth, || format!("refracts towards {direction}, share {share}"));
        self.trace(task, &place.surface.spawn(direction), child) * share
    }
}

fn task_name(surface: &Surface) -> String {
    format!("object {} triangle {}", surface.object, surface.primitive.index)
}

impl<'a> ShadingPoint<'a> {
    fn new(surface: &'a Surface, material: &'a ClassicMaterial, eye: Vec3) -> ShadingPoint<'a> {
        let outside = surface.n_geom.dot(eye) >= 0.0;
        let facing = |n: Vec3| if outside { n } else { -n };
        let (n_flat, n) = (facing(surface.n_geom), facing(surface.n_shade));
        // At grazing angles the interpolated normal may face away; the triangle's own normal then replaces it.
        let n = if n.dot(eye) > 0.0 { n } else { n_flat };
        ShadingPoint { surface, material, eye, n, n_flat, outside }
    }

    /// Index of the far side over that of the near side. A pane is entered from outside on both sides.
    fn eta(&self) -> f32 {
        if self.outside || self.material.thin { self.material.eta } else { 1.0 / self.material.eta }
    }

    fn mirrored(&self) -> Vec3 {
        let direction = reflect(self.eye, self.n);
        let above = direction.dot(self.n_flat) > 0.0;
        (if above { direction } else { reflect(self.eye, self.n_flat) }).normalize()
    }

    fn refracted(&self) -> Option<Vec3> {
        if self.material.thin {
            return Some(-self.eye);
        }
        let direction = refract(self.eye, self.n, self.eta())?;
        let below = direction.dot(self.n_flat) < 0.0;
        if below { Some(direction) } else { refract(self.eye, self.n_flat, self.eta()) }
    }

    /// A direction sampled uniformly in the cone of this half-angle, and kept on its side of the surface.
    fn spread(&self, axis: Vec3, angle: f32, sampler: &mut PixelSampler) -> Vec3 {
        if angle <= 0.0 {
            return axis;
        }
        let u = sampler.next_2d();
        let cos_theta = 1.0 - u.x * (1.0 - cos(angle));
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let (s, c) = sin_cos(std::f32::consts::TAU * u.y);
        let local = Vec3::new(sin_theta * c, sin_theta * s, cos_theta);
        let direction = Frame::from_normal(axis).to_world(local).normalize();
        let crossed = direction.dot(self.n_flat) * axis.dot(self.n_flat) < 0.0;
        if crossed { -reflect(direction, self.n_flat) } else { direction }
    }
}
