//! Materials below a dielectric coating.

use super::super::loader::SpectrumType;
use super::super::media::measured;
use super::super::parameters::ParameterList;
use super::maker::MaterialMaker;
use super::plain::{CONDUCTOR, INTERFACE, Metal};
use super::roughness::{Keys, OWN, PLAIN, PRINCIPLED};
use bilux_import::FormatError;
use bilux_import::appearance::fresnel::{extinction_of, reflected_inside};
use bilux_import::appearance::spectra::metals::straight_and_grazing;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// A diffuse base below a dielectric boundary: `principled`, with a base colour that accounts for internal
/// reflection.
pub(super) fn diffuse(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let reflectance = maker
        .textures
        .texture_or_value(list, "reflectance", SpectrumType::Surface)?
        .unwrap_or(TextureOrValue::Colour(Rgb::grey(0.5)));
    let index = maker.index(list, "eta")?.unwrap_or(1.5);
    maker.read_layer_medium(list)?;
    Ok(Some(maker.below_dielectric(list, reflectance, index, 0.0, false)?))
}

impl MaterialMaker<'_, '_, '_> {
    pub(super) fn below_dielectric(
        &mut self,
        list: &ParameterList,
        reflectance: TextureOrValue,
        index: f32,
        roughness: f32,
        is_old: bool,
    ) -> Result<Spec, FormatError> {
        let index = self.clamped_index(index, list).max(1.0);
        let internal_reflectance = reflected_inside(index);
        let below = |c: f32| c * (1.0 - internal_reflectance) / (1.0 - c * internal_reflectance);
        let base = reflectance.mapped(|c| c.map(below), self.loader().reading)?;
        let mut spec = Spec::new("", "principled").with("specular_ior", index);
        self.set(&mut spec, "base_color", base, list.place("reflectance"));
        self.set_roughness(&mut spec, list, OWN, roughness, is_old, PRINCIPLED)?;
        Ok(spec)
    }

    /// Reads the parameters of the medium between the layers.
    fn read_layer_medium(&mut self, list: &ParameterList) -> Result<(), FormatError> {
        for name in ["thickness", "maxdepth", "nsamples", "g"] {
            list.has(name);
        }
        if let Some(albedo) = self.textures.texture_or_value(list, "albedo", SpectrumType::Surface)?
            && !albedo.is_black()
        {
            self.note("a medium between layers is not supported", || list.place("albedo"));
        }
        Ok(())
    }
}

/// Metal below a clear coat.
pub(super) fn conductor(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    const COAT: Keys = (["coat_roughness", "", ""], 0.0);
    let index = maker.index(list, "interface.eta")?.unwrap_or(1.5);
    let index = maker.clamped_index(index, list).max(1.0);
    maker.read_layer_medium(list)?;
    let mut spec = Spec::new("", "principled").with("base_metalness", 1.0f32).with("coat_weight", 1.0f32);
    spec.parameters.set("coat_ior", index);
    let metal = match maker.metal(list, ["conductor.eta", "conductor.k"])? {
        Metal::Reflectance(TextureOrValue::Picture(picture)) => {
            maker.set(&mut spec, "base_color", TextureOrValue::Picture(picture), list.place("reflectance"));
            None
        }
        Metal::Reflectance(TextureOrValue::Colour(colour)) => Some([Rgb::WHITE, extinction_of(colour)]),
        Metal::Indices(indices) => Some(indices),
    };
    if let Some(metal) = metal {
        let [straight, grazing] = straight_and_grazing(metal, index);
        // Schlick's term at 82 degrees.
        const RISE: f32 = 0.4726;
        let edge = |c: usize| (grazing[c] / (straight[c] + (1.0 - straight[c]) * RISE)).clamp(0.0, 1.0);
        spec.parameters.set("base_color", straight.clamp(0.0, 1.0));
        spec.parameters.set("specular_color", Rgb::new(edge(0), edge(1), edge(2)));
    }
    maker.set_roughness(&mut spec, list, CONDUCTOR, 0.0, false, PRINCIPLED)?;
    maker.set_roughness(&mut spec, list, INTERFACE, 0.0, false, COAT)?;
    // Coats have no anisotropy.
    spec.parameters.0.retain(|(key, ..)| !key.is_empty());
    Ok(Some(spec))
}

/// Light is scattered below a dielectric surface: by coefficients, in `dielectric`, or so that it has a colour, in `principled`.
pub(super) fn subsurface(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    let anisotropy = list.finite("g", 0.0)?.clamp(-0.99, 0.99);
    let scale = list.finite("scale", 1.0)?.max(0.0);
    let index = maker.index(list, "eta")?.unwrap_or(1.33);
    let index = maker.clamped_index(index, list).max(1.0);
    let named = match list.text("name")? {
        Some(name) if measured(name).is_none() => {
            let what = format!("the measured medium '{name}' is not known and is ignored");
            maker.note(&what, || list.place("name"));
            None
        }
        name => name.and_then(measured),
    };
    let scattering = maker.even(list, "sigma_s")?;
    let absorption = maker.even(list, "sigma_a")?;
    let mfp = maker.even(list, "mfp")?.unwrap_or(Rgb::WHITE).map(|length| length.max(0.0));
    let reflectance = maker.textures.texture_or_value(list, "reflectance", SpectrumType::Surface)?;
    if let (None, None, Some(reflectance)) = (named, scattering.zip(absorption), reflectance) {
        let longest = mfp.max_channel();
        let mut spec = Spec::new("", "principled")
            .with("specular_ior", index)
            .with("subsurface_weight", 1.0f32)
            .with("subsurface_radius", longest.min(1e6))
            .with("subsurface_radius_scale", mfp * (1.0 / longest.max(f32::MIN_POSITIVE)))
            .with("subsurface_scatter_anisotropy", anisotropy);
        maker.set(&mut spec, "subsurface_color", reflectance, list.place("reflectance"));
        maker.set_roughness(&mut spec, list, OWN, 0.0, false, PRINCIPLED)?;
        return Ok(Some(spec));
    }
    // What is measured is scattering as if it were even; milk is the default.
    let [scattering, absorption] = match (named, scattering.zip(absorption)) {
        (Some(known), _) => known,
        (None, Some((scattering, absorption))) => [scattering, absorption],
        (None, None) => [Rgb::new(2.55, 3.21, 3.77), Rgb::new(0.0011, 0.0024, 0.014)],
    };
    let mut spec = Spec::new("", "dielectric")
        .with("eta", index)
        .with("absorption", (absorption * scale).clamp(0.0, 1e6))
        .with("scattering", (scattering * scale).clamp(0.0, 1e6))
        .with("scattering_anisotropy", if named.is_some() { 0.0 } else { anisotropy });
    maker.set_roughness(&mut spec, list, OWN, 0.0, false, PLAIN)?;
    Ok(Some(spec))
}

impl MaterialMaker<'_, '_, '_> {
    /// A property of an inside, which is the same everywhere.
    fn even(&mut self, list: &ParameterList, name: &'static str) -> Result<Option<Rgb>, FormatError> {
        let source = self.textures.texture_or_value(list, name, SpectrumType::Number)?;
        if let Some(TextureOrValue::Picture(_)) = &source {
            let what = "a texture of what is inside is replaced by its mean";
            self.note(what, || list.place(name));
        }
        Ok(source.map(|source| source.mean()))
    }
}
