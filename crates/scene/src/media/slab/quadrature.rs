//! Nodes and weights of numerical integration.

/// Nodes in 0..=1, ascending, and their weights.
pub(super) struct Quadrature {
    pub(super) nodes: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

impl Quadrature {
    /// Exact for polynomials of degree `2 n - 1`: Gauss.
    pub(super) fn gauss(n: usize) -> Quadrature {
        let nodes = roots(n, |x| legendre(n, x));
        let weights = nodes.iter().map(|&x| {
            let (_, slope) = legendre(n, x);
            2.0 / ((1.0 - x * x) * slope * slope)
        });
        Quadrature { weights: weights.collect(), nodes }.on_unit_interval()
    }

    /// Exact for polynomials of degree `2 n - 2`, with a node at 1: Radau.
    pub(super) fn radau(n: usize) -> Quadrature {
        // With the node at -1: roots of the sum of two Legendre polynomials, without the one that is known.
        let polynomial = |x: f64| {
            let ((a, slope_a), (b, slope_b)) = (legendre(n - 1, x), legendre(n, x));
            let (sum, slope) = (a + b, slope_a + slope_b);
            (sum / (1.0 + x), (slope - sum / (1.0 + x)) / (1.0 + x))
        };
        let mut nodes = roots(n - 1, polynomial);
        let square = (n * n) as f64;
        let weight = |&x: &f64| {
            let (value, _) = legendre(n - 1, x);
            (1.0 - x) / (square * value * value)
        };
        let mut weights: Vec<f64> = nodes.iter().map(weight).collect();
        nodes.insert(0, -1.0);
        weights.insert(0, 2.0 / square);
        nodes.reverse();
        weights.reverse();
        nodes.iter_mut().for_each(|x| *x = -*x);
        Quadrature { nodes, weights }.on_unit_interval()
    }

    fn on_unit_interval(mut self) -> Quadrature {
        self.nodes.iter_mut().for_each(|x| *x = 0.5 * (*x + 1.0));
        self.weights.iter_mut().for_each(|w| *w *= 0.5);
        self
    }

    /// Appends another quadrature, moved to an interval, behind these nodes.
    pub(super) fn followed_by(&mut self, other: &Quadrature, [from, to]: [f64; 2]) {
        self.nodes.extend(other.nodes.iter().map(|x| from + (to - from) * x));
        self.weights.extend(other.weights.iter().map(|w| (to - from) * w));
    }
}

/// A Legendre polynomial and its slope, except at -1 and 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

/// The roots, all in -1..1, of a polynomial of this degree, ascending. Newton's method from beyond the largest of those that are
/// left finds it, where the ones that are known are divided out.
fn roots(degree: usize, polynomial: impl Fn(f64) -> (f64, f64)) -> Vec<f64> {
    let mut roots: Vec<f64> = Vec::with_capacity(degree);
    let mut x = 1.05;
    for _ in 0..degree {
        for _ in 0..100 {
            let (value, slope) = polynomial(x);
            let known: f64 = roots.iter().map(|root| 1.0 / (x - root)).sum();
            let step = value / (slope - value * known);
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        roots.push(x);
        // The next one is below: beyond this one, all is as if it were not there.
        x -= 1e-6;
    }
    roots.reverse();
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for n in [1, 2, 3, 8, 17, 40] {
            for (quadrature, degree) in [(Quadrature::gauss(n), 2 * n - 1), (Quadrature::radau(n), 2 * n - 2)]
            {
                let Quadrature { nodes, weights } = quadrature;
                assert!(nodes.is_sorted() && nodes.len() == n);
                let mut powers = vec![1.0; n];
                for power in 0..=degree {
                    let integral: f64 = powers.iter().zip(&weights).map(|(x, w)| x * w).sum();
                    assert!((integral * (power + 1) as f64 - 1.0).abs() < 1e-11, "{n} {power}: {integral}");
                    powers.iter_mut().zip(&nodes).for_each(|(power, x)| *power *= x);
                }
            }
            assert_eq!(Quadrature::radau(n).nodes.last(), Some(&1.0));
        }
    }
}
