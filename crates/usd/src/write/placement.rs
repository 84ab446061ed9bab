//! Placement of prims: a matrix, or operations with samples of time.

use super::document::{Document, RATE};
use super::text::{Text, matrix, tuple};
use bilux_math::{Mat4, Motion, MotionKey};

impl Document<'_> {
    /// Writes the operations of a motion, the last part of it first.
    pub(super) fn place(&mut self, motion: &Motion, text: &mut Text) {
        let parts = motion.parts();
        let mut order: Vec<String> = Vec::new();
        for (i, part) in parts.iter().enumerate().rev() {
            let keys = part.keys();
            let end = if parts.len() > 1 { format!(":part{}", i + 1) } else { String::new() };
            if keys.is_empty() {
                let place = part.at(0.0);
                if !place.is_identity() {
                    still(place.matrix(), &end, text, &mut order);
                }
                continue;
            }
            moving(&keys, &end, text, &mut order);
            let last = keys.last().map_or(0.0, |key| f64::from(key.time_seconds) * RATE);
            self.end = self.end.max(last);
        }
        ordered(&order, text);
    }
}

/// Writes one transform as the place of a prim.
pub(super) fn placed(place: &Mat4, text: &mut Text) {
    let mut order = Vec::new();
    still(place, "", text, &mut order);
    ordered(&order, text);
}

fn still(place: &Mat4, end: &str, text: &mut Text, order: &mut Vec<String>) {
    let name = format!("xformOp:transform{end}");
    text.line(&format!("matrix4d {name} = {}", matrix(place.to_cols_array())));
    order.push(name);
}

/// Translation, rotation and scale each have the time samples of all keys; between them, all three are interpolated as
/// a motion is.
fn moving(keys: &[MotionKey], end: &str, text: &mut Text, order: &mut Vec<String>) {
    type Part = fn(&MotionKey) -> String;
    let parts: [(&str, &str, Part); 3] = [
        ("double3", "translate", |key| tuple(&key.translation.to_array())),
        ("quatf", "orient", |key| {
            let [x, y, z, w] = key.rotation.normalize().to_array();
            tuple(&[w, x, y, z])
        }),
        ("float3", "scale", |key| tuple(&key.scale.to_array())),
    ];
    for (kind, operation, part) in parts {
        let name = format!("xformOp:{operation}{end}");
        text.line(&format!("{kind} {name}.timeSamples = {{"));
        for key in keys {
            text.line(&format!("    {}: {},", f64::from(key.time_seconds) * RATE, part(key)));
        }
        text.line("}");
        order.push(name);
    }
}

fn ordered(order: &[String], text: &mut Text) {
    if !order.is_empty() {
        let names: Vec<String> = order.iter().map(|name| format!("\"{name}\"")).collect();
        text.line(&format!("uniform token[] xformOpOrder = [{}]", names.join(", ")));
    }
}
