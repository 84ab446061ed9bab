//! Camera of a view, and the size of its pictures.

use crate::eye::{Eye, own_bounds, point_at};
use crate::message::Move;
use bilux::scene::{Parameters, Value};
use bilux::{Job, Session};

/// The camera of a view, which those who watch move, and the size of its pictures.
#[derive(Clone, Copy)]
pub(super) struct Viewpoint {
    /// The camera where the scene has it.
    pub(super) home: Option<Eye>,
    /// The camera where it is now.
    pub(super) eye: Option<Eye>,
    /// Whether it is where it was moved to.
    pub(super) is_moved: bool,
    /// The size that is asked for, and the one that there is room for.
    pub(super) wanted_size: [u32; 2],
    pub(super) size: [u32; 2],
}

impl Viewpoint {
    /// Pictures of this size, from wherever the scene has its camera.
    pub(super) fn of_size(size: [u32; 2]) -> Viewpoint {
        Viewpoint { home: None, eye: None, is_moved: false, wanted_size: size, size }
    }

    /// Adds to the settings where the camera was moved to.
    pub(super) fn place(&self, all: &mut Parameters) {
        let Some(eye) = self.eye.filter(|_| self.is_moved) else { return };
        eye.settings().into_iter().for_each(|(key, value)| match value.parse() {
            Ok(number) if key == "zoom" => all.set(key, Value::Number(number)),
            _ => all.set(key, value),
        });
    }

    /// Puts the camera where the scene has it.
    pub(super) fn go_home(&mut self) {
        (self.is_moved, self.eye) = (false, self.home);
    }

    /// Moves the camera of a job.
    pub(super) fn make(&mut self, it: &Move, job: &Job) {
        if *it == Move::Home {
            return self.go_home();
        }
        let Some(mut eye) = self.eye else { return };
        match *it {
            Move::Orbit([right, up]) => eye.orbit(right, up),
            Move::Look([right, up]) => eye.look(right, up),
            Move::Pan([right, up]) => {
                let height = f64::from(job.camera().height_at(eye.pivot.as_vec3(), job.settings().time));
                eye.pan(right * height, up * height);
            }
            Move::Fly([right, up, forward]) => eye.fly(right, up, forward),
            Move::Approach(factor) => eye.approach(factor),
            Move::To(position, pivot, zoom) => {
                eye.put(position.into(), pivot.into(), zoom);
            }
            Move::Focus(at) => {
                if let Some(point) = point_at(job, at.map(|x| x as f32)) {
                    eye.focus(point);
                }
            }
            Move::Home => {}
        }
        (self.eye, self.is_moved) = (Some(eye), true);
    }

    /// Wants pictures of this size from now on, and takes smaller ones of the same shape if there is room for fewer pixels.
    /// Returns true if that is another size than before, or the first one.
    ///
    /// `shape` is that which pictures of the camera have, if it is none of a window.
    pub(super) fn resize(&mut self, wanted: [u32; 2], granted: u64, shape: Option<f64>) -> bool {
        let fitted = shape.map_or(wanted, |shape| within(wanted, shape));
        let pixels = u64::from(fitted[0]) * u64::from(fitted[1]);
        let factor = (granted as f64 / pixels.max(1) as f64).sqrt().min(1.0);
        let size = fitted.map(|side| ((f64::from(side) * factor) as u32).max(1));
        let is_other = size != self.size || self.home.is_none();
        (self.wanted_size, self.size) = (wanted, size);
        is_other
    }

    /// Keeps in the picture whatever was in it, in a window of another shape, where the scene has its camera elsewhere: its
    /// own camera may stand farther away where a window is narrow, and a camera that was moved does the same.
    pub(super) fn keep_in_view(&mut self, home: Option<Eye>) {
        let before = std::mem::replace(&mut self.home, home);
        match (self.is_moved, &mut self.eye, before, home) {
            (true, Some(eye), Some(before), Some(home)) => eye.keep_in_view(&before, &home),
            (true, ..) => {}
            (false, ..) => self.eye = home,
        }
    }

    /// True if the camera is inside of the scene, as in a room.
    pub(super) fn is_inside(&self, session: &Session) -> bool {
        let (job, own) = (session.job(), session.scene().objects.len());
        let bounds = own_bounds(job.completed_scene(), own, job.settings().time);
        self.eye.is_some_and(|eye| bounds.contains(eye.position.as_vec3()))
    }
}

/// The largest size of this width over height within another one.
fn within([width, height]: [u32; 2], shape: f64) -> [u32; 2] {
    let [wide, high] = [f64::from(width), f64::from(height)];
    let fitted = if shape * high > wide { [wide, wide / shape] } else { [high * shape, high] };
    fitted.map(|side| (side.round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_fits_into_any_window() {
        assert_eq!(within([1000, 1000], 2.0), [1000, 500]);
        assert_eq!(within([1000, 100], 2.0), [200, 100]);
        assert_eq!(within([390, 844], 6.0), [390, 65]);
        assert_eq!(within([3, 1], 0.01), [1, 1]);
    }
}
