//! Lights by their types. Made from their table by `cargo xtask docs`; not edited by hand.

typed! {
    /// Isotropic point light.
    Point = "point" {
        /// Where it is (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// What it sends into each direction (W/sr); default `100`.
        intensity: bilux_math::Rgb,
        /// Colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π; default `-1`.
        classic: bilux_math::Rgb,
    }
    /// Distant light: parallel rays, or those of a disc such as the sun.
    Directional = "directional" {
        /// Where the light goes (m); default `-1 -1 -1`.
        direction: bilux_math::Vec3,
        /// What falls on a surface that faces it (W/m²); default `3`.
        irradiance: bilux_math::Rgb,
        /// Angle under which it is seen, which makes edges of shadows soft: 0.533 for the sun, 0 for a point (degrees); default `0`.
        diameter: f32,
        /// Colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π; default `-1`.
        classic: bilux_math::Rgb,
    }
    /// Spotlight: a point light that shines into a cone, with a soft edge.
    Spot = "spot" {
        /// Where it is (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// The point in the middle of the cone (m); default `0 0 0`.
        look_at: bilux_math::Vec3,
        /// What it sends along its axis (W/sr); default `100`.
        intensity: bilux_math::Rgb,
        /// From the axis to where it is dark (degrees); default `30`.
        angle: f32,
        /// From the axis to where it begins to fade (degrees); default `25`.
        inner_angle: f32,
        /// Colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π; default `-1`.
        classic: bilux_math::Rgb,
    }
    /// Rectangular area light, visible to the camera.
    Rect = "rect" {
        /// Its middle (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// From one side to the other (m); default `1 0 0`.
        edge_u: bilux_math::Vec3,
        /// From one end to the other (m); default `0 0 1`.
        edge_v: bilux_math::Vec3,
        /// What it gives out; or give intensity (W/(m² sr)); default `0`.
        radiance: bilux_math::Rgb,
        /// Radiance times area: kept while the panel shrinks (W/sr); default `0`.
        intensity: bilux_math::Rgb,
        /// Where it gives light: on both, or in front, which is where edge_u × edge_v points: `both`, `front`; default `both`.
        sides: &str,
        /// Colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π; default `-1`.
        classic: bilux_math::Rgb,
    }
    /// Spherical area light, visible to the camera.
    Sphere = "sphere" {
        /// Its middle (m); default `0 5 0`.
        position: bilux_math::Vec3,
        /// From its middle to its surface; above 0 (m); default `0.5`.
        radius: f32,
        /// What it gives out; or give intensity (W/(m² sr)); default `0`.
        radiance: bilux_math::Rgb,
        /// Radiance times the area of its disc: kept while the ball shrinks (W/sr); default `0`.
        intensity: bilux_math::Rgb,
        /// Colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π; default `-1`.
        classic: bilux_math::Rgb,
    }
    /// Environment light: a constant colour, a gradient of height, or an environment map.
    Environment = "environment" {
        /// What comes from every direction; a picture by longitude and latitude, its middle towards -z (W/(m² sr)); default `1`.
        radiance: impl Into<crate::Value>,
        /// Factor on all of it; default `1`.
        scale: bilux_math::Rgb,
        /// Turns a picture about the y axis, to the right (degrees); default `0`.
        rotation: f32,
        /// What comes from straight above; -1 for radiance (W/(m² sr)); default `-1`.
        zenith: bilux_math::Rgb,
        /// What comes from the sides; -1 for radiance (W/(m² sr)); default `-1`.
        horizon: bilux_math::Rgb,
        /// What comes from straight below; -1 for radiance (W/(m² sr)); default `-1`.
        ground: bilux_math::Rgb,
        /// Only to be seen, in place of the environments that light the scene: it lights nothing; default `false`.
        backdrop: bool,
    }
    /// Analytic daylight sky with its sun, clear or hazy.
    Sky = "sky" {
        /// How high the sun stands (degrees); default `40`.
        elevation: f32,
        /// Where it stands, to the right of -z (degrees); default `50`.
        azimuth: f32,
        /// Haze: 2 is clear, 10 is misty; default `3`.
        turbidity: f32,
        /// The part of its light that the ground far below sends on; default `0.2`.
        ground: bilux_math::Rgb,
        /// Factor on all of it: 1 is about as bright as white paper is in the midday sun; default `1`.
        scale: bilux_math::Rgb,
        /// Factor on the sun alone; default `1`.
        sun_scale: f32,
        /// Angle under which the sun is seen (degrees); default `0.533`.
        sun_diameter: f32,
    }
    /// The constant light Ia of Equation 1, in cast, whitted and cook only.
    Ambient = "ambient" {
        /// Light that is everywhere; default `0.3`.
        colour: bilux_math::Rgb,
    }
}
