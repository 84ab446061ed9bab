//! Local illumination: Equation 1.

use super::shadow::Shadows;
use crate::sampling::task::Task;
use bilux_math::transcendental::powf;
use bilux_math::{Rgb, Vec2, Vec3, frame::reflect};
use bilux_scene::{ClassicLight, ClassicMaterial, Surface};

/// Interpretation of Equation 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRules {
    pub(crate) specular: Specular,
    pub(crate) shadows: Shadows,
    pub(crate) rule: ShadowRule,
    /// The fraction of their size that area lights have, 0..=1.
    pub(crate) light_extent: f32,
}

/// The direction that makes the specular highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Specular {
    /// The halfway vector of viewer and light, against the normal. [Blinn 1977]
    Halfway,
    /// The mirrored light direction, against the viewer. [Phong 1975]
    Reflect,
}

/// Light that a shadow removes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShadowRule {
    /// Each light that is blocked.
    PerLight,
    /// Everything, ambient light included, where every light is blocked; nothing where at least one is not.
    Paper,
}

/// The terms of Equation 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Local {
    /// ka · Ia.
    pub(crate) ambient: Rgb,
    /// kd · Σ (N·L).
    pub(crate) diffuse: Rgb,
    /// Σ (N·L')ⁿ, without ks.
    pub(crate) highlight: Rgb,
}

impl LocalRules {
    /// Local illumination at a point viewed from `eye` (a unit vector away from the surface).
    ///
    /// Lights that contribute no more than `least` are skipped with their shadow rays. That saves most of the shadow
    /// rays from mirrors and glass, where only the highlight counts.
    pub(crate) fn illuminate(
        &self,
        task: &mut Task,
        surface: &Surface,
        material: &ClassicMaterial,
        eye: Vec3,
        least: f32,
    ) -> Local {
        let scene = task.context.scene;
        let mut local = Local { ambient: material.ka * scene.classic_ambient(), ..Local::default() };
        let (mut lights, mut open) = (0, false);
        for light in scene.lights() {
            let u = if self.light_extent > 0.0 { task.sample.sampler.next_2d() } else { Vec2::ZERO };
            let Some(seen) = light.light.classic(surface.p, surface.time, u, self.light_extent) else {
                continue;
            };
            lights += 1;
            let colour = light.classic_colour * seen.strength;
            let (mut diffuse, mut highlight) = (Rgb::BLACK, Rgb::BLACK);
            if let Some((n, n_dot_l)) = faced(surface.n_shade, seen.wi, eye) {
                diffuse = material.kd * colour * n_dot_l;
                if !material.ks.is_black() {
                    highlight = colour * self.highlight(n, &seen, eye, material.exponent);
                }
            }
            let arrives = match self.rule {
                ShadowRule::Paper => {
                    open = open || !self.shadows.transmitted(task, surface, &seen).is_black();
                    Rgb::WHITE
                }
                ShadowRule::PerLight if (diffuse + material.ks * highlight).max_channel() <= least => {
                    continue;
                }
                ShadowRule::PerLight => self.shadows.transmitted(task, surface, &seen),
            };
            local.diffuse += diffuse * arrives;
            local.highlight += highlight * arrives;
        }
        if self.rule == ShadowRule::Paper && lights > 0 && !open { Local::default() } else { local }
    }

    fn highlight(&self, n: Vec3, light: &ClassicLight, eye: Vec3, exponent: f32) -> f32 {
        let cos = match self.specular {
            Specular::Halfway => (light.wi + eye).try_normalize().map_or(0.0, |halfway| n.dot(halfway)),
            Specular::Reflect => reflect(light.wi, n).dot(eye),
        };
        powf(cos.max(0.0), exponent)
    }
}

/// The normal on the side of viewer and light, and its cosine with the light direction; `None` where the two are on
/// opposite sides and the light does not contribute.
fn faced(n: Vec3, wi: Vec3, eye: Vec3) -> Option<(Vec3, f32)> {
    let (n_dot_l, n_dot_e) = (n.dot(wi), n.dot(eye));
    match n_dot_l * n_dot_e > 0.0 {
        false => None,
        true if n_dot_l < 0.0 => Some((-n, -n_dot_l)),
        true => Some((n, n_dot_l)),
    }
}
