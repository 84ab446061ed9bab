//! Inside of volumes, as a material states it: MaterialX's `volume`, and Arnold's `standard_volume`.

use super::network::{Input, input, kind, resolve};
use crate::layers::value::{Text, Value};
use crate::stage::Stage;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_math::transcendental::ln_f64;
use std::f64::consts::E;

/// Medium that fills a volume where its density is 1, per unit of length of the scene.
#[derive(Clone, Debug)]
pub(crate) struct Filling {
    pub(crate) absorption: Rgb,
    pub(crate) scattering: Rgb,
    /// The mean cosine of Henyey and Greenstein's phase function.
    pub(crate) anisotropy: f32,
    /// The field that has the density.
    pub(crate) density: Text,
}

/// Constants of a shader.
struct Inputs<'a, 'r, 'o> {
    stage: &'a Stage<'a>,
    shader: u32,
    context: &'a mut Context<'r, 'o>,
}

/// Medium inside a volume, as a material states it; `None`, with a note, if it says nothing that is read.
pub(crate) fn filling(
    stage: &Stage,
    prim: u32,
    context: &mut Context,
) -> Result<Option<Filling>, FormatError> {
    let mut unknown = "nothing".to_owned();
    // The common output and those for one renderer.
    for output in stage.names(prim, "outputs:").iter().filter(|name| name.ends_with(":volume")) {
        let budget = &mut context.reading.budget;
        let Input::Node(mut shader, _) = resolve(stage, prim, output, budget)? else { continue };
        let mut id = kind(stage, shader, budget)?;
        if id == "ND_volume"
            && let Input::Node(inner, _) = input(stage, shader, "vdf", budget)?
        {
            shader = inner;
            id = kind(stage, shader, budget)?;
        }
        let mut inputs = Inputs { stage, shader, context };
        match &*id {
            "ND_absorption_vdf" | "ND_anisotropic_vdf" => return inputs.materialx().map(Some),
            "arnold:standard_volume" | "standard_volume" => return inputs.arnold().map(Some),
            _ => unknown = format!("the shader '{id}'"),
        }
    }
    let what = format!("materials that say {unknown} of the inside of volumes");
    context.sink.diagnostics.not_shown(&what, || stage.at(prim));
    Ok(None)
}

impl Inputs<'_, '_, '_> {
    /// [MaterialX, absorption_vdf and anisotropic_vdf]
    fn materialx(&mut self) -> Result<Filling, FormatError> {
        Ok(Filling {
            absorption: self.colour("absorption", 0.0)?,
            scattering: self.colour("scattering", 0.0)?,
            anisotropy: self.number("anisotropy", 0.0)? as f32,
            density: "density".into(),
        })
    }

    /// Light that passes a depth has the colour `transparent`, and of what meets the volume a part is scattered.
    fn arnold(&mut self) -> Result<Filling, FormatError> {
        let seen = self.colour("transparent", 1.0 / E)?;
        let depth = self.number("transparent_depth", 1.0)?.max(1e-6);
        let scale = self.number("density", 1.0)?.max(0.0) / depth;
        let extinction = seen.to_array().map(|part| {
            let part = f64::from(part).clamp(1e-6, 1.0);
            (-ln_f64(part) * scale) as f32
        });
        let extinction = Rgb::from_array(extinction);
        let albedo = self.colour("scatter_color", 0.5)? * self.number("scatter", 1.0)? as f32;
        let scattering = extinction * albedo.clamp(0.0, 1.0);
        if self.text("emission_mode")?.is_some_and(|mode| &*mode != "none") {
            let (stage, shader) = (self.stage, self.shader);
            self.context.sink.diagnostics.not_shown("emission of 'standard_volume'", || stage.at(shader));
        }
        Ok(Filling {
            absorption: extinction - scattering,
            scattering,
            anisotropy: self.number("scatter_anisotropy", 0.0)? as f32,
            density: self.text("density_channel")?.unwrap_or_else(|| "density".into()),
        })
    }

    fn colour(&mut self, name: &str, default: f64) -> Result<Rgb, FormatError> {
        let Some(value) = self.constant(name)? else { return Ok(Rgb::grey(default as f32)) };
        let three = value.tuple::<3>().or_else(|| value.number().map(|grey| [grey; 3]));
        Ok(Rgb::from_array(
            three.unwrap_or([default; 3]).map(|x| if x.is_finite() { x.max(0.0) as f32 } else { 0.0 }),
        ))
    }

    fn number(&mut self, name: &str, default: f64) -> Result<f64, FormatError> {
        Ok(self.constant(name)?.and_then(|value| value.number()).filter(|x| x.is_finite()).unwrap_or(default))
    }

    fn text(&mut self, name: &str) -> Result<Option<Text>, FormatError> {
        Ok(self.constant(name)?.and_then(|value| value.text().cloned()).filter(|text| !text.is_empty()))
    }

    fn constant(&mut self, name: &str) -> Result<Option<Value>, FormatError> {
        let (stage, shader) = (self.stage, self.shader);
        Ok(match input(stage, shader, name, &mut self.context.reading.budget)? {
            Input::Value(found) => Some(found.value),
            Input::Nothing => None,
            Input::Node(..) => {
                let what = format!("what other shaders say of '{name}' of a volume");
                self.context.sink.diagnostics.not_shown(&what, || stage.at(shader));
                None
            }
        })
    }
}
