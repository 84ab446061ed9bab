//! Decodes triangles that share edges and vertices with earlier ones, and lists of indices.

use super::bytes::{Broken, Bytes};

const TRIANGLES: u8 = 0xe1;
const SEQUENCE: u8 = 0xd1;
/// Bytes after the triangle data: a table of frequent pairs of FIFO positions.
const TABLE: usize = 16;
/// Bytes after the data of a list.
const TAIL: usize = 4;
/// From this code on, a position in the vertex FIFO has another meaning.
const PLACES: usize = 13;

/// The sixteen most recent items, the newest first.
struct RecentFifo<T> {
    ring: [T; 16],
    next: usize,
}

impl<T: Copy> RecentFifo<T> {
    fn new(unset: T) -> RecentFifo<T> {
        RecentFifo { ring: [unset; 16], next: 0 }
    }

    fn push(&mut self, item: T) {
        self.ring[self.next] = item;
        self.next = (self.next + 1) & 15;
    }

    /// The item at a position; the newest is at 0.
    fn at(&self, place: usize) -> T {
        self.ring[self.next.wrapping_sub(1 + place) & 15]
    }
}

/// The decoder's state after the triangles so far.
struct Triangles<'a> {
    data: Bytes<'a>,
    edges: RecentFifo<[u32; 2]>,
    vertices: RecentFifo<u32>,
    /// The smallest vertex index that has not been used yet.
    next: u32,
    /// The last vertex index that was coded explicitly.
    last: u32,
}

/// Decodes a list of triangles to indices of `stride` bytes.
pub(super) fn unpack_triangles(packed: &[u8], stride: usize, elements: &mut [u8]) -> Result<(), Broken> {
    let count = elements.len() / stride / 3;
    let end = packed.len().checked_sub(TABLE).ok_or(Broken)?;
    let mut data = Bytes(&packed[..end]);
    let table = &packed[end..];
    if data.byte()? != TRIANGLES {
        return Err(Broken);
    }
    let codes = data.take(count)?;
    let (edges, vertices) = (RecentFifo::new([0; 2]), RecentFifo::new(0));
    let mut state = Triangles { data, edges, vertices, next: 0, last: 0 };
    for (code, corners) in codes.iter().zip(elements.chunks_exact_mut(3 * stride)) {
        let triangle = match code {
            0..0xf0 => state.across_recent_edge(usize::from(code >> 4), usize::from(code & 15))?,
            0xf0..0xfe => state.resolve_corners([0, table[usize::from(code & 15)]])?,
            _ => {
                let places = state.data.byte()?;
                if places == 0 {
                    state.next = 0;
                }
                state.resolve_corners([if *code == 0xfe { 0 } else { 15 }, places])?
            }
        };
        for (index, bytes) in triangle.iter().zip(corners.chunks_exact_mut(stride)) {
            bytes.copy_from_slice(&index.to_le_bytes()[..stride]);
        }
    }
    if state.data.0.is_empty() { Ok(()) } else { Err(Broken) }
}

impl Triangles<'_> {
    /// A triangle that shares one of the recent edges.
    fn across_recent_edge(&mut self, edge: usize, place: usize) -> Result<[u32; 3], Broken> {
        let [a, b] = self.edges.at(edge);
        let c = match place {
            0 => self.unnamed(),
            place if place < PLACES => self.vertices.at(place),
            // One less or one more than the last explicit index.
            13 | 14 => self.named(if place == 13 { u32::MAX } else { 1 }),
            _ => {
                let by = signed(self.data.number()?);
                self.named(by)
            }
        };
        if place == 0 || place >= PLACES {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok([a, b, c])
    }

    /// A triangle whose corners are each new (0), explicit (15), or a recent vertex (from 1).
    fn resolve_corners(&mut self, [first, others]: [u8; 2]) -> Result<[u32; 3], Broken> {
        let places = [first, others >> 4, others & 15];
        let mut corners = [0; 3];
        // New vertices are numbered before explicit ones are decoded.
        for (corner, place) in corners.iter_mut().zip(places) {
            *corner = match place {
                0 => self.unnamed(),
                15 => 0,
                place => self.vertices.at(usize::from(place) - 1),
            };
        }
        for (corner, _) in corners.iter_mut().zip(places).filter(|(_, place)| *place == 15) {
            let by = signed(self.data.number()?);
            *corner = self.named(by);
        }
        for (corner, place) in corners.into_iter().zip(places) {
            if place == 0 || place == 15 {
                self.vertices.push(corner);
            }
        }
        let [a, b, c] = corners;
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok(corners)
    }

    fn unnamed(&mut self) -> u32 {
        let vertex = self.next;
        self.next = self.next.wrapping_add(1);
        vertex
    }

    fn named(&mut self, by: u32) -> u32 {
        self.last = self.last.wrapping_add(by);
        self.last
    }
}

impl Bytes<'_> {
    /// A variable-length number of up to 32 bits, seven bits per byte, the lowest first.
    fn number(&mut self) -> Result<u32, Broken> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 127) << shift;
            if byte < 128 {
                break;
            }
        }
        Ok(number)
    }
}

/// The wrapping addend of a difference whose sign is in the lowest bit.
fn signed(number: u32) -> u32 {
    number >> 1 ^ (number & 1).wrapping_neg()
}

/// Decodes a list of indices of `stride` bytes.
pub(super) fn unpack_sequence(packed: &[u8], stride: usize, elements: &mut [u8]) -> Result<(), Broken> {
    let end = packed.len().checked_sub(TAIL).ok_or(Broken)?;
    let mut data = Bytes(&packed[..end]);
    if data.byte()? != SEQUENCE {
        return Err(Broken);
    }
    // Two baselines; each index is a difference from one of them.
    let mut last = [0u32; 2];
    for bytes in elements.chunks_exact_mut(stride) {
        let number = data.number()?;
        let run = &mut last[(number & 1) as usize];
        *run = run.wrapping_add(signed(number >> 1));
        bytes.copy_from_slice(&run.to_le_bytes()[..stride]);
    }
    if data.0.is_empty() { Ok(()) } else { Err(Broken) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_share_edges_vertices_and_name_others() {
        let mut packed = vec![TRIANGLES];
        // 0 1 2, all new, by the table; then a new vertex across the newest edge (0, 2); then a recent vertex (1)
        // across the newest edge; then one more than the last explicit index; then a triangle with all indices
        // explicit.
        packed.extend([0xf0, 0x00, 0x03, 0x0e, 0xff]);
        packed.extend([0xff, 18, 2, 1]);
        packed.extend([0; TABLE]);
        let mut elements = [0; 5 * 3 * 2];
        assert!(unpack_triangles(&packed, 2, &mut elements).is_ok());
        let indices: Vec<u8> = elements.chunks(2).map(|pair| pair[0]).collect();
        assert_eq!(indices, [0, 1, 2, 0, 2, 3, 0, 3, 0, 0, 0, 1, 10, 11, 10]);
        for cut in 0..packed.len() {
            assert!(unpack_triangles(&packed[..cut], 2, &mut elements).is_err());
        }
    }

    #[test]
    fn lists_continue_two_runs() {
        // +5 from the first baseline, +300 from the second, -2 from the first.
        let packed = [SEQUENCE, 20, 0xb1, 0x09, 12 >> 1 << 1, 0, 0, 0, 0];
        let mut elements = [0; 12];
        assert!(unpack_sequence(&packed, 4, &mut elements).is_ok());
        let indices: Vec<u32> =
            elements.chunks(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert_eq!(indices, [5, 300, 8]);
    }
}
