//! Slabs: how much light a plane-parallel body reflects and passes, all orders of scattering together, by adding and doubling.
//! [Hulst 1980] The inside may have another index than the air around it.
//!
//! Intensities are kept at nodes of the cosine. Where the inside is denser, light beyond the critical angle stays inside; the
//! nodes have a border there, since the answer has a kink.

mod albedo;
mod matrix;
mod quadrature;

pub use albedo::absorbed_fraction;

use matrix::Matrix;
use quadrature::Quadrature;

/// A plane-parallel body that scatters by Henyey and Greenstein's phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The fraction of extinction that is absorption: one minus the albedo, 0..=1.
    pub absorbed: f64,
    /// Optical thickness; infinite for a half space.
    pub thickness: f64,
    /// Mean cosine of the phase function, between -1 and 1.
    pub anisotropy: f64,
    /// Refractive index relative to what is around, at least 1.
    pub eta: f64,
}

/// Fractions of light that arrives at normal incidence; what is left is absorbed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabLight {
    /// The fraction that the boundary reflects at once.
    pub at_surface: f64,
    /// The fraction that comes back out of the inside.
    pub from_inside: f64,
    /// The fraction that leaves on the other side.
    pub passed: f64,
}

impl Slab {
    /// Follows light by `nodes` on each side of the critical angle, at least 2. Eight find it to about a thousandth.
    pub fn light(&self, nodes: usize) -> SlabLight {
        let Quadrature { nodes: mu, weights } = self.directions(nodes);
        let side = mu.len();
        let [reflecting, passing] = self.layer(&mu, &weights, nodes);
        let inside = |i: usize| if self.eta > 1.0 { fresnel(mu[i], self.eta) } else { 0.0 };
        let (identity, boundary) = (Matrix::identity(side), Matrix::diagonal(side, inside));
        // Downwards at the bottom, per light downwards at the top; and upwards at the top.
        let through = (&identity - &(&reflecting * &boundary)).solve(passing.clone());
        let back = &reflecting + &(&passing * &(&boundary * &through));
        let at_surface = fresnel(1.0, self.eta);
        let mut arriving = vec![0.0; side];
        arriving[side - 1] = (1.0 - at_surface) / (2.0 * mu[side - 1] * weights[side - 1]);
        let entering = (&identity - &(&boundary * &back)).solve(column(&arriving));
        let entering: Vec<f64> = entering.times(&first(side));
        let leaving = |light: Vec<f64>| {
            let flux = |(i, light): (usize, f64)| 2.0 * weights[i] * mu[i] * (1.0 - inside(i)) * light;
            light.into_iter().enumerate().map(flux).sum::<f64>()
        };
        SlabLight {
            at_surface,
            from_inside: leaving(back.times(&entering)),
            passed: leaving(through.times(&entering)),
        }
    }

    /// Cosines inside, the last of them 1.
    fn directions(&self, nodes: usize) -> Quadrature {
        if self.eta <= 1.0 {
            return Quadrature::radau(nodes);
        }
        let critical = (1.0 - 1.0 / (self.eta * self.eta)).sqrt();
        let mut all = Quadrature { nodes: Vec::new(), weights: Vec::new() };
        all.followed_by(&Quadrature::gauss(nodes), [0.0, critical]);
        all.followed_by(&Quadrature::radau(nodes), [critical, 1.0]);
        all
    }

