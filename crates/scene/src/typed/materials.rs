//! Materials as Rust types. Generated from their table by `cargo xtask docs`; do not edit by hand.

typed! {
    /// The paper's material: ambient, diffuse, specular and refracted light, each with its coefficient.
    Phong = "phong" {
        /// Ambient reflection; kd if it is not given; from 0 to 1; default `0`.
        ka: impl Into<crate::Value>,
        /// Diffuse reflection; from 0 to 1; default `0.7`.
        kd: impl Into<crate::Value>,
        /// Specular reflection: the weight of S in Equation 2; from 0 to 1; default `0.3`.
        ks: impl Into<crate::Value>,
        /// Refraction: the weight of T in Equation 2; from 0 to 1; default `0`.
        kt: impl Into<crate::Value>,
        /// Exponent of the specular highlight; from 0 to 1e5; default `32`.
        exponent: f32,
        /// Share of S that comes from the reflected direction; 1 in the paper; from 0 to 1; default `1`.
        reflectivity: f32,
        /// Refractive index of the inside relative to the outside; from 0.1 to 10; default `1.5`.
        eta: f32,
        /// Absorption coefficient inside (Beer-Lambert law) (1/m); from 0 to 1e6; default `0`.
        absorption: bilux_math::Rgb,
        /// Thin-walled: light passes straight through without refraction; default `false`.
        thin: bool,
        /// Maximum angle by which reflected rays spread, in cook only (degrees); from 0 to 90; default `0`.
        gloss: f32,
        /// Maximum angle by which refracted rays spread, in cook only (degrees); from 0 to 90; default `0`.
        translucency: f32,
        /// Emitted radiance (W/(m² sr)); from 0 to 1e12; default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on the emission; from 0 to 1e12; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its own mesh; a mirrored copy keeps its front: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// Diffuse reflection.
    Diffuse = "diffuse" {
        /// Reflected fraction of the light; from 0 to 1; default `0.7`.
        reflectance: impl Into<crate::Value>,
        /// Roughness of the diffuse microsurface: 0 is Lambertian, 1 is like clay or the moon, which are brighter when the light is behind the viewer; from 0 to 1; default `0`.
        roughness: impl Into<crate::Value>,
        /// Emitted radiance (W/(m² sr)); from 0 to 1e12; default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on the emission; from 0 to 1e12; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its own mesh; a mirrored copy keeps its front: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// The sides that the camera sees: both, or the front, where a triangle's vertices run counter-clockwise; light reaches both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// Paper, leaves, lampshades: diffuse reflection and diffuse transmission.
    Translucent = "translucent" {
        /// Fraction of the light that is reflected; from 0 to 1; default `0.4`.
        reflectance: impl Into<crate::Value>,
        /// Fraction of the light that is transmitted diffusely; both are scaled down if they sum to more than 1; from 0 to 1; default `0.4`.
        transmittance: impl Into<crate::Value>,
        /// Emitted radiance (W/(m² sr)); from 0 to 1e12; default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on the emission; from 0 to 1e12; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its own mesh; a mirrored copy keeps its front: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// A perfect mirror.
    Mirror = "mirror" {
        /// Reflected fraction of the light; from 0 to 1; default `0.95`.
        reflectance: impl Into<crate::Value>,
        /// Maximum angle by which reflected rays spread, in cook only (degrees); from 0 to 90; default `0`.
        gloss: f32,
        /// Emitted radiance (W/(m² sr)); from 0 to 1e12; default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on the emission; from 0 to 1e12; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its own mesh; a mirrored copy keeps its front: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// The sides that the camera sees: both, or the front, where a triangle's vertices run counter-clockwise; light reaches both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// Metal: polished, satin or brushed.
    Conductor = "conductor" {
        /// A measured metal: `aluminium`, `brass`, `chromium`, `copper`, `gold`, `iron`, `nickel`, `silver`, `titanium`; default `aluminium`.
        metal: &str,
        /// Instead of 'metal': the real part of the refractive index; from 0.001 to 100; default `1`.
        eta: bilux_math::Rgb,
        /// Instead of 'metal': the imaginary part, the extinction coefficient; from 0 to 100; default `1`.
        k: bilux_math::Rgb,
        /// Instead of 'metal': reflectance at normal incidence; from 0 to 1; default `1`.
        reflectance: impl Into<crate::Value>,
        /// With 'reflectance': factor on Schlick's approximation at 82 degrees; from 0 to 1; default `1`.
        edge: bilux_math::Rgb,
        /// Microfacet roughness: 0 is perfectly smooth; the square root of the distribution's alpha; from 0 to 1; default `0.3`.
        roughness: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across it; from 0 to 1; default `0`.
        anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u, or around the y axis of meshes without texture coordinates (degrees); from -360 to 360; default `0`.
        rotation: f32,
        /// Distribution of the normals of microfacets, with long tails or without: `ggx`, `beckmann`; default `ggx`.
        distribution: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// The sides that the camera sees: both, or the front, where a triangle's vertices run counter-clockwise; light reaches both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// Glass, water or diamond; frosted glass if it is rough.
    Dielectric = "dielectric" {
        /// Instead of eta and dispersion: a measured glass: `none`, `acrylic`, `baf10`, `bk7`, `diamond`, `fk51a`, `lasf9`, `polycarbonate`, `sapphire`, `sf10`, `sf11`, `sf5`, `silica`, `water`; default `none`.
        glass: &str,
        /// Refractive index of the inside relative to the outside; from 0.1 to 10; default `1.5`.
        eta: f32,
        /// Dispersion: 20 divided by the Abbe number, so 0.31 for window glass, 0.55 for flint glass, 0.36 for diamond; from 0 to 20; default `0`.
        dispersion: f32,
        /// Factor on reflected and transmitted light; white for real glass; from 0 to 1; default `1`.
        tint: impl Into<crate::Value>,
        /// Absorption coefficient inside (Beer-Lambert law) (1/m); from 0 to 1e6; default `0`.
        absorption: bilux_math::Rgb,
        /// Scattering coefficient inside: 1 over the mean distance that light travels before it is scattered (1/m); from 0 to 1e6; default `0`.
        scattering: bilux_math::Rgb,
        /// The directions that the inside scatters into: by one number (henyey-greenstein), as air (rayleigh), as dust (draine), or as fog, by the size of its droplets: `henyey-greenstein`, `rayleigh`, `draine`, `droplets`; default `henyey-greenstein`.
        phase: &str,
        /// The mean cosine by which henyey-greenstein and draine scatter: 0 is even, 0.9 nearly straight on, negative back; from -0.99 to 0.99; default `0`.
        scattering_anisotropy: f32,
        /// The second number of draine: 0 is henyey-greenstein; 1 without anisotropy is rayleigh; from 0 to 1000; default `1`.
        draine_alpha: f32,
        /// The diameter of droplets: 5 to 15 in clouds, 10 to 20 in fog, 50 in mist (µm); from 5 to 50; default `15`.
        droplet_diameter: f32,
        /// Nested dielectrics: where two overlap, the one with the higher priority fills the overlap, of equal ones the one inside the other, and eta is relative to air; 0 ignores overlaps, but glass whose faces lie on those of other glass touches it, and counts as 1; from 0 to 1000; default `0`.
        priority: i32,
        /// Thin-walled: light passes straight through without refraction; default `false`.
        thin: bool,
        /// Microfacet roughness: 0 is perfectly smooth; the square root of the distribution's alpha; from 0 to 1; default `0`.
        roughness: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across it; from 0 to 1; default `0`.
        anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u, or around the y axis of meshes without texture coordinates (degrees); from -360 to 360; default `0`.
        rotation: f32,
        /// Distribution of the normals of microfacets, with long tails or without: `ggx`, `beckmann`; default `ggx`.
        distribution: &str,
        /// Maximum angle by which reflected rays spread, in cook only (degrees); from 0 to 90; default `0`.
        gloss: f32,
        /// Maximum angle by which refracted rays spread, in cook only (degrees); from 0 to 90; default `0`.
        translucency: f32,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// The boundary of fog, smoke or a cloud, which light passes straight through.
    Interface = "interface" {
        /// Absorption coefficient inside (Beer-Lambert law) (1/m); from 0 to 1e6; default `0`.
        absorption: bilux_math::Rgb,
        /// Scattering coefficient inside: 1 over the mean distance that light travels before it is scattered (1/m); from 0 to 1e6; default `0`.
        scattering: bilux_math::Rgb,
        /// Factor on absorption and scattering inside, from a grid: smoke, a cloud; default `none`.
        density: impl Into<crate::Value>,
        /// The directions that the inside scatters into: by one number (henyey-greenstein), as air (rayleigh), as dust (draine), or as fog, by the size of its droplets: `henyey-greenstein`, `rayleigh`, `draine`, `droplets`; default `henyey-greenstein`.
        phase: &str,
        /// The mean cosine by which henyey-greenstein and draine scatter: 0 is even, 0.9 nearly straight on, negative back; from -0.99 to 0.99; default `0`.
        scattering_anisotropy: f32,
        /// The second number of draine: 0 is henyey-greenstein; 1 without anisotropy is rayleigh; from 0 to 1000; default `1`.
        draine_alpha: f32,
        /// The diameter of droplets: 5 to 15 in clouds, 10 to 20 in fog, 50 in mist (µm); from 5 to 50; default `15`.
        droplet_diameter: f32,
        /// Radiance of the inside where it is too thick to see through; it emits this times its absorption per metre: fire (W/(m² sr)); from 0 to 1e9; default `0`.
        medium_emission: bilux_math::Rgb,
        /// Factor on medium_emission, from a grid; default `none`.
        medium_emission_grid: impl Into<crate::Value>,
        /// Grid of temperatures: the inside emits as a black body, medium_emission where it is hottest; default `none`.
        temperature: impl Into<crate::Value>,
        /// Kelvins for each unit of the temperature grid (K); from 0 to 1e6; default `1`.
        temperature_scale: f32,
        /// Which maximum counts as 1: of the light of the hottest place, as physics has it; or of each temperature's spectrum (peak), as pbrt has it, where cool fire is brighter: `hottest`, `peak`; default `hottest`.
        temperature_norm: &str,
        /// Where media overlap, the one with the higher priority fills the overlap, of equal ones the one inside the other; 0 is the same as 1; from 0 to 1000; default `0`.
        priority: i32,
    }
    /// Plastic, metal, paint, glass: one material for nearly everything.
    Principled = "principled" {
        /// Colour of the diffuse part, and of metal at normal incidence; from 0 to 1; default `0.8`.
        base_color: impl Into<crate::Value>,
        /// Roughness of the diffuse part: 0 is Lambertian, 1 is like clay or the moon; from 0 to 1; default `0`.
        base_diffuse_roughness: impl Into<crate::Value>,
        /// Fraction of the surface that is metal; from 0 to 1; default `0`.
        base_metalness: impl Into<crate::Value>,
        /// Factor on specular reflection at normal incidence; from 0 to 1; default `1`.
        specular_weight: impl Into<crate::Value>,
        /// Colour of specular reflection; of metal, near grazing angles; from 0 to 1; default `1`.
        specular_color: impl Into<crate::Value>,
        /// Microfacet roughness: 0 is perfectly smooth; the square root of GGX's alpha; from 0 to 1; default `0.3`.
        specular_roughness: impl Into<crate::Value>,
        /// Refractive index of the non-metallic part; from 1 to 10; default `1.5`.
        specular_ior: impl Into<crate::Value>,
        /// Anisotropy: how much smoother the surface is along its tangent than across it; from 0 to 1; default `0`.
        specular_roughness_anisotropy: impl Into<crate::Value>,
        /// Rotation of the anisotropy's direction, which is along u (turns); from -1 to 1; default `0`.
        anisotropy_rotation: impl Into<crate::Value>,
        /// Fraction of the non-metallic part that transmits light; from 0 to 1; default `0`.
        transmission_weight: impl Into<crate::Value>,
        /// Colour of transmitted light: at each surface, or after transmission_depth inside; from 0 to 1; default `1`.
        transmission_color: impl Into<crate::Value>,
        /// Distance inside after which light has transmission_color; 0 tints it at the surface (m); from 0 to 1e6; default `0`.
        transmission_depth: f32,
        /// Scattering inside, per transmission_depth: milky glass, juice, murky water; ignored without a depth; from 0 to 1000; default `0`.
        transmission_scatter: bilux_math::Rgb,
        /// Mean cosine of scattering inside: 0 is even, 0.9 nearly straight on, negative back; from -1 to 1; default `0`.
        transmission_scatter_anisotropy: f32,
        /// Scale of the dispersion that transmission_dispersion_abbe_number gives; from 0 to 1; default `0`.
        transmission_dispersion_scale: f32,
        /// Abbe number; lower values disperse more: 64 for window glass, 36 for flint glass; from 1 to 10000; default `20`.
        transmission_dispersion_abbe_number: f32,
        /// Fraction of the opaque part that lets light in and scatters it below the surface: skin, wax, milk, marble; from 0 to 1; default `0`.
        subsurface_weight: impl Into<crate::Value>,
        /// Colour that a thick body of it has, seen straight on, between its highlights; from 0 to 1; default `0.8`.
        subsurface_color: impl Into<crate::Value>,
        /// How far light travels inside, on average, before it is scattered; 0 is a diffuse surface (m); from 0 to 1e6; default `1`.
        subsurface_radius: f32,
        /// Factor on subsurface_radius for red, green and blue; from 0 to 1; default `1 0.5 0.25`.
        subsurface_radius_scale: bilux_math::Rgb,
        /// Mean cosine of scattering below the surface; of thin walls, from -1, all reflected, to 1, all transmitted; from -1 to 1; default `0`.
        subsurface_scatter_anisotropy: f32,
        /// Thin-walled: light passes straight through without refraction; default `false`.
        thin_walled: bool,
        /// Nested dielectrics: where two overlap, the one with the higher priority fills the overlap, of equal ones the one inside the other, and eta is relative to air; 0 ignores overlaps, but glass whose faces lie on those of other glass touches it, and counts as 1; from 0 to 1000; default `0`.
        priority: i32,
        /// Weight of the clear coat; from 0 to 1; default `0`.
        coat_weight: impl Into<crate::Value>,
        /// Colour of light that passes the coat and returns; from 0 to 1; default `1`.
        coat_color: impl Into<crate::Value>,
        /// Microfacet roughness: 0 is perfectly smooth; the square root of GGX's alpha; from 0 to 1; default `0`.
        coat_roughness: impl Into<crate::Value>,
        /// Refractive index of the coat; from 1 to 10; default `1.6`.
        coat_ior: impl Into<crate::Value>,
        /// Normal map of the coat; without it the coat is as smooth as the mesh; default `none`.
        coat_normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        coat_normal_scale: f32,
        /// Weight of the fuzz: fine fibres, as on velvet; from 0 to 1; default `0`.
        fuzz_weight: impl Into<crate::Value>,
        /// Colour of the fibres; from 0 to 1; default `1`.
        fuzz_color: impl Into<crate::Value>,
        /// Roughness of the fuzz; low for upright fibres that show only at grazing angles; from 0 to 1; default `0.5`.
        fuzz_roughness: impl Into<crate::Value>,
        /// Fraction of the diffuse part that is transmitted to the back, as in a leaf; from 0 to 1; default `0`.
        diffuse_transmission_weight: impl Into<crate::Value>,
        /// Colour of diffuse transmission; from 0 to 1; default `1`.
        diffuse_transmission_color: impl Into<crate::Value>,
        /// Weight of the thin film; from 0 to 1; default `0`.
        thin_film_weight: impl Into<crate::Value>,
        /// Thickness of the thin film (µm); from 0 to 10; default `0.5`.
        thin_film_thickness: impl Into<crate::Value>,
        /// Refractive index of the thin film; from 1 to 10; default `1.4`.
        thin_film_ior: impl Into<crate::Value>,
        /// Emitted radiance (W/(m² sr)); from 0 to 1e12; default `0`.
        emission: impl Into<crate::Value>,
        /// Factor on the emission; from 0 to 1e12; default `1`.
        emission_scale: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, where a triangle's vertices run counter-clockwise in its own mesh; a mirrored copy keeps its front: `both`, `front`; default `both`.
        emission_sides: &str,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// The sides that the camera sees: both, or the front, where a triangle's vertices run counter-clockwise; light reaches both: `both`, `front`; default `both`.
        visible_sides: &str,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
    /// A mixture of two materials.
    Mix = "mix" {
        /// The name of the first material; it has to be given.
        a: impl Into<crate::Value>,
        /// The name of the second material, which may be a mix itself; it has to be given.
        b: impl Into<crate::Value>,
        /// Weight of the second material; from 0 to 1; default `0.5`.
        amount: impl Into<crate::Value>,
        /// Opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace; from 0 to 1; default `1`.
        opacity: impl Into<crate::Value>,
        /// Normal map in tangent space, with green up as in OpenGL and glTF; default `none`.
        normal: impl Into<crate::Value>,
        /// Strength of the normal map; from 0 to 10; default `1`.
        normal_scale: f32,
    }
}
