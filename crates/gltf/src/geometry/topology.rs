//! Topologies: vertices that form triangles, lines and points.

use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use bilux_import::FormatError;

/// The topology of a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mode {
    Points,
    Lines,
    LineLoop,
    LineStrip,
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    pub(crate) fn of(node: JsonNode) -> Result<Mode, FormatError> {
        Ok(match node.count("mode")?.unwrap_or(4) {
            0 => Mode::Points,
            1 => Mode::Lines,
            2 => Mode::LineLoop,
            3 => Mode::LineStrip,
            4 => Mode::Triangles,
            5 => Mode::Strip,
            6 => Mode::Fan,
            other => {
                return Err(
                    node.error(format!("mode {other} does not exist: modes are 0 to 6, and 4 is triangles"))
                );
            }
        })
    }

    /// The points and lines of a primitive: points at corners, and lines between pairs of corners.
    pub(crate) fn points_and_lines(self, corners: Vec<u32>) -> (Vec<u32>, Vec<[u32; 2]>) {
        let pairs = |step: usize| corners.windows(2).step_by(step).map(|pair| [pair[0], pair[1]]);
        let lines = match self {
            Mode::Lines => pairs(2).collect(),
            Mode::LineStrip => pairs(1).collect(),
            Mode::LineLoop => pairs(1).chain(corners.last().map(|&last| [last, corners[0]])).collect(),
            _ => Vec::new(),
        };
        (if self == Mode::Points { corners } else { Vec::new() }, lines)
    }
}

/// The corners of a primitive: its indices, or all vertices in order.
pub(crate) fn corners<'d>(
    node: JsonNode<'d>,
    vertices: usize,
    data: &mut DataReader<'d, '_>,
) -> Result<Vec<u32>, FormatError> {
    let Ok(count) = u32::try_from(vertices) else {
        return Err(node.error("there are more than 4 billion vertices: split the mesh"));
    };
    let Some(index) = node.get("indices") else {
        data.take_bytes(u64::from(count) * 4)?;
        return Ok((0..count).collect());
    };
    let accessor = data.accessor(index)?;
    let corners = accessor.indices(data.budget)?;
    if let Some(at) = corners.iter().position(|&corner| corner >= count) {
        let message = format!("index {at} is {}, but there are {count} vertices", corners[at]);
        return Err(accessor.node.error(message));
    }
    Ok(corners)
}

/// The triangles of a primitive, each by its corners.
pub(crate) fn triangles<'d>(
    node: JsonNode<'d>,
    mode: Mode,
    vertices: usize,
    data: &mut DataReader<'d, '_>,
) -> Result<Vec<[u32; 3]>, FormatError> {
    let corners = corners(node, vertices, data)?;
    let n = match mode {
        Mode::Triangles => corners.len() / 3,
        _ => corners.len().saturating_sub(2),
    };
    if mode == Mode::Triangles && corners.len() % 3 != 0 {
        data.note("the last corners of a triangle list do not make a triangle", || node.at());
    }
    data.take_bytes(n as u64 * 12)?;
    // This order of corners gives all triangles of a strip the same winding. [glTF 2.0, 3.7.2.1]
    let corner = |t: usize| match mode {
        Mode::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
        Mode::Fan => [t + 1, t + 2, 0],
        _ => [3 * t, 3 * t + 1, 3 * t + 2],
    };
    Ok((0..n).map(|t| corner(t).map(|i| corners[i])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_pairs_chains_and_loops() {
        let corners = [4, 5, 6, 7];
        let lines = |mode: Mode| mode.points_and_lines(corners.to_vec()).1;
        assert_eq!(lines(Mode::Lines), [[4, 5], [6, 7]]);
        assert_eq!(lines(Mode::LineStrip), [[4, 5], [5, 6], [6, 7]]);
        assert_eq!(lines(Mode::LineLoop), [[4, 5], [5, 6], [6, 7], [7, 4]]);
        assert_eq!(Mode::Points.points_and_lines(vec![3, 1]), (vec![3, 1], Vec::new()));
        assert_eq!(Mode::LineLoop.points_and_lines(Vec::new()), (Vec::new(), Vec::new()));
        let odd = Mode::Lines.points_and_lines(corners[..3].to_vec());
        assert_eq!(odd.1, [[4, 5]], "the odd one makes no line");
    }
}
