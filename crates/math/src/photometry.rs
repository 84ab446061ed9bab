//! Photometric units in radiometric ones.

/// The luminous flux in lumen of 1 W whose red, green and blue are equal.
///
/// By the definition of the candela, 1 W of light of 540 THz is 683 lm. The luminance of a linear Rec. 709 triple stands for the standard
/// observer's weighting of its spectrum, so a watt in every channel counts like one of that light. Luminous is `LUMENS_PER_WATT` times
/// radiant for candela and W/sr, for cd/m² and W/(m² sr), and for lux and W/m² too.
pub const LUMENS_PER_WATT: f32 = 683.0;
