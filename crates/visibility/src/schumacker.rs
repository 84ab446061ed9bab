//! Schumacker's clusters: separating planes order the clusters by the eye's side; within a cluster the faces have
//! priorities that hold from every viewpoint that sees them [Schumacker 1969].
//!
//! The groups of the mesh are the initial clusters. Clusters that no plane separates are divided, and so is a cluster
//! with too many faces, or one whose faces can hide each other in a cycle: in that case by the plane of a face in the
//! cycle, which also cuts what crosses it.

use crate::canvas::{Canvas, NO_OWNER};
use crate::partition::{Child, Start, Stop, SubtreeSlot, Tree, draw_piece, whole_pieces};
use crate::piece::Piece;
use crate::polygon::{Plane, corners};
use crate::result::VisibilityCounts;
use crate::screen::{Screen, Slack};
use crate::splitter::{candidates, fewest_splits};
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, registry::Entry};
use std::time::Instant;

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "schumacker",
        summary: "Schumacker's clusters: ordered by separating planes, faces by view-independent priorities",
        source: "Schumacker 1969",
        parameters: &[],
    },
    exact: true,
    run,
};

/// Maximum number of polygons in a cluster: finding priorities compares every pair.
const LARGEST: usize = 128;
/// Maximum number of clusters for which every pair is tried as a direction of separation.
const MAX_PAIRED: usize = 16;

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    let begun = Instant::now();
    let scene = Clusters::new(mesh, &screen.slack, &mut canvas.counts);
    let build_seconds = begun.elapsed().as_secs_f64();
    scene.tree.walk(screen.eye, Start::Nearest, |stop| {
        match stop {
            Stop::Enter(Child::PartitionNode(_)) => canvas.counts.sort_comparisons += 1,
            Stop::Enter(Child::Leaf(_)) => {}
            Stop::On(node) => scene.draw_on(node, &screen, &mut canvas),
            Stop::Leaf(leaf) => scene.draw_cluster(leaf, &screen, &mut canvas),
        }
        true
    });
    canvas.finish(build_seconds)
}

/// Clusters under a tree of the planes between them.
struct Clusters {
    tree: Tree,
    clusters: Vec<Cluster>,
}

struct Cluster {
    pieces: Vec<Piece>,
    planes: Vec<FacePlane>,
    /// Faces that can hide others come first.
    priorities: Vec<Face>,
    /// First of a range of owner numbers, one per piece, that no node or other cluster uses.
    first_owner: u32,
}

#[derive(Clone, Copy)]
struct FacePlane {
    plane: Plane,
    /// Half the thickness: the triangle's hits are nearer to the plane by a radius.
    half: f64,
}

/// One side of a piece.
#[derive(Clone, Copy)]
struct Face {
    piece: usize,
    front: bool,
}

impl Clusters {
    fn new(mesh: &TriangleMesh, slack: &Slack, counts: &mut VisibilityCounts) -> Clusters {
        let mut scene = Clusters { tree: Tree::new(mesh), clusters: Vec::new() };
        let mut waiting = vec![(SubtreeSlot::Root, by_group(mesh))];
        while let Some((place, mut sets)) = waiting.pop() {
            sets.retain(|set| !set.is_empty());
            if sets.is_empty() {
                continue;
            }
            let (plane, thickness) = match plane_between(&sets) {
                Some(plane) => (plane, 0.0),
                None => match Cluster::new(sets.into_iter().flatten().collect(), mesh, slack) {
                    Ok(cluster) => {
                        scene.tree.attach(place, Child::Leaf(scene.clusters.len() as u32));
                        scene.clusters.push(cluster);
                        continue;
                    }
                    Err(Cycle { pieces, unordered }) => {
                        let tried = candidates(unordered.len(), scene.tree.nodes.len());
                        let tried: Vec<usize> = tried.into_iter().map(|i| unordered[i]).collect();
                        let chosen = fewest_splits(&pieces, &tried, mesh, slack);
                        sets = vec![pieces];
                        chosen
                    }
                },
            };
            let node = scene.tree.add(place, plane, thickness, slack);
            let sides = sets.into_iter().map(|set| scene.tree.distribute(set, slack, counts));
            let (front, back) = sides.map(|sides| (sides.front, sides.back)).unzip();
            waiting.push((SubtreeSlot::Front(node), front));
            waiting.push((SubtreeSlot::Back(node), back));
        }
        scene.number_owners();
        let of_clusters: usize = scene.clusters.iter().map(|cluster| cluster.pieces.len()).sum();
        counts.pieces += (of_clusters + scene.tree.pieces_on_planes()) as u64;
        scene
    }

    /// Assigns each cluster's pieces numbers above those of the nodes.
    fn number_owners(&mut self) {
        let mut next = self.tree.nodes.len() as u32;
        for cluster in &mut self.clusters {
            cluster.first_owner = next;
            next += cluster.pieces.len() as u32;
        }
    }

