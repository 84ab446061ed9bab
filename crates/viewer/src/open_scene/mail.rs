//! Requests of visitors to the scene, kept until the thread of the scene takes them. However many there are, they take a bounded
//! amount of memory: a later value of a parameter replaces one that still waits.

use crate::inbox::Inbox;
use crate::message::SceneRequest;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The maximum number of requests that wait.
const WAITING: usize = 64;

/// A request, and the inbox of who has asked; nobody has if a file has changed.
pub(crate) struct Sent {
    pub(crate) request: SceneRequest,
    pub(crate) from: Option<Arc<Inbox>>,
}

/// Requests that wait.
#[derive(Default)]
pub(crate) struct Mail {
    waiting: Mutex<Vec<Sent>>,
    bell: Condvar,
    has_ended: AtomicBool,
}

impl Mail {
    /// Takes a request.
    ///
    /// # Errors
    /// If too much waits already; the message is for whoever asked.
    pub(super) fn post(&self, sent: Sent) -> Result<(), String> {
        let mut waiting = self.lock();
        if waiting.last().is_some_and(|last| last.request.gives_way_to(&sent.request)) {
            waiting.pop();
        } else if waiting.len() >= WAITING {
            return Err("too much is asked for at once: wait a moment".to_owned());
        }
        waiting.push(sent);
        self.bell.notify_all();
        Ok(())
    }

    /// Takes what waits, in order, as soon as there is something or the mail has ended.
    pub(super) fn take(&self) -> Vec<Sent> {
        let is_idle = |waiting: &mut Vec<Sent>| waiting.is_empty() && !self.has_ended();
        let mut waiting = self.bell.wait_while(self.lock(), is_idle).unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut *waiting)
    }

    pub(super) fn end(&self) {
        let _waiting = self.lock();
        self.has_ended.store(true, Ordering::Relaxed);
        self.bell.notify_all();
    }

    pub(super) fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Relaxed)
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Sent>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::scene::{Part, Value};

    fn edit(part: Part, number: usize, key: &str, value: i64) -> SceneRequest {
        SceneRequest::Edit { part, number, key: key.to_owned(), value: Value::Integer(value) }
    }

    /// Each differs from the one before it in one respect only, and none may be lost.
    #[test]
    fn only_a_later_value_of_the_same_parameter_replaces_an_earlier_one() {
        let mail = Mail::default();
        let all = [
            edit(Part::Light, 0, "radiance", 1),
            edit(Part::Light, 0, "radiance", 2),
            edit(Part::Light, 1, "radiance", 3),
            edit(Part::Material, 1, "radiance", 4),
            edit(Part::Material, 1, "scale", 5),
            SceneRequest::Undo,
            SceneRequest::Undo,
            SceneRequest::Time(Value::Number(1.0)),
            SceneRequest::Time(Value::Number(2.0)),
            SceneRequest::Reload,
            SceneRequest::Reload,
        ];
        for request in all {
            mail.post(Sent { request, from: None }).unwrap();
        }
        let left: Vec<String> = mail
            .take()
            .iter()
            .map(|sent| match &sent.request {
                SceneRequest::Edit { part, number, key, value: Value::Integer(value) } => {
                    format!("{} {number} {key} {value}", part.name())
                }
                SceneRequest::Time(Value::Number(time)) => format!("time {time}"),
                SceneRequest::Undo => "undo".to_owned(),
                SceneRequest::Reload => "reload".to_owned(),
                _ => "another".to_owned(),
            })
            .collect();
        let expected = [
            "light 0 radiance 2",
            "light 1 radiance 3",
            "material 1 radiance 4",
            "material 1 scale 5",
            "undo",
            "undo",
            "time 2",
            "reload",
        ];
        assert_eq!(left, expected);
    }

    #[test]
    fn what_waits_is_bounded() {
        let mail = Mail::default();
        let post = |_: &usize| mail.post(Sent { request: SceneRequest::Undo, from: None }).is_err();
        assert_eq!((0..100).filter(post).count(), 100 - WAITING);
        assert_eq!(mail.take().len(), WAITING);
    }
}
