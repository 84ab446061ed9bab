//! Materials by their types. Made from their table by `cargo xtask docs`; not edited by hand.

typed! {
    /// The paper's material: ambient, diffuse, specular and refracted light, each with its constant.
    Phong = "phong" {
        /// Ambient reflection; kd where it is not given; default `0`.
        ka: impl Into<crate::Value>,
        /// Diffuse reflection; default `0.7`.
        kd: impl Into<crate::Value>,
        /// Specular reflection: the weight of S in Equation 2; default `0.3`.
        ks: impl Into<crate::Value>,
        /// Refraction: the weight of T in Equation 2; default `0`.
        kt: impl Into<crate::Value>,
        /// Exponent of the highlight; default `32`.
        exponent: f32,
        /// How much of S is light from the reflected direction; 1 in the paper; default `1`.
        reflectivity: f32,
        /// Refractive index of the inside over that of the outside; default `1.5`.
        eta: f32,
        /// Absorption inside, by Beer's law (1/m); default `0`.
        absorption: bilux_math::Rgb,
        /// Thin-walled: light passes straight through; default `false`.
        thin: bool,
        /// Greatest angle by which reflected rays spread, in cook only (degrees); default `0`.
        gloss: f32,
        /// Greatest angle by which refracted rays spread, in cook only (degrees); default `0`.
        translucency: f32,
        /// Emitted radiance (W/(m² sr)); default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on an emission texture; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Where it gives light out: on both sides, or in front, where a triangle's corners run counter-clockwise: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// Diffuse reflection.
    Diffuse = "diffuse" {
        /// Reflected fraction of the light; default `0.7`.
        reflectance: impl Into<crate::Value>,
        /// Roughness of the diffuse microsurface: 0 is Lambertian, 1 as rough as clay or the moon: brighter where the light comes from behind the viewer; default `0`.
        roughness: impl Into<crate::Value>,
        /// Emitted radiance (W/(m² sr)); default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on an emission texture; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Where it gives light out: on both sides, or in front, where a triangle's corners run counter-clockwise: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// From where the camera sees it: from both sides, or from the front, where a triangle's corners run counter-clockwise; light meets both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// A perfect mirror.
    Mirror = "mirror" {
        /// Reflected fraction of the light; default `0.95`.
        reflectance: impl Into<crate::Value>,
        /// Greatest angle by which reflected rays spread, in cook only (degrees); default `0`.
        gloss: f32,
        /// Emitted radiance (W/(m² sr)); default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on an emission texture; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Where it gives light out: on both sides, or in front, where a triangle's corners run counter-clockwise: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// From where the camera sees it: from both sides, or from the front, where a triangle's corners run counter-clockwise; light meets both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// Metal: polished, satin or brushed.
    Conductor = "conductor" {
        /// A metal as it was measured: `aluminium`, `brass`, `chromium`, `copper`, `gold`, `iron`, `nickel`, `silver`, `titanium`; default `aluminium`.
        metal: &str,
        /// In place of a metal: the real part of its refractive index; default `1`.
        eta: bilux_math::Rgb,
        /// In place of a metal: the imaginary part, the extinction; default `1`.
        k: bilux_math::Rgb,
        /// In place of a metal: reflected fraction of light that falls in straight; default `1`.
        reflectance: impl Into<crate::Value>,
        /// With a reflectance: what remains of Schlick's law at 82 degrees; default `1`.
        edge: bilux_math::Rgb,
        /// Surface roughness: 0 is polished; the square root of GGX's alpha; default `0.3`.
        roughness: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across; default `0`.
        anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u, or around the y axis of meshes without texture coordinates (degrees); default `0`.
        rotation: f32,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// From where the camera sees it: from both sides, or from the front, where a triangle's corners run counter-clockwise; light meets both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// Glass, water, diamond; frosted where it is rough.
    Dielectric = "dielectric" {
        /// In place of eta and dispersion: what it is, as it was measured: `none`, `acrylic`, `baf10`, `bk7`, `diamond`, `fk51a`, `lasf9`, `polycarbonate`, `sapphire`, `sf10`, `sf11`, `sf5`, `silica`, `water`; default `none`.
        glass: &str,
        /// Refractive index of the inside over that of the outside; default `1.5`.
        eta: f32,
        /// How far colours are parted: 20 over Abbe's number, so 0.31 for window glass, 0.55 for flint glass, 0.36 for diamond; default `0`.
        dispersion: f32,
        /// Factor on all light; white for real glass; default `1`.
        tint: impl Into<crate::Value>,
        /// Absorption inside, by Beer's law (1/m); default `0`.
        absorption: bilux_math::Rgb,
        /// Where several of these overlap, that of the greatest priority is, and eta is over that of air; 0 takes no part in it; default `0`.
        priority: i32,
        /// Thin-walled: light passes straight through; default `false`.
        thin: bool,
        /// Surface roughness: 0 is polished; the square root of GGX's alpha; default `0`.
        roughness: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across; default `0`.
        anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u, or around the y axis of meshes without texture coordinates (degrees); default `0`.
        rotation: f32,
        /// Greatest angle by which reflected rays spread, in cook only (degrees); default `0`.
        gloss: f32,
        /// Greatest angle by which refracted rays spread, in cook only (degrees); default `0`.
        translucency: f32,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// Plastic, metal, paint, glass: one surface for nearly everything.
    Principled = "principled" {
        /// What diffuse parts reflect, and metal straight on; default `0.8`.
        base_color: impl Into<crate::Value>,
        /// Of what scatters diffusely: 0 is Lambert's, 1 as clay or the moon; default `0`.
        base_diffuse_roughness: impl Into<crate::Value>,
        /// How much of the surface is metal; default `0`.
        base_metalness: impl Into<crate::Value>,
        /// Factor on what is reflected straight on at the surface; default `1`.
        specular_weight: impl Into<crate::Value>,
        /// Factor on what is reflected at the surface; of metal, near grazing; default `1`.
        specular_color: impl Into<crate::Value>,
        /// Surface roughness: 0 is polished; the square root of GGX's alpha; default `0.3`.
        specular_roughness: impl Into<crate::Value>,
        /// Refractive index of what is not metal; default `1.5`.
        specular_ior: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across; default `0`.
        specular_roughness_anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u (turns); default `0`.
        anisotropy_rotation: impl Into<crate::Value>,
        /// How much of what is not metal is clear; default `0`.
        transmission_weight: impl Into<crate::Value>,
        /// What is left of light that passes: at each surface, or after transmission_depth inside; default `1`.
        transmission_color: impl Into<crate::Value>,
        /// How far light goes inside until it has transmission_color; 0 tints at the surface (m); default `0`.
        transmission_depth: f32,
        /// How much of what transmission_dispersion_abbe_number says parts colours inside of what is clear; default `0`.
        transmission_dispersion_scale: f32,
        /// The less it is, the further colours are parted: 64 for window glass, 36 for flint glass; default `20`.
        transmission_dispersion_abbe_number: f32,
        /// Thin-walled: light passes straight through; default `false`.
        thin_walled: bool,
        /// Where several of these overlap, that of the greatest priority is, and eta is over that of air; 0 takes no part in it; default `0`.
        priority: i32,
        /// How much of the surface has a clear coat; default `0`.
        coat_weight: impl Into<crate::Value>,
        /// What is left of light that passes the coat and comes back; default `1`.
        coat_color: impl Into<crate::Value>,
        /// Surface roughness: 0 is polished; the square root of GGX's alpha; default `0`.
        coat_roughness: impl Into<crate::Value>,
        /// Refractive index of the coat; default `1.6`.
        coat_ior: impl Into<crate::Value>,
        /// Normals of the coat as a picture; without it the coat is as smooth as the mesh; default `none`.
        coat_normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        coat_normal_scale: f32,
        /// How much of the surface has fine fibres on top, as velvet has; default `0`.
        fuzz_weight: impl Into<crate::Value>,
        /// Colour of the fibres; default `1`.
        fuzz_color: impl Into<crate::Value>,
        /// Low for fibres that stand upright and are seen only along the surface; default `0.5`.
        fuzz_roughness: impl Into<crate::Value>,
        /// How much of the diffuse part comes out behind, as in a leaf; default `0`.
        diffuse_transmission_weight: impl Into<crate::Value>,
        /// What comes out behind of light that scatters there; default `1`.
        diffuse_transmission_color: impl Into<crate::Value>,
        /// How much of the surface has a film as thin as light's waves; default `0`.
        thin_film_weight: impl Into<crate::Value>,
        /// Thickness of that film (µm); default `0.5`.
        thin_film_thickness: impl Into<crate::Value>,
        /// Refractive index of that film; default `1.4`.
        thin_film_ior: impl Into<crate::Value>,
        /// Emitted radiance (W/(m² sr)); default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on an emission texture; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Where it gives light out: on both sides, or in front, where a triangle's corners run counter-clockwise: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// From where the camera sees it: from both sides, or from the front, where a triangle's corners run counter-clockwise; light meets both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
    /// A mixture of two materials.
    Mix = "mix" {
        /// The first material, by its name; it has to be given.
        a: impl Into<crate::Value>,
        /// The second material, by its name; may be a mix itself; it has to be given.
        b: impl Into<crate::Value>,
        /// Weight of the second material; default `0.5`.
        amount: impl Into<crate::Value>,
        /// Opacity: 0 is a hole; a texture cuts out leaves and lace; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normals as a picture, in tangent space, green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Factor on how far the picture's normals lean; default `1`.
        normal_scale: f32,
    }
}