    /// Draws what lies within the thickness of a plane between clusters, where depth decides.
    fn draw_on(&self, node: u32, screen: &Screen, canvas: &mut Canvas) {
        for piece in self.tree.pieces_on(node) {
            let open = |canvas: &Canvas, pixel| [NO_OWNER, node].contains(&canvas.owner(pixel));
            draw_piece(&self.tree, piece, screen, canvas, open, |canvas, hit| {
                canvas.put_first_or_nearer(hit, node);
            });
        }
    }

    /// Draws the faces turned towards the eye, by priority. Only within the thickness of planes can a face hide those
    /// painted before it.
    fn draw_cluster(&self, leaf: u32, screen: &Screen, canvas: &mut Canvas) {
        let cluster = &self.clusters[leaf as usize];
        let first = cluster.first_owner;
        let own = first..first + cluster.pieces.len() as u32;
        canvas.counts.sort_comparisons += cluster.planes.len() as u64;
        let towards_eye: Vec<bool> =
            cluster.planes.iter().map(|face| face.plane.side(screen.eye) >= 0.0).collect();
        for face in cluster.priorities.iter().filter(|face| towards_eye[face.piece] == face.front) {
            let piece = &cluster.pieces[face.piece];
            let open = |canvas: &Canvas, pixel| {
                let owner = canvas.owner(pixel);
                owner == NO_OWNER || own.contains(&owner)
            };
            draw_piece(&self.tree, piece, screen, canvas, open, |canvas, hit| {
                let owner = canvas.owner(hit.pixel);
                if owner == NO_OWNER {
                    canvas.put(hit, first + face.piece as u32);
                    return;
                }
                canvas.counts.sort_comparisons += 1;
                if !cluster.is_certainly_behind(face.piece, (owner - first) as usize, screen.eye) {
                    canvas.put_if_nearer(hit, first + face.piece as u32);
                }
            });
        }
    }
}

/// A cluster without valid priorities: pieces that hide each other in a cycle, or depend on such pieces.
struct Cycle {
    pieces: Vec<Piece>,
    unordered: Vec<usize>,
}

impl Cluster {
    fn new(pieces: Vec<Piece>, mesh: &TriangleMesh, slack: &Slack) -> Result<Cluster, Cycle> {
        if pieces.len() > LARGEST {
            let unordered = (0..pieces.len()).collect();
            return Err(Cycle { pieces, unordered });
        }
        let planes: Vec<FacePlane> = pieces.iter().map(|piece| FacePlane::new(piece, mesh, slack)).collect();
        match priorities(&pieces, &planes) {
            Ok(priorities) => Ok(Cluster { pieces, planes, priorities, first_owner: 0 }),
            Err(unordered) => Err(Cycle { pieces, unordered }),
        }
    }

    /// True when no hit of `late` can be as near as one of `early`, seen from the eye.
    fn is_certainly_behind(&self, late: usize, early: usize, eye: DVec3) -> bool {
        let beyond = |face: &FacePlane, piece: &Piece, away: f64| {
            let side = face.plane.side(eye);
            let (low, high) = face.plane.range(&piece.polygon);
            let towards = if side * away < 0.0 { -high } else { low };
            side.abs() > face.half && towards > face.half
        };
        beyond(&self.planes[late], &self.pieces[early], 1.0)
            || beyond(&self.planes[early], &self.pieces[late], -1.0)
    }
}

impl FacePlane {
    fn new(piece: &Piece, mesh: &TriangleMesh, slack: &Slack) -> FacePlane {
        let corners = corners(&mesh.triangles()[piece.triangle as usize]).unwrap_or_default();
        let plane = Plane::of_triangle(&corners);
        let (low, high) = plane.range(&corners);
        FacePlane { plane, half: high.max(-low) + 2.0 * slack.radius }
    }
}

