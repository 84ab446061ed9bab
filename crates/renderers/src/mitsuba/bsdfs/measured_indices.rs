//! Indices of refraction by the names that Mitsuba has for them.

use bilux_math::Rgb;

/// The index of refraction and the extinction of conductors, as its RGB modes have them: the measured spectra, seen by
/// equal light of all wavelengths. [Jakob 2022]
const CONDUCTORS: &[(&str, [f32; 3], [f32; 3])] = &[
    ("Ag", [0.155, 0.117, 0.138], [4.828, 3.122, 2.147]),
    ("Al", [1.658, 0.880, 0.521], [9.224, 6.270, 4.837]),
    ("AlAs", [3.605, 3.233, 2.216], [0.001, 0.000, 0.008]),
    ("AlSb", [0.000, 4.139, 4.669], [0.000, 0.094, 1.301]),
    ("Au", [0.143, 0.375, 1.442], [3.983, 2.386, 1.603]),
    ("Be", [4.185, 3.185, 2.784], [3.835, 3.010, 2.869]),
    ("Cr", [4.370, 2.917, 1.655], [5.207, 4.231, 3.755]),
    ("CsI", [2.145, 1.702, 1.662], [0.000, 0.000, 0.000]),
    ("Cu", [0.201, 0.924, 1.102], [3.913, 2.453, 2.142]),
    ("Cu2O", [3.552, 2.950, 2.752], [0.114, 0.194, 0.606]),
    ("CuO", [3.248, 2.448, 2.210], [0.521, 0.570, 0.722]),
    ("Cu_palik", [0.213, 0.920, 1.102], [3.922, 2.457, 2.137]),
    ("Hg", [2.399, 1.440, 0.910], [6.328, 4.372, 3.422]),
    ("HgTe", [4.779, 3.231, 2.660], [1.632, 1.581, 1.729]),
    ("Ir", [3.086, 2.082, 1.618], [5.592, 4.067, 3.267]),
    ("K", [0.064, 0.046, 0.038], [2.104, 1.349, 0.913]),
    ("Li", [0.266, 0.196, 0.221], [3.540, 2.311, 1.669]),
    ("MgO", [2.090, 1.651, 1.595], [0.000, 0.000, 0.000]),
    ("Mo", [4.484, 3.525, 2.776], [4.111, 3.421, 3.151]),
    ("Na", [0.060, 0.056, 0.062], [3.179, 2.112, 1.579]),
    ("Nb", [3.420, 2.790, 2.396], [3.441, 2.738, 2.580]),
    ("Ni", [2.367, 1.663, 1.467], [4.499, 3.050, 2.345]),
    ("Rh", [2.586, 1.860, 1.554], [6.782, 4.703, 3.976]),
    ("Se", [4.058, 2.843, 2.821], [0.754, 0.638, 0.522]),
    ("Se-e", [5.723, 4.166, 4.081], [0.871, 1.105, 1.565]),
    ("SiC", [3.172, 2.526, 2.479], [0.000, 0.000, 0.000]),
    ("SnTe", [4.524, 1.982, 1.282], [0.000, 0.000, 0.000]),
    ("Ta", [2.063, 2.393, 2.628], [2.408, 1.741, 1.947]),
    ("Te", [7.390, 4.482, 2.637], [3.256, 3.527, 3.292]),
    ("Te-e", [7.509, 4.296, 2.370], [5.584, 4.947, 3.998]),
    ("ThF4", [1.831, 1.442, 1.388], [0.000, 0.000, 0.000]),
    ("TiC", [3.701, 2.837, 2.582], [3.266, 2.352, 2.173]),
    ("TiN", [1.648, 1.151, 1.380], [3.368, 1.943, 1.102]),
    ("TiO2", [3.457, 2.802, 2.905], [0.000, 0.000, 0.001]),
    ("TiO2-e", [3.107, 2.513, 2.582], [0.000, 0.000, 0.000]),
    ("VC", [3.658, 2.753, 2.533], [3.068, 2.199, 1.963]),
    ("VN", [2.866, 2.119, 1.940], [3.032, 2.056, 1.616]),
    ("V", [4.278, 3.513, 2.761], [3.491, 2.889, 3.112]),
    ("W", [4.371, 3.300, 2.998], [3.501, 2.605, 2.273]),
    ("a-C", [2.944, 2.227, 1.968], [0.887, 0.799, 0.815]),
    ("d-C", [2.709, 2.319, 2.229], [0.000, 0.000, 0.000]),
];

/// The index of refraction of dielectrics at 589 nm. [Jakob 2022]
const DIELECTRICS: &[(&str, f64)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The index of refraction and the extinction of a conductor.
pub(super) fn conductor(name: &str) -> Option<[Rgb; 2]> {
    let plain = name.strip_suffix("_palik").unwrap_or(name);
    let row = |name: &str| CONDUCTORS.iter().find(|(known, ..)| *known == name);
    let (_, eta, k) = row(name).or_else(|| row(plain))?;
    Some([Rgb::from_array(*eta), Rgb::from_array(*k)])
}

/// The names of conductors, for messages.
pub(super) fn conductors() -> impl Iterator<Item = &'static str> {
    CONDUCTORS.iter().map(|(name, ..)| *name).chain(["none"])
}

/// The index of refraction of a dielectric.
pub(super) fn dielectric(name: &str) -> Option<f64> {
    let name = name.to_lowercase();
    DIELECTRICS.iter().find(|(known, _)| *known == name).map(|(_, index)| *index)
}

/// The names of dielectrics, for messages.
pub(super) fn dielectrics() -> impl Iterator<Item = &'static str> {
    DIELECTRICS.iter().map(|(name, _)| *name)
}