    /// Reflection and transmission of a layer of this thickness, without boundaries: the intensity at each node (row) per
    /// intensity at each node.
    ///
    /// The peak of the phase function that the nodes cannot resolve counts as light that goes straight on. [Wiscombe 1977]
    fn layer(&self, mu: &[f64], weights: &[f64], orders: usize) -> [Matrix; 2] {
        let peak = (0..orders).fold(1.0, |power, _| power * self.anisotropy);
        let albedo = 1.0 - self.absorbed;
        let thickness = self.thickness * (1.0 - albedo * peak);
        let absorbed = self.absorbed / (1.0 - albedo * peak);
        let [on, back] = self.redistribution(mu, orders, peak);
        let side = mu.len();
        // A layer that is thin for every node, doubled until it has the thickness, or until nothing comes through.
        let thin = mu[0] * THIN;
        let mut doublings = 0;
        let mut start = thickness;
        if thickness.is_infinite() {
            (doublings, start) = (MAX_DOUBLINGS, thin);
        }
        while start > thin {
            (doublings, start) = (doublings + 1, 0.5 * start);
        }
        let half = 0.5 * start;
        let scattered = 0.5 * (1.0 - absorbed);
        let lost = Matrix::from_fn(side, |i, j| {
            let straight = if i == j { 1.0 } else { 0.0 };
            (straight - scattered * on[i * side + j] * weights[j]) * half / mu[i]
        });
        let turned = Matrix::from_fn(side, |i, j| scattered * back[i * side + j] * weights[j] * half / mu[i]);
        let mut layer = thin_layer(&lost, &turned);
        for _ in 0..doublings {
            layer = doubled(&layer);
            if thickness.is_infinite() && layer[1].largest() < OPAQUE {
                break;
            }
        }
        layer
    }

    /// The phase function between nodes, averaged around the normal, in rows: on, and back.
    fn redistribution(&self, mu: &[f64], orders: usize, peak: f64) -> [Vec<f64>; 2] {
        let polynomials: Vec<Vec<f64>> = mu.iter().map(|&x| legendre_polynomials(x, orders)).collect();
        let mut moments = Vec::with_capacity(orders);
        let mut power = 1.0;
        for order in 0..orders {
            moments.push((2 * order + 1) as f64 * (power - peak) / (1.0 - peak));
            power *= self.anisotropy;
        }
        let mut found = [Vec::new(), Vec::new()];
        for (a, b) in polynomials.iter().flat_map(|a| polynomials.iter().map(move |b| (a, b))) {
            let mut sums = [0.0; 2];
            for (order, moment) in moments.iter().enumerate() {
                let term = moment * a[order] * b[order];
                sums[0] += term;
                sums[1] += if order % 2 == 0 { term } else { -term };
            }
            found.iter_mut().zip(sums).for_each(|(all, sum)| all.push(sum));
        }
        found
    }
}

/// The optical thickness of the first layer, as a fraction of the smallest cosine.
const THIN: f64 = 1.0 / 256.0;
/// Doublings of a half space that loses nothing, through which some light would always come.
const MAX_DOUBLINGS: u32 = 44;
/// Transmission below which a layer counts as a half space.
const OPAQUE: f64 = 1e-9;

/// A layer so thin that intensities in it are the means of those on its sides. [Wiscombe 1976]
fn thin_layer(lost: &Matrix, turned: &Matrix) -> [Matrix; 2] {
    let identity = Matrix::identity(lost.side);
    let kept = (&identity + lost).solve(identity.clone());
    let both = &(&identity + lost) - &(turned * &(&kept * turned));
    let mean = both.solve(identity.clone());
    let reflecting = (&mean * &(turned * &kept)).scaled(2.0);
    [reflecting, &mean.scaled(2.0) - &identity]
}

/// Two of the same, one on the other.
fn doubled([reflecting, passing]: &[Matrix; 2]) -> [Matrix; 2] {
    let identity = Matrix::identity(reflecting.side);
    // Light between the two, per light that arrives from above.
    let between = (&identity - &(reflecting * reflecting)).solve(passing.clone());
    [reflecting + &(passing * &(reflecting * &between)), passing * &between]
}