/// Both faces of each piece, ordered so that none can hide an earlier one from any point that sees both; or the
/// pieces that cannot be ordered like this.
fn priorities(pieces: &[Piece], planes: &[FacePlane]) -> Result<Vec<Face>, Vec<usize>> {
    let faces: Vec<Face> =
        (0..pieces.len()).flat_map(|piece| [true, false].map(|front| Face { piece, front })).collect();
    let ranges: Vec<Vec<(f64, f64)>> = planes
        .iter()
        .map(|face| pieces.iter().map(|piece| face.plane.range(&piece.polygon)).collect())
        .collect();
    // A face can hide another only if it reaches in front of the other, and the other reaches behind it.
    let may_hide = |a: &Face, b: &Face| {
        let (a_from_b, b_from_a) = (ranges[b.piece][a.piece], ranges[a.piece][b.piece]);
        let in_front = if b.front { a_from_b.1 } else { -a_from_b.0 };
        let behind = if a.front { -b_from_a.0 } else { b_from_a.1 };
        a.piece != b.piece && in_front > planes[b.piece].half && behind > planes[a.piece].half
    };
    let mut hidden_by: Vec<usize> =
        faces.iter().map(|b| faces.iter().filter(|a| may_hide(a, b)).count()).collect();
    let mut free: Vec<usize> = (0..faces.len()).filter(|&face| hidden_by[face] == 0).collect();
    let mut order = Vec::with_capacity(faces.len());
    while let Some(face) = free.pop() {
        order.push(faces[face]);
        for (other, count) in hidden_by.iter_mut().enumerate() {
            if may_hide(&faces[face], &faces[other]) {
                *count -= 1;
                if *count == 0 {
                    free.push(other);
                }
            }
        }
    }
    if order.len() == faces.len() {
        return Ok(order);
    }
    let mut unordered: Vec<usize> =
        (0..faces.len()).filter(|&face| hidden_by[face] > 0).map(|face| faces[face].piece).collect();
    unordered.dedup();
    Err(unordered)
}

fn by_group(mesh: &TriangleMesh) -> Vec<Vec<Piece>> {
    let mut sets = vec![Vec::new(); mesh.groups().len()];
    for piece in whole_pieces(mesh) {
        let group = mesh.groups().partition_point(|group| group.end <= piece.triangle);
        sets[group].push(piece);
    }
    sets
}

/// A plane that separates the clusters, each wholly on one side; or else, when there are too many polygons for one
/// cluster, a plane that halves them. `None` when they should form one cluster.
fn plane_between(sets: &[Vec<Piece>]) -> Option<Plane> {
    let axes = DVec3::AXES.into_iter();
    let middles: Vec<DVec3> = sets.iter().take(MAX_PAIRED).map(|set| middle(set)).collect();
    let pairs = middles
        .iter()
        .enumerate()
        .flat_map(|(i, &a)| middles[i + 1..].iter().filter_map(move |&b| (b - a).try_normalize()));
    let separating = axes.chain(pairs).filter_map(|direction| gap_along(direction, sets));
    if let Some((plane, _)) = separating.min_by_key(|&(_, imbalance)| imbalance) {
        return Some(plane);
    }
    let polygons = sets.iter().map(Vec::len).sum::<usize>();
    if polygons > LARGEST { halving_plane(sets.iter().flatten(), polygons) } else { None }
}

fn middle(set: &[Piece]) -> DVec3 {
    let points = set.iter().flat_map(|piece| &piece.polygon);
    let (sum, count) = points.fold((DVec3::ZERO, 0.0), |(sum, count), &point| (sum + point, count + 1.0));
    sum / count
}

/// The plane perpendicular to a direction, in a gap between clusters, that best balances the two sides, and the
/// difference between their numbers of clusters.
fn gap_along(direction: DVec3, sets: &[Vec<Piece>]) -> Option<(Plane, usize)> {
    let plane = Plane { normal: direction, offset: 0.0 };
    let mut extents: Vec<(f64, f64)> = sets
        .iter()
        .map(|set| {
            let ranges = set.iter().map(|piece| plane.range(&piece.polygon));
            ranges.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (l, h)| (low.min(l), high.max(h)))
        })
        .collect();
    extents.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut highest = f64::NEG_INFINITY;
    let mut best: Option<(Plane, usize)> = None;
    for (below, pair) in extents.windows(2).enumerate() {
        highest = highest.max(pair[0].1);
        let imbalance = (below + 1).abs_diff(sets.len() - below - 1);
        if highest <= pair[1].0 && best.is_none_or(|(_, least)| imbalance < least) {
            best = Some((Plane { offset: 0.5 * (highest + pair[1].0), ..plane }, imbalance));
        }
    }
    best
}

/// The plane perpendicular to the longest side of the bounding box of the polygons' centres, through the median one.
/// `None` when that would leave all of them on one side.
fn halving_plane<'p>(pieces: impl Iterator<Item = &'p Piece> + Clone, count: usize) -> Option<Plane> {
    let middles = pieces.clone().map(|piece| middle(std::slice::from_ref(piece)));
    let bounds = middles
        .clone()
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
    let extent = bounds[1] - bounds[0];
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b]))?;
    let mut along: Vec<f64> = middles.map(|p| p[axis]).collect();
    let (_, &mut median, _) = along.select_nth_unstable_by(count / 2, f64::total_cmp);
    let plane = Plane { normal: DVec3::AXES[axis], offset: median };
    let sides = pieces.map(|piece| plane.range(&piece.polygon));
    let (front, back) = sides.fold((0, 0), |(front, back), (low, high)| {
        (front + usize::from(high > 0.0), back + usize::from(low < 0.0))
    });
    (front.max(back) * 4 < count * 3).then_some(plane)
}
