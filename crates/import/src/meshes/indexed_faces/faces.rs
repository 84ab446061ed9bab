//! A list of faces that is freed chunk by chunk, and a compact list of one number per face.

use super::corners::Corner;

/// The corners of faces, in chunks, so that a consumer can free each chunk once it has been read.
#[derive(Debug, Default)]
pub struct FaceList {
    pieces: Vec<Piece>,
    faces: usize,
    corners: usize,
}

/// A chunk of whole faces.
#[derive(Debug, Default)]
struct Piece {
    corners: Vec<Corner>,
    /// The end of each face's corners, relative to the chunk.
    ends: Vec<u32>,
}

/// The approximate number of corners of a chunk: large enough that the allocator returns its memory to the system.
const PIECE: usize = 1 << 18;

impl FaceList {
    /// The number of faces.
    pub fn len(&self) -> usize {
        self.faces
    }

    pub fn is_empty(&self) -> bool {
        self.faces == 0
    }

    /// The total number of corners of all faces.
    pub fn corner_count(&self) -> usize {
        self.corners
    }

    /// Adds a face.
    #[inline]
    pub fn push(&mut self, corners: &[Corner]) {
        self.append(corners, [corners.len() as u32]);
    }

    /// Adds faces with these corners; each face runs up to one of the ends.
    pub fn append(&mut self, corners: &[Corner], ends: impl IntoIterator<Item = u32>) {
        let fits = |piece: &Piece| piece.corners.len() + corners.len() <= piece.corners.capacity();
        if !self.pieces.last().is_some_and(fits) {
            // Unused capacity costs nothing until it is touched.
            let corners = Vec::with_capacity(corners.len().max(PIECE));
            self.pieces.push(Piece { corners, ends: Vec::new() });
        }
        let Some(piece) = self.pieces.last_mut() else { return };
        let before = piece.corners.len() as u32;
        piece.corners.extend_from_slice(corners);
        let faces = piece.ends.len();
        piece.ends.extend(ends.into_iter().map(|end| before + end));
        self.faces += piece.ends.len() - faces;
        self.corners += corners.len();
    }

    /// The corners of each face.
    pub fn iter(&self) -> impl Iterator<Item = &[Corner]> {
        self.pieces.iter().flat_map(|piece| {
            (0..piece.ends.len()).map(|face| &piece.corners[piece.start(face)..piece.ends[face] as usize])
        })
    }

    /// All corners, each with the index of its face.
    pub fn corners_mut(&mut self) -> impl Iterator<Item = (usize, &mut Corner)> {
        let mut face = 0;
        self.pieces.iter_mut().flat_map(move |piece| {
            let (first, ends) = (face, &piece.ends);
            face += ends.len();
            let mut next = 0;
            piece.corners.iter_mut().enumerate().map(move |(i, corner)| {
                while ends[next] as usize <= i {
                    next += 1;
                }
                (first + next, corner)
            })
        })
    }

    /// Calls `visit` with each face's index and corners, and frees the chunks that have been visited.
    pub fn consume<E>(self, mut visit: impl FnMut(usize, &[Corner]) -> Result<(), E>) -> Result<(), E> {
        let mut number = 0;
        for piece in self.pieces {
            for face in 0..piece.ends.len() {
                visit(number, &piece.corners[piece.start(face)..piece.ends[face] as usize])?;
                number += 1;
            }
        }
        Ok(())
    }
}

impl Piece {
    fn start(&self, face: usize) -> usize {
        if face == 0 { 0 } else { self.ends[face - 1] as usize }
    }
}

/// One number per face, compressed as runs of constant steps; used for locations in a file.
#[derive(Debug, Default)]
pub struct Steps {
    runs: Vec<Run>,
    count: usize,
}

/// Numbers with a constant step.
#[derive(Debug)]
struct Run {
    first_face: u32,
    first: u64,
    step: u64,
}

impl Steps {
    pub fn push(&mut self, number: u64) {
        let count = self.count;
        self.count += 1;
        if let Some(run) = self.runs.last_mut() {
            let length = count - run.first_face as usize;
            if length == 1 {
                run.step = number.wrapping_sub(run.first);
                return;
            }
            if run.at(length) == number {
                return;
            }
        }
        self.runs.push(Run { first_face: count as u32, first: number, step: 0 });
    }

    /// The number of a face.
    pub fn at(&self, face: usize) -> u64 {
        let after = self.runs.partition_point(|run| run.first_face as usize <= face);
        self.runs[..after].last().map_or(0, |run| run.at(face - run.first_face as usize))
    }
}

impl Run {
    fn at(&self, index: usize) -> u64 {
        self.first.wrapping_add(self.step.wrapping_mul(index as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_return_the_numbers_they_compress(numbers in prop::collection::vec(0u64..4, 0..200)) {
            let mut steps = Steps::default();
            numbers.iter().for_each(|&n| steps.push(n));
            for (face, &number) in numbers.iter().enumerate() {
                prop_assert_eq!(steps.at(face), number);
            }
        }
    }

    #[test]
    fn even_steps_take_one_run() {
        let mut steps = Steps::default();
        (0..1000).for_each(|line| steps.push(line << 32 | 1));
        assert_eq!((steps.runs.len(), steps.at(999)), (1, 999 << 32 | 1));
    }

    #[test]
    fn faces_over_several_pieces_stay_whole_and_in_order() {
        let mut list = FaceList::default();
        let face = |i: u32| vec![[i, 0, 0]; 3 + (i % 3) as usize];
        let count = PIECE as u32;
        (0..count).for_each(|i| list.push(&face(i)));
        assert!(list.pieces.len() > 3 && list.len() == count as usize);
        assert!(list.iter().enumerate().all(|(i, corners)| corners == face(i as u32)));
        assert!(list.corners_mut().all(|(i, corner)| corner[0] as usize == i));
        let mut seen = 0;
        let visited: Result<(), ()> = list.consume(|i, corners| {
            seen += usize::from(corners == face(i as u32));
            Ok(())
        });
        assert_eq!((visited, seen), (Ok(()), count as usize));
    }
}
