//! The cost of a query, counted only on request.

/// Work done by one or many queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Queries answered.
    pub rays: u64,
    /// Nodes visited, leaves included.
    pub nodes: u64,
    /// Triangle tests done.
    pub triangles: u64,
    /// Subtrees skipped because a hit was nearer.
    pub early_outs: u64,
    /// Back faces rejected by the side of their partition plane, without a triangle test.
    pub culled_back_faces: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Counters) {
        self.rays += other.rays;
        self.nodes += other.nodes;
        self.triangles += other.triangles;
        self.early_outs += other.early_outs;
        self.culled_back_faces += other.culled_back_faces;
    }
}

/// Receives the work that a traversal reports. [`NoCounters`] compiles to nothing.
pub trait Count {
    /// A query begins.
    fn ray(&mut self) {}
    /// A node is visited.
    fn node(&mut self) {}
    /// `n` triangle tests are done.
    fn triangles(&mut self, _n: usize) {}
    /// A subtree is skipped because a hit is nearer.
    fn early_out(&mut self) {}
    /// A back face is rejected without a triangle test.
    fn culled_back_face(&mut self) {}
    /// The counters, if anything is counted: for structures that query others.
    fn counters(&mut self) -> Option<&mut Counters> {
        None
    }
}

/// Counts nothing, at no cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCounters;

impl Count for NoCounters {}

impl Count for Counters {
    fn ray(&mut self) {
        self.rays += 1;
    }
    fn node(&mut self) {
        self.nodes += 1;
    }
    fn triangles(&mut self, n: usize) {
        self.triangles += n as u64;
    }
    fn early_out(&mut self) {
        self.early_outs += 1;
    }
    fn culled_back_face(&mut self) {
        self.culled_back_faces += 1;
    }
    fn counters(&mut self) -> Option<&mut Counters> {
        Some(self)
    }
}
