//! What is asked of a surface, as far as our materials can show it.

use super::reader::Gltf;
use bilux_math::Rgb;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::ln;
use bilux_scene::materials::{self, Ingredients};
use bilux_scene::{MATERIALS, Span, Spec, Value};

/// The one material that glTF is mapped to.
const KIND: &str = "principled";

impl Gltf<'_, '_, '_> {
    /// Puts a material into the scene, within the ranges of its row; what the row has no word for is mixed in, or told.
    pub(super) fn fitted(&mut self, mut draft: Spec) -> usize {
        let opacity = take(&mut draft, "opacity", !self.knows("opacity"));
        let glass = if self.knows("transmission_weight") { None } else { self.glass(&mut draft) };
        let mut spec = self.principled(draft);
        if let Some((glass, amount)) = glass {
            spec = self.mixed(spec, glass, amount, "transmission");
        }
        if let Some(opacity) = opacity.filter(|opacity| *opacity != Value::from(1.0f32)) {
            // Straight through a wall without thickness of what is around it.
            let clear = Spec::new("clear", "dielectric").with("eta", 1.0f32).with("thin", true);
            spec = self.mixed(clear, spec, opacity, "opacity");
        }
        self.scene.add_material(spec)
    }

    fn knows(&self, key: &str) -> bool {
        let row = MATERIALS.iter().find(|row| row.entry.name == KIND);
        row.is_some_and(|row| row.entry.parameters.iter().any(|parameter| parameter.name == key))
    }

    fn principled(&mut self, draft: Spec) -> Spec {
        let row = MATERIALS.iter().find(|row| row.entry.name == KIND);
        let known = row.map_or(&[][..], |row| row.entry.parameters);
        let mut fitted = Spec { span: draft.span.clone(), ..Spec::new(&draft.name, KIND) };
        for (key, value, at) in draft.parameters.0 {
            let Some(parameter) = known.iter().find(|parameter| parameter.name == key) else {
                if !says_nothing(&key, &value) {
                    let what = format!("{} of a material is not shown", key.replace('_', " "));
                    self.oddities.note(&what, || at.clone());
                }
                continue;
            };
            if let Some(value) = self.within(parameter, value, &at) {
                fitted.parameters.set_at(&key, value, at);
            }
        }
        fitted
    }

    /// A value within its range; none, with a warning, where a picture cannot stand.
    fn within(&mut self, parameter: &Parameter, value: Value, at: &Span) -> Option<Value> {
        let takes_pictures = matches!(
            parameter.kind,
            ParameterKind::ColourTexture { .. }
                | ParameterKind::NumberTexture { .. }
                | ParameterKind::Texture
        );
        let (min, max) = match parameter.kind {
            ParameterKind::Number { min, max }
            | ParameterKind::NumberTexture { min, max }
            | ParameterKind::Colour { min, max }
            | ParameterKind::ColourTexture { min, max } => (min, max),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let held = match &value {
            Value::Texture(_) if !takes_pictures => {
                let what = format!("{} from a picture is not shown", parameter.name.replace('_', " "));
                self.oddities.note(&what, || at.clone());
                return None;
            }
            Value::Number(x) => Value::Number(x.clamp(min, max)),
            Value::List(list) => Value::List(list.iter().map(|x| clamped(x, min, max)).collect()),
            _ => value.clone(),
        };
        if held != value {
            let what = format!("{} of a material is out of range: taken as {min} to {max}", parameter.name);
            self.oddities.note(&what, || at.clone());
        }
        Some(held)
    }

    /// Glass in place of what a material lets through, and how much of it there is.
    fn glass(&mut self, draft: &mut Spec) -> Option<(Spec, Value)> {
        let amount = take(draft, "transmission_weight", true)?;
        let mut glass = Spec::new(&draft.name, "dielectric");
        glass.span = draft.span.clone();
        for (ours, theirs) in [("specular_ior", "eta"), ("specular_roughness", "roughness")] {
            if let Some((value, at)) = draft.parameters.find(ours) {
                glass.parameters.set_at(theirs, value.clone(), at.clone());
            }
        }
        let thin = take(draft, "thin_walled", true).unwrap_or(true.into());
        let colour = take(draft, "transmission_color", true).unwrap_or(Rgb::WHITE.into());
        glass.parameters.set("thin", thin);
        match take(draft, "transmission_depth", true) {
            Some(Value::Number(depth)) => {
                let Value::List(colour) = &colour else { return Some((glass, amount)) };
                let absorbed = |c: &Value| match c {
                    Value::Number(c) => {
                        Value::Number((-f64::from(ln(c.max(1e-6) as f32)) / depth).clamp(0.0, 1e6))
                    }
                    other => other.clone(),
                };
                glass.parameters.set("absorption", Value::List(colour.iter().map(absorbed).collect()));
            }
            _ => glass.parameters.set("tint", colour),
        }
        Some((glass, amount))
    }

    /// Two materials in one place; the first alone where that cannot be.
    fn mixed(&mut self, mut a: Spec, mut b: Spec, amount: Value, what: &str) -> Spec {
        match amount {
            Value::Number(x) if x >= 1.0 => return b,
            Value::Number(x) if x <= 0.0 => return a,
            _ => {}
        }
        let mut mix = Spec { span: b.span.clone(), ..Spec::new(&b.name, "mix") };
        for key in ["normal", "normal_scale"] {
            for part in [&mut a, &mut b] {
                if let Some(value) = take(part, key, true) {
                    mix.parameters.set(key, value);
                }
            }
        }
        for part in [&mut a, &mut b] {
            if take(part, "emission", true).is_some() {
                let at = part.span.clone();
                self.oddities.note("what is seen through gives no light", || at);
            }
        }
        let first = self.scene.materials.len();
        let whole = if what == "opacity" { b.clone() } else { a.clone() };
        self.scene.materials.extend([a, b]);
        let mix = mix
            .with("a", Value::Material(first))
            .with("b", Value::Material(first + 1))
            .with("amount", amount);
        let ingredients = Ingredients::new(&self.scene.textures, &self.scene.materials);
        if materials::build(&mix, &ingredients).is_ok() {
            return mix;
        }
        self.scene.materials.truncate(first);
        let note = format!("{what} of a material is not shown");
        self.oddities.note(&note, || whole.span.clone());
        whole
    }
}

/// Takes a parameter out of a spec, if that is wanted.
fn take(spec: &mut Spec, key: &str, wanted: bool) -> Option<Value> {
    let index = spec.parameters.0.iter().position(|(k, ..)| k == key).filter(|_| wanted)?;
    Some(spec.parameters.0.remove(index).1)
}

fn clamped(value: &Value, min: f64, max: f64) -> Value {
    match value {
        Value::Number(x) => Value::Number(x.clamp(min, max)),
        other => other.clone(),
    }
}

/// True for values that are as good as none.
fn says_nothing(key: &str, value: &Value) -> bool {
    match key {
        "opacity" => *value == Value::from(1.0f32),
        "thin_walled" => *value == Value::Bool(false),
        "transmission_color" | "coat_color" => *value == Value::from(Rgb::WHITE),
        "coat_ior" => true,
        _ => false,
    }
}
