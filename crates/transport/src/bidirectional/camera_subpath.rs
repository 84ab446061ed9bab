//! Events of one camera subpath. [`CameraSubpath::follow`] takes one event after the other;
//! [`super::CameraQueue`] takes each event for many subpaths at a time, and finds the same light, bit for bit.

use super::connect::Connection;
use super::{Subpath, Vertex};
use crate::sampling::task::Task;
use crate::techniques::mis::Partial;
use crate::techniques::{Step, Tally, TechniqueCounts};
use bilux_math::Rgb;
use bilux_scene::{Ray, TransportMode};

/// The events of a camera subpath, as an algorithm treats them.
pub(crate) trait CameraSubpath<const N: usize = 1> {
    /// The techniques by which its vertices may be found otherwise.
    fn techniques(&self) -> &TechniqueCounts<N>;

    /// The subpath leaves the scene.
    fn escape(&self, subpath: &mut Subpath<N>, task: &Task, tally: &mut impl Tally<N>);

    /// The subpath arrives at a vertex, and collects the light that is emitted there; false where it ends.
    fn arrive(
        &self,
        subpath: &mut Subpath<N>,
        z: &mut Vertex<N>,
        task: &mut Task,
        tally: &mut impl Tally<N>,
    ) -> bool;

    /// Connects a vertex with lights, and with a light subpath. `visit` is told of each attempt, and receives the connection if
    /// there is one.
    #[inline]
    fn connect<'v>(
        &self,
        _z: &Vertex<N>,
        _light_path: impl Iterator<Item = &'v Vertex<N>>,
        _task: &mut Task,
        _visit: impl FnMut(&mut Task, Step, Option<Connection<N>>),
    ) {
    }

    /// Merges a vertex with the photons around it.
    fn merge(&self, z: &Vertex<N>, task: &Task, tally: &mut impl Tally<N>);

    /// Merges its last ray with the beams of photons that it crosses in media.
    fn cross(&self, subpath: &Subpath<N>, task: &Task, tally: &mut impl Tally<N>);

    /// Connects the [equiangular points](crate::media::equiangular) of its last ray with their lights.
    fn equiangular(&self, _subpath: &Subpath<N>, _task: &mut Task, _tally: &mut impl Tally<N>) {}

    /// Sends the subpath on; false where it ends.
    fn scatter(&self, subpath: &mut Subpath<N>, z: &Vertex<N>, task: &mut Task) -> bool;

    /// A subpath with only its first ray.
    fn leave_camera(&self, ray: &Ray) -> Subpath<'_, N> {
        Subpath::new(TransportMode::Radiance, *ray, Rgb::WHITE, Partial::START, false, self.techniques())
    }

    /// Follows one subpath to its end.
    fn follow(&self, ray: &Ray, light_path: &[Vertex<N>], task: &mut Task, tally: &mut impl Tally<N>) {
        let mut subpath = self.leave_camera(ray);
        loop {
            tally.spend(Step::Camera, 1);
            let vertex = subpath.next_vertex(task);
            self.cross(&subpath, task, tally);
            self.equiangular(&subpath, task, tally);
            let Some(mut z) = vertex else {
                return self.escape(&mut subpath, task, tally);
            };
            tally.reach(|| z.at.place(z.wo));
            if !self.arrive(&mut subpath, &mut z, task, tally) {
                return;
            }
            self.connect(&z, light_path.iter(), task, |task, step, connection| {
                tally.spend(step, 1);
                if let Some(connection) = connection
                    && let Some((technique, found)) = connection.trace(task.tracer)
                {
                    let segment = &connection.segment;
                    tally.join(z.at.p(), segment.ray.direction.into(), segment.through.distance);
                    tally.add_sample(technique, &found);
                }
            });
            self.merge(&z, task, tally);
            if !self.scatter(&mut subpath, &z, task) {
                return;
            }
        }
    }
}
