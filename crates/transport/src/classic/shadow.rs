//! Shadows of the classic modes.

use crate::sampling::task::Task;
use bilux_math::{Rgb, Vec3};
use bilux_scene::media::beer;
use bilux_scene::{ClassicLight, Ray, Surface};

/// Effect of an object between a light and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shadows {
    /// Nothing: every light shines on all surfaces that face it.
    Off,
    /// The object blocks the light, even if it is glass, as in Whitted's and the paper's pictures.
    Opaque,
    /// Glass lets the light straight through, and tints it.
    Tinted,
}

/// Maximum number of panes that light passes through before it counts as blocked.
const MAX_PANES: usize = 64;

impl Shadows {
    /// The fraction of a light that arrives at a point.
    pub(crate) fn transmitted(self, task: &mut Task, surface: &Surface, light: &ClassicLight) -> Rgb {
        if self == Shadows::Off {
            return Rgb::WHITE;
        }
        let ray = surface.spawn_to_classic_light(light);
        match self {
            Shadows::Tinted => through_glass(task, ray),
            _ if task.tracer.blocked(&ray) => Rgb::BLACK,
            _ => Rgb::WHITE,
        }
    }
}

/// Fraction of light that is left along a ray: glass tints it, and everything else blocks it except the surfaces of lights.
fn through_glass(task: &mut Task, mut ray: Ray) -> Rgb {
    let scene = task.context.scene;
    let direction = Vec3::from(ray.direction);
    let (mut left, mut before) = (Rgb::WHITE, 0.0);
    for _ in 0..MAX_PANES {
        let Some(surface) = task.tracer.closest(&ray) else { return left };
        if scene.light_of(surface.object).is_none() {
            let material = scene.material(&surface).classic(&surface);
            if surface.n_geom.dot(direction) > 0.0 && !material.thin {
                left *= beer(material.sigma_a, (surface.t - before) * direction.length());
            } else {
                // Each body counts once: where the light enters it.
                left *= material.kt;
            }
            if material.kt.is_black() || left.is_black() {
                return Rgb::BLACK;
            }
            before = surface.t;
        }
        ray.exclude = surface.primitive;
        ray.t_min = surface.t.next_up();
    }
    Rgb::BLACK
}
