//! An [`OpaqueBaseForWo`] as plain numbers, so that many of them can be kept in columns.

use super::OpaqueBaseForWo;
use crate::bsdf::Albedo;
use bilux_math::{Rgb, Vec3};

impl OpaqueBaseForWo {
    /// The number of numbers that it consists of.
    pub const NUMBERS: usize = 28;

    /// All of it, for keeping many in columns. There is no loop here that a compiler would have to unroll.
    #[inline(always)]
    pub fn to_numbers(self) -> [f32; OpaqueBaseForWo::NUMBERS] {
        let OpaqueBaseForWo { wo, glass, straight, dip, again, base, .. } = self;
        let [roughness, index, reflected] = self.albedo.to_numbers();
        let [a, b, c] = [self.alpha, self.eta, self.metalness];
        let [d, e, f, g] = [self.shadow, self.bound, self.gloss_share, self.strength];
        let [h, i, j] = [glass.r, glass.g, glass.b];
        let [k, l, m] = [straight.r, straight.g, straight.b];
        let [n, o, p] = [dip.r, dip.g, dip.b];
        let [q, r, s] = [again.r, again.g, again.b];
        let [t, u, v] = [base.r, base.g, base.b];
        [
            a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, roughness, index, reflected,
            wo.x, wo.y, wo.z,
        ]
    }

    /// The inverse of [`OpaqueBaseForWo::to_numbers`].
    #[inline(always)]
    pub fn from_numbers(numbers: [f32; OpaqueBaseForWo::NUMBERS]) -> OpaqueBaseForWo {
        let [
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            i,
            j,
            k,
            l,
            m,
            n,
            o,
            p,
            q,
            r,
            s,
            t,
            u,
            v,
            roughness,
            index,
            reflected,
            x,
            y,
            z,
        ] = numbers;
        OpaqueBaseForWo {
            wo: Vec3::new(x, y, z),
            alpha: a,
            eta: b,
            metalness: c,
            shadow: d,
            bound: e,
            gloss_share: f,
            strength: g,
            glass: Rgb::new(h, i, j),
            straight: Rgb::new(k, l, m),
            dip: Rgb::new(n, o, p),
            again: Rgb::new(q, r, s),
            base: Rgb::new(t, u, v),
            albedo: Albedo::from_numbers([roughness, index, reflected]),
        }
    }
}