fn legendre_polynomials(x: f64, count: usize) -> Vec<f64> {
    let mut all = Vec::with_capacity(count);
    let (mut before, mut value) = (0.0, 1.0);
    for k in 1..=count {
        all.push(value);
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    all
}

/// The fraction of unpolarised light that a boundary reflects inside, by the cosine there. [Fresnel 1823]
fn fresnel(mu: f64, eta: f64) -> f64 {
    let square = 1.0 - eta * eta * (1.0 - mu * mu);
    if square <= 0.0 {
        return 1.0;
    }
    let outside = square.sqrt();
    let across = (eta * mu - outside) / (eta * mu + outside);
    let along = (mu - eta * outside) / (mu + eta * outside);
    0.5 * (across * across + along * along)
}

/// A matrix whose first column is this.
fn column(values: &[f64]) -> Matrix {
    Matrix::from_fn(values.len(), |row, column| if column == 0 { values[row] } else { 0.0 })
}

fn first(side: usize) -> Vec<f64> {
    (0..side).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(albedo: f64, thickness: f64, anisotropy: f64, eta: f64, nodes: usize) -> SlabLight {
        Slab { absorbed: 1.0 - albedo, thickness, anisotropy, eta }.light(nodes)
    }

    /// Albedo, thickness, mean cosine, index; what is reflected and passed at normal incidence, by discrete ordinates with 40 nodes
    /// in each hemisphere.
    const SLABS: &[(f64, f64, f64, f64, f64, f64)] = &[
        (1.0, 0.5, 0.0, 1.0, 0.2025060, 0.7974940),
        (0.9, 0.5, 0.0, 1.0, 0.1690395, 0.7653830),
        (0.9, 2.0, 0.0, 1.0, 0.3616489, 0.3565007),
        (0.9, 8.0, 0.0, 1.0, 0.4148432, 0.0160196),
        (0.5, 2.0, 0.0, 1.0, 0.1128332, 0.1893215),
        (1.0, 2.0, 0.5, 1.0, 0.3203002, 0.6796998),
        (0.9, 2.0, 0.5, 1.0, 0.2045074, 0.5232734),
        (1.0, 2.0, 0.75, 1.0, 0.1631761, 0.8368239),
        // Printed in [Hulst 1980]: 0.09739, 0.66096.
        (0.9, 2.0, 0.75, 1.0, 0.0973946, 0.6609577),
        (1.0, 2.0, -0.3, 1.0, 0.5876700, 0.4123300),
        (1.0, 1.0, 0.0, 1.5, 0.3589481, 0.6410519),
        (0.9, 2.0, 0.0, 1.5, 0.2530758, 0.2887986),
        (0.9, 2.0, 0.75, 1.5, 0.1268222, 0.4931464),
    ];

    #[test]
    fn slabs_are_those_of_discrete_ordinates() {
        for &(albedo, thickness, anisotropy, eta, reflected, passed) in SLABS {
            let light = of(albedo, thickness, anisotropy, eta, 24);
            let errors = [light.at_surface + light.from_inside - reflected, light.passed - passed];
            assert!(
                errors.iter().all(|error| error.abs() < 1.2e-5),
                "{albedo} {thickness} {anisotropy} {eta}: {errors:?}"
            );
        }
    }

    /// Half spaces against discrete ordinates; the first is that of [Giovanelli 1955], who prints 0.2600.
    #[test]
    fn half_spaces_are_those_of_discrete_ordinates() {
        for (albedo, anisotropy, eta, reflected) in [
            (0.9, 0.0, 1.5, 0.25991857),
            (0.999, 0.0, 1.5, 0.8414585),
            (0.99, 0.0, 1.5, 0.6019808),
            (0.5, 0.0, 1.5, 0.0842459),
            (0.999, 0.8, 1.5, 0.6913198),
            (0.99, 0.8, 1.5, 0.3604392),
            (0.9, 0.8, 1.5, 0.0952528),
            (0.99, 0.8, 1.0, 0.5219133),
            (0.9, 0.8, 1.0, 0.1362080),
            (0.9, 0.0, 1.0, 0.4149475),
            (0.999, 0.0, 1.0, 0.9128453),
        ] {
            let light = of(albedo, f64::INFINITY, anisotropy, eta, 24);
            let error = light.at_surface + light.from_inside - reflected;
            assert!(error.abs() < 2e-5, "{albedo} {anisotropy} {eta}: {error}");
            assert!(light.passed < 1e-8);
        }
    }

    #[test]
    fn nothing_is_lost_where_nothing_absorbs() {
        for (thickness, anisotropy, eta) in [(f64::INFINITY, 0.5, 1.4), (3.0, 0.9, 1.0), (0.01, -0.5, 2.4)] {
            let light = of(1.0, thickness, anisotropy, eta, 8);
            // Forty doublings round often.
            assert!((light.at_surface + light.from_inside + light.passed - 1.0).abs() < 1e-5, "{light:?}");
        }
    }
}
