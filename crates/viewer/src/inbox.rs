//! Requests of those who watch, kept until the render takes them. However many there are, they take a bounded amount of
//! memory: moves add up, a later value of a setting replaces an earlier one, and questions that are too many are refused.

use crate::message::{Move, Other, Question, Request};
use bilux::scene::Parameters;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The maximum number of questions that wait for an answer.
pub(crate) const QUESTIONS: usize = 64;
/// The maximum number of different moves or settings that wait.
const MOVES: usize = 64;

/// Requests that wait to be taken.
#[derive(Default)]
pub(crate) struct Waiting {
    /// Moves of the camera, in order; consecutive ones of a kind are added up.
    pub(crate) moves: Vec<Move>,
    /// The size of the picture, in pixels.
    pub(crate) size: Option<[u32; 2]>,
    /// Settings.
    pub(crate) settings: Parameters,
    /// The name of what is shown: the picture, or one of its layers.
    pub(crate) shown: Option<String>,
    /// The picture to compare with; `Some(None)` ends the comparison.
    pub(crate) compared: Option<Option<Other>>,
    /// Whether differences are shown.
    pub(crate) differences: Option<bool>,
    /// Questions, in order.
    pub(crate) questions: Vec<Question>,
    /// There is another version of the scene.
    pub(crate) scene_changed: bool,
    /// The newest answer to what was asked of the scene: nothing, or why it cannot be done.
    pub(crate) answered: Option<Option<String>>,
}

impl Waiting {
    /// True if the render is to stop what it does: the picture changes, or somebody waits for a pixel.
    fn interrupts(&self) -> bool {
        self.changes_picture()
            || self.answered.is_some()
            || self.questions.iter().any(|it| !matches!(it, Question::Save { .. }))
    }

    /// True if it changes the picture.
    pub(crate) fn changes_picture(&self) -> bool {
        !self.moves.is_empty()
            || self.size.is_some()
            || !self.settings.0.is_empty()
            || self.shown.is_some()
            || self.scene_changed
            || self.compared.is_some()
            || self.differences.is_some()
    }
}

/// The requests of all who watch.
#[derive(Default)]
pub(crate) struct Inbox {
    waiting: Mutex<Waiting>,
    bell: Condvar,
    /// Whether the render is to stop what it does.
    interrupts: AtomicBool,
    rings: AtomicBool,
    has_ended: AtomicBool,
}

impl Inbox {
    /// Takes a request.
    ///
    /// # Errors
    /// If too much waits already; the message is for whoever asked.
    pub(crate) fn post(&self, request: Request) -> Result<(), String> {
        let full = || Err("too much is asked for at once: wait a moment".to_owned());
        let mut waiting = self.lock();
        if self.has_ended() {
            return Err("this view has ended: open the page again".to_owned());
        }
        match request {
            Request::Move(next) => match waiting.moves.last_mut().map(|last| last.add(&next)) {
                Some(true) => {}
                _ if waiting.moves.len() >= MOVES => return full(),
                _ => waiting.moves.push(next),
            },
            Request::Size(size) => waiting.size = Some(size),
            Request::Set(key, value) => {
                if waiting.settings.0.len() >= MOVES && waiting.settings.find(&key).is_none() {
                    return full();
                }
                waiting.settings.set(&key, value);
            }
            Request::Show(what) => waiting.shown = Some(what),
            Request::Compare(other) => waiting.compared = Some(other),
            Request::Differences(are_shown) => waiting.differences = Some(are_shown),
            Request::Ask(question) => {
                if waiting.questions.len() >= QUESTIONS {
                    return full();
                }
                waiting.questions.push(question);
            }
            Request::SceneChanged => waiting.scene_changed = true,
            // A problem must be seen, even if something else that was asked for is done.
            Request::Answered(problem) => {
                waiting.answered = Some(problem.or(waiting.answered.take().flatten()));
            }
        }
        if waiting.interrupts() {
            self.interrupts.store(true, Ordering::Relaxed);
        }
        drop(waiting);
        self.ring();
        Ok(())
    }

    /// Takes what waits, as soon as there is something, or after this time; if none is given, as soon as there is something.
    pub(crate) fn take(&self, wait: Option<Duration>) -> Waiting {
        let mut waiting = self.lock();
        let is_idle = |_: &mut Waiting| !self.rings.load(Ordering::Relaxed);
        waiting = match wait {
            Some(time) => {
                let woken = self.bell.wait_timeout_while(waiting, time, is_idle);
                woken.unwrap_or_else(PoisonError::into_inner).0
            }
            None => self.bell.wait_while(waiting, is_idle).unwrap_or_else(PoisonError::into_inner),
        };
        self.interrupts.store(false, Ordering::Relaxed);
        self.rings.store(false, Ordering::Relaxed);
        std::mem::take(&mut *waiting)
    }

    /// Wakes the render, which looks whether anything has changed.
    pub(crate) fn ring(&self) {
        let _waiting = self.lock();
        self.rings.store(true, Ordering::Relaxed);
        self.bell.notify_all();
    }

