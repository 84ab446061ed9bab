//! Turns of the views. Small pictures, which are shown while a camera moves, wait for nobody. Pictures in full size take turns:
//! so each visitor gets the same time, however many there are, and only one of them uses all cores and the memory for it.

use crate::inbox::Inbox;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Inboxes of the views that wait for their turn, in order; it is the turn of the first one.
#[derive(Default)]
pub(crate) struct Turns(Mutex<VecDeque<Arc<Inbox>>>);

impl Turns {
    /// True if it is the turn of the owner of this inbox. If it is not, the inbox rings as soon as it is.
    pub(crate) fn is_turn_of(&self, inbox: &Arc<Inbox>) -> bool {
        let mut waiting = self.lock();
        if !waiting.iter().any(|other| Arc::ptr_eq(other, inbox)) {
            waiting.push_back(inbox.clone());
        }
        waiting.front().is_some_and(|first| Arc::ptr_eq(first, inbox))
    }

    /// The owner of this inbox is done, or does not wait any more: the next one is rung for.
    pub(crate) fn leave(&self, inbox: &Arc<Inbox>) {
        let mut waiting = self.lock();
        let Some(place) = waiting.iter().position(|other| Arc::ptr_eq(other, inbox)) else { return };
        waiting.remove(place);
        if let (0, Some(next)) = (place, waiting.front()) {
            next.ring();
        }
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Arc<Inbox>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn each_gets_a_turn_in_order_and_whoever_leaves_lets_the_next_one_in() {
        let turns = Turns::default();
        let all: Vec<Arc<Inbox>> = (0..3).map(|_| Arc::default()).collect();
        let mut order: Vec<usize> = Vec::new();
        for _ in 0..7 {
            let now: Vec<usize> = (0..3).filter(|&i| turns.is_turn_of(&all[i])).collect();
            assert_eq!(now.len(), 1, "one at a time");
            order.extend(&now);
            turns.leave(&all[now[0]]);
        }
        assert_eq!(order, [0, 1, 2, 0, 1, 2, 0]);
        // It is the turn of 1. One that only waits leaves without ringing for anybody.
        let rung = |i: usize| {
            let begun = std::time::Instant::now();
            all[i].take(Some(Duration::from_millis(50)));
            begun.elapsed() < Duration::from_millis(50)
        };
        all.iter().for_each(|inbox| drop(inbox.take(Some(Duration::ZERO))));
        turns.is_turn_of(&all[0]);
        turns.leave(&all[2]);
        assert!(!rung(0) && turns.is_turn_of(&all[1]));
        turns.leave(&all[1]);
        assert!(rung(0) && turns.is_turn_of(&all[0]));
    }
}
