//! Blend shapes with shapes in between.

/// Amount of each shape at a value of the channel; `reached` is the value at which each shape is there alone. The channel runs in
/// straight lines from no shape, at 0, to the nearest one, from one to the next, and on beyond the last one. Below 0 it runs
/// through the shapes there or, if there are none, away from the first one. Shapes that are reached at 0 are not used.
pub fn amounts(reached: &[f64], channel: f64) -> Vec<f64> {
    let mut amounts = vec![0.0; reached.len()];
    let mut order: Vec<usize> = (0..reached.len()).filter(|&shape| reached[shape] != 0.0).collect();
    order.sort_by(|&a, &b| reached[a].total_cmp(&reached[b]));
    // Below zero it runs from none to the other side.
    let side = |shape: &usize| reached[*shape] > 0.0;
    let is_positive = channel > 0.0 || !order.iter().any(|shape| !side(shape));
    let mut on_side: Vec<usize> = order.into_iter().filter(|shape| side(shape) == is_positive).collect();
    if !is_positive {
        on_side.reverse();
    }
    let is_beyond = |shape: f64| if is_positive { shape > channel } else { shape < channel };
    let next = on_side.iter().position(|&shape| is_beyond(reached[shape]));
    let Some(last) = on_side.len().checked_sub(1) else { return amounts };
    let next = next.unwrap_or(last);
    let before = next.checked_sub(1).map(|i| on_side[i]);
    let from = before.map_or(0.0, |shape| reached[shape]);
    let part = (channel - from) / (reached[on_side[next]] - from);
    if part.is_finite() {
        amounts[on_side[next]] = part;
        if let Some(before) = before {
            amounts[before] = 1.0 - part;
        }
    }
    amounts
}

#[cfg(test)]
mod tests {
    use super::amounts;

    #[test]
    fn channels_run_on_beyond_their_shapes() {
        assert_eq!(amounts(&[50.0, 100.0], 75.0), [0.5, 0.5]);
        assert_eq!(amounts(&[50.0, 100.0], 150.0), [-1.0, 2.0]);
        assert_eq!(amounts(&[50.0, 100.0], -75.0), [-1.5, 0.0], "no shape is below 0");
        assert_eq!(amounts(&[-50.0, 100.0, -25.0], -75.0), [2.0, 0.0, -1.0]);
    }
}
