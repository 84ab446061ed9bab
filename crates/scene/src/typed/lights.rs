//! Lights as Rust types. Generated from their table by `cargo xtask docs`; do not edit by hand.

typed! {
    /// Isotropic point light.
    Point = "point" {
        /// Position (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// Intensity in every direction (W/sr); from 0 to 1e12; default `100`.
        intensity: bilux_math::Rgb,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Distant light: parallel rays, or those of a disc such as the sun.
    Directional = "directional" {
        /// Direction in which the light travels (m); default `-1 -1 -1`.
        direction: bilux_math::Vec3,
        /// Irradiance on a surface that faces it (W/m²); from 0 to 1e12; default `3`.
        irradiance: bilux_math::Rgb,
        /// Angular diameter, which softens the edges of shadows: 0.533 for the sun, 0 for a point (degrees); from 0 to 180; default `0`.
        diameter: f32,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Spotlight: a point light that shines into a cone, with a soft edge.
    Spot = "spot" {
        /// Position (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// The point at the centre of the cone (m); default `0 0 0`.
        look_at: bilux_math::Vec3,
        /// Intensity along its axis (W/sr); from 0 to 1e12; default `100`.
        intensity: bilux_math::Rgb,
        /// Angle from the axis to the edge of the cone (degrees); from 0 to 180; default `30`.
        angle: f32,
        /// Angle from the axis at which it begins to fade (degrees); from 0 to 180; default `25`.
        inner_angle: f32,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Lamp with a measured intensity distribution, from an IES or EULUMDAT file.
    Luminaire = "luminaire" {
        /// Position (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// Direction of its axis, from which γ is measured: down for a lamp that hangs (m); default `0 -1 0`.
        direction: bilux_math::Vec3,
        /// Direction of the half plane C 0, which is made perpendicular to the axis (m); default `1 0 0`.
        c0: bilux_math::Vec3,
        /// Intensity over direction: a file (.ies, .ldt); none is the same in all directions, 1000 lm; default `none`.
        distribution: impl Into<crate::Value>,
        /// What it emits in all directions together; -1 takes the lumens of the file, 683 of which are 1 W (W); from -1 to 1e12; default `-1`.
        flux: bilux_math::Rgb,
        /// Factor on its light, such as its colour; from 0 to 1e12; default `1`.
        scale: bilux_math::Rgb,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Rectangular area light, visible to the camera.
    Rect = "rect" {
        /// Centre (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// Edge from one side to the other (m); default `1 0 0`.
        edge_u: bilux_math::Vec3,
        /// Edge from one end to the other (m); default `0 0 1`.
        edge_v: bilux_math::Vec3,
        /// Emitted radiance; or give 'intensity' (W/(m² sr)); from 0 to 1e12; default `0`.
        radiance: bilux_math::Rgb,
        /// Radiance times area, which stays the same when the panel shrinks (W/sr); from 0 to 1e12; default `0`.
        intensity: bilux_math::Rgb,
        /// Which sides emit light: both, or the front, to which edge_u × edge_v points: `both`, `front`; default `both`.
        sides: &str,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Spherical area light, visible to the camera.
    Sphere = "sphere" {
        /// Centre (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// Radius; above 0 (m); from 0 to 1e12; default `0.5`.
        radius: f32,
        /// Emitted radiance; or give 'intensity' (W/(m² sr)); from 0 to 1e12; default `0`.
        radiance: bilux_math::Rgb,
        /// Radiance times the area of its disc, which stays the same when the sphere shrinks (W/sr); from 0 to 1e12; default `0`.
        intensity: bilux_math::Rgb,
        /// Colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π; from -1 to 1e6; default `-1`.
        classic: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Environment light: a constant colour, a vertical gradient, or an environment map.
    Environment = "environment" {
        /// Radiance from every direction; a texture is a longitude-latitude map, with its centre towards -z (W/(m² sr)); from 0 to 1e12; default `1`.
        radiance: impl Into<crate::Value>,
        /// Factor on the whole light; from 0 to 1e12; default `1`.
        scale: bilux_math::Rgb,
        /// Rotation of the environment map about the y axis, to the right (degrees); from -360 to 360; default `0`.
        rotation: f32,
        /// Radiance from straight above; -1 uses 'radiance' (W/(m² sr)); from -1 to 1e12; default `-1`.
        zenith: bilux_math::Rgb,
        /// Radiance from the horizon; -1 uses 'radiance' (W/(m² sr)); from -1 to 1e12; default `-1`.
        horizon: bilux_math::Rgb,
        /// Radiance from straight below; -1 uses 'radiance' (W/(m² sr)); from -1 to 1e12; default `-1`.
        ground: bilux_math::Rgb,
        /// Show it to the camera in place of the environments that light the scene; it lights nothing itself; default `false`.
        backdrop: bool,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Analytic daylight sky with the sun, clear or hazy.
    Sky = "sky" {
        /// Elevation of the sun (degrees); from 0 to 90; default `40`.
        elevation: f32,
        /// Azimuth of the sun, to the right of -z (degrees); from -360 to 360; default `50`.
        azimuth: f32,
        /// Turbidity: 2 is clear, 10 is hazy; from 1.7 to 10; default `3`.
        turbidity: f32,
        /// Albedo of the ground; from 0 to 1e12; default `0.2`.
        ground: bilux_math::Rgb,
        /// Factor on the whole light: at 1 it is about as bright as white paper in the midday sun; from 0 to 1e12; default `1`.
        scale: bilux_math::Rgb,
        /// Factor on the sun only; from 0 to 1e6; default `1`.
        sun_scale: f32,
        /// Angular diameter of the sun (degrees); from 0.01 to 90; default `0.533`.
        sun_diameter: f32,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Standard general sky of the CIE, from overcast to clear, with the light that it is to give.
    CieSky = "cie-sky" {
        /// Its number: 1 overcast, 5 uniform, 7 partly cloudy, 12 clear, 13 clear and polluted, 15 turbid, 16 traditional overcast; from 1 to 16; default `1`.
        standard: i32,
        /// Elevation of the sun (degrees); from -90 to 90; default `40`.
        elevation: f32,
        /// Azimuth of the sun, from the north (-z) to the east (+x) (degrees); from -360 to 360; default `135`.
        azimuth: f32,
        /// Irradiance of level ground by the sky without the sun (W/m²); from 0 to 1e12; default `1`.
        irradiance: bilux_math::Rgb,
        /// Radiance of the zenith; if it is not 0, irradiance does not count (W/(m² sr)); from 0 to 1e12; default `0`.
        zenith: bilux_math::Rgb,
        /// Irradiance by the sun of a surface that faces it (W/m²); from 0 to 1e12; default `0`.
        sun: bilux_math::Rgb,
        /// Angular diameter of the sun (degrees); from 0.01 to 90; default `0.533`.
        sun_diameter: f32,
        /// Albedo of the ground; from 0 to 1e12; default `0.2`.
        ground: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// Sky of any weather, from the light of the sun and that of the sky as they were measured.
    PerezSky = "perez-sky" {
        /// Elevation of the sun (degrees); from -90 to 90; default `40`.
        elevation: f32,
        /// Azimuth of the sun, from the north (-z) to the east (+x) (degrees); from -360 to 360; default `135`.
        azimuth: f32,
        /// Irradiance by the sun of a surface that faces it (direct normal) (W/m²); from 0 to 1e12; default `3`.
        direct: bilux_math::Rgb,
        /// Irradiance of level ground by the sky (diffuse horizontal) (W/m²); from 0 to 1e12; default `1`.
        diffuse: bilux_math::Rgb,
        /// Clearness ε of the sky, from 1; 0 finds it from direct and diffuse; from 0 to 20; default `0`.
        clearness: f32,
        /// Brightness Δ of the sky; 0 finds it from diffuse, in lux; from 0 to 1; default `0`.
        brightness: f32,
        /// Angular diameter of the sun (degrees); from 0.01 to 90; default `0.533`.
        sun_diameter: f32,
        /// Albedo of the ground; from 0 to 1e12; default `0.2`.
        ground: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
    /// The constant light Ia of Equation 1, in cast, whitted and cook only.
    Ambient = "ambient" {
        /// Light that reaches every point equally; from 0 to 1e12; default `0.3`.
        colour: bilux_math::Rgb,
        /// The light group that it belongs to, for --aov groups; name stands for the light's own name; default `name`.
        group: &str,
    }
}
