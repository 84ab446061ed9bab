//! A material while it is written.

use super::text::{Text, rgb};
use bilux_math::Rgb;
use bilux_scene::Spec;

/// A surface shader under construction.
pub(super) struct Draft<'a> {
    pub(super) spec: &'a Spec,
    /// The path of its material.
    pub(super) path: &'a str,
    pub(super) text: &'a mut Text,
    /// The shaders that give it textures.
    pub(super) nodes: &'a mut Text,
}

impl Draft<'_> {
    pub(super) fn number(&mut self, name: &str, number: f32) {
        self.text.line(&format!("float inputs:{name} = {number}"));
    }

    pub(super) fn colour(&mut self, name: &str, colour: Rgb) {
        self.text.line(&format!("color3f inputs:{name} = {}", rgb(colour)));
    }

    pub(super) fn vertex_colours(&mut self) {
        let path = self.path;
        self.text.line(&format!("color3f inputs:diffuseColor.connect = <{path}/Colours.outputs:result>"));
        self.nodes.open("def Shader \"Colours\"", &[]);
        self.nodes.line("uniform token info:id = \"UsdPrimvarReader_float3\"");
        self.nodes.line("string inputs:varname = \"displayColor\"");
        self.nodes.line("float3 outputs:result");
        self.nodes.close();
    }
}
