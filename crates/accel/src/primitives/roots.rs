//! The roots of a quadratic.

/// Both roots of `a t² + 2 h t + c`, smaller first; the second is NaN where there is only one. `discriminant` is
/// `h² − a c`, which some callers can compute more accurately than by this formula.
pub(super) fn roots(a: f64, h: f64, c: f64, discriminant: f64) -> Option<[f64; 2]> {
    if a == 0.0 {
        return (h != 0.0).then(|| [-c / (2.0 * h), f64::NAN]);
    }
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    // The sum of two numbers of the same sign loses no digits. [Press 2007, 5.6]
    let q = -(h + discriminant.sqrt().copysign(h));
    let (s, t) = (q / a, if q == 0.0 { q / a } else { c / q });
    Some(if s <= t { [s, t] } else { [t, s] })
}

/// Drops the root nearest to zero, for a ray that starts on the surface.
pub(super) fn without_origin(roots: [f64; 2]) -> [f64; 2] {
    let [s, t] = roots;
    if s.abs() > t.abs() { [s, f64::NAN] } else { [f64::NAN, t] }
}