    /// Ends the render. Nothing more is asked for, and what waits gets no answer.
    pub(crate) fn end(&self) {
        let mut waiting = self.lock();
        self.has_ended.store(true, Ordering::Relaxed);
        self.interrupts.store(true, Ordering::Relaxed);
        waiting.questions.clear();
        drop(waiting);
        self.ring();
    }

    /// True once the render is to end.
    pub(crate) fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Relaxed)
    }

    /// True if the render is to stop what it does, and to look at what waits.
    pub(crate) fn interrupts(&self) -> bool {
        self.interrupts.load(Ordering::Relaxed)
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::scene::Value;

    #[test]
    fn moves_add_up_and_settings_replace_each_other() {
        let inbox = Inbox::default();
        for i in 0..10_000 {
            inbox.post(Request::Move(Move::Orbit([1.0, 0.5]))).unwrap();
            inbox.post(Request::Set("seed".to_owned(), Value::Integer(i))).unwrap();
            inbox.post(Request::Size([i as u32, 7])).unwrap();
        }
        assert!(inbox.interrupts());
        let waiting = inbox.take(None);
        assert_eq!(waiting.moves, [Move::Orbit([10_000.0, 5_000.0])]);
        assert_eq!(waiting.settings.0.len(), 1);
        assert_eq!(waiting.size, Some([9_999, 7]));
        assert!(!inbox.interrupts());
    }

    /// The picture changes only by what changes it, and whoever waits for a pixel waits for no sample.
    #[test]
    fn each_request_interrupts_the_render_if_somebody_waits_for_it() {
        let answers = || tokio::sync::mpsc::channel(1).0;
        let all: Vec<(&str, Request, [bool; 2])> = vec![
            ("move", Request::Move(Move::Home), [true, true]),
            ("size", Request::Size([1, 1]), [true, true]),
            ("set", Request::Set("seed".to_owned(), Value::Integer(1)), [true, true]),
            ("show", Request::Show("picture".to_owned()), [true, true]),
            ("compare", Request::Compare(None), [true, true]),
            ("differences", Request::Differences(true), [true, true]),
            ("scene", Request::SceneChanged, [true, true]),
            ("answer", Request::Answered(None), [false, true]),
            (
                "pick",
                Request::Ask(Question::Pick { at: [0.0; 2], paths: 1, answers: answers() }),
                [false, true],
            ),
            ("measure", Request::Ask(Question::Measure { answers: answers() }), [false, true]),
            (
                "save",
                Request::Ask(Question::Save { format: "png", to: tokio::sync::oneshot::channel().0 }),
                [false, false],
            ),
        ];
        for (name, request, [changes, interrupts]) in all {
            let inbox = Inbox::default();
            inbox.post(request).unwrap();
            assert_eq!(inbox.interrupts(), interrupts, "{name}");
            assert_eq!(inbox.take(None).changes_picture(), changes, "{name}");
        }
        let inbox = Inbox::default();
        for problem in [Some("first".to_owned()), None] {
            inbox.post(Request::Answered(problem)).unwrap();
        }
        assert_eq!(inbox.take(None).answered, Some(Some("first".to_owned())), "a problem is not lost");
    }

    /// A slider moves on however much waits; only what is new finds no room.
    #[test]
    fn a_full_inbox_takes_later_values_of_the_settings_that_wait() {
        let inbox = Inbox::default();
        let set = |i: usize, value: i64| inbox.post(Request::Set(format!("key{i}"), Value::Integer(value)));
        (0..MOVES).for_each(|i| set(i, 0).unwrap());
        assert!(set(MOVES, 0).is_err());
        set(3, 7).unwrap();
        let waiting = inbox.take(None);
        assert_eq!(waiting.settings.0.len(), MOVES);
        assert_eq!(waiting.settings.find("key3").map(|(value, _)| value.clone()), Some(Value::Integer(7)));
    }

    #[test]
    fn whoever_asks_when_the_view_has_ended_waits_for_nothing() {
        let inbox = Inbox::default();
        let ask = |inbox: &Inbox| {
            let (to, mut answer) = tokio::sync::oneshot::channel();
            let posted = inbox.post(Request::Ask(Question::Save { format: "png", to }));
            (posted.is_ok(), move || {
                answer.try_recv() == Err(tokio::sync::oneshot::error::TryRecvError::Closed)
            })
        };
        let (is_taken, mut is_lost) = ask(&inbox);
        assert!(is_taken && !is_lost());
        inbox.end();
        assert!(is_lost());
        let (is_taken, mut is_lost) = ask(&inbox);
        assert!(!is_taken && is_lost());
    }

    #[test]
    fn what_waits_is_bounded() {
        let inbox = Inbox::default();
        let moves = (0..1000).map(|i| match i % 2 {
            0 => Request::Move(Move::Orbit([1.0, 0.0])),
            _ => Request::Move(Move::Home),
        });
        let settings = (0..1000).map(|i| Request::Set(format!("key{i}"), Value::Integer(i)));
        let refused = moves.chain(settings).filter_map(|request| inbox.post(request).err()).count();
        let waiting = inbox.take(None);
        assert_eq!((waiting.moves.len(), waiting.settings.0.len()), (MOVES, MOVES));
        assert!(refused > 1000, "{refused}");
    }
}
