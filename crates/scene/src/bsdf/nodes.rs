//! Quadrature over the hemisphere for albedos that depend on the cosine alone. Tables store them at its nodes too, so that all
//! nodes are looked up together.

/// The number of nodes.
pub(super) const NODES: usize = 8;

/// Gauss-Legendre nodes t, the roots of cosines, and their weights on 0..=1.
pub(super) const GAUSS: [(f32, f32); NODES] = [
    (0.019_855_07, 0.050_614_27),
    (0.101_666_76, 0.111_190_52),
    (0.237_233_8, 0.156_853_32),
    (0.408_282_7, 0.181_341_89),
    (0.591_717_3, 0.181_341_89),
    (0.762_766_2, 0.156_853_32),
    (0.898_333_24, 0.111_190_52),
    (0.980_144_9, 0.050_614_27),
];

/// The light at each node, where t² is the cosine, of which the fraction `gets_in` gets in, with the node's weight: terms of
/// ∫ g(µ) 2µ dµ.
pub(super) fn light_at_nodes(gets_in: &[f32; NODES]) -> [f32; NODES] {
    std::array::from_fn(|i| {
        let (t, w) = GAUSS[i];
        w * 4.0 * t * t * t * gets_in[i]
    })
}

/// A number between those of two rows, at each node.
#[inline(always)]
pub(super) fn lerp_nodes(a: &[f32; NODES], b: &[f32; NODES], share: f32) -> [f32; NODES] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}
