//! What waits to be visited.

use crate::bvh8::build::binary::MAX_DEPTH;
use crate::bvh8::layout::{Ref, WIDTH};
use std::mem::MaybeUninit;

/// Every node on the way down leaves at most seven others behind; a whole vector is written at the top.
const ROOM: usize = MAX_DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// Where a stack lies: first the references, then where the ray enters each. Not written before it is used: to clear
/// it would take as long as a short ray.
pub(super) type Room = MaybeUninit<[u32; 2 * ROOM]>;

/// What is still to be visited, and the bits of where the ray enters it, the last three of no meaning.
#[derive(Clone, Copy)]
pub(in crate::bvh8) struct Stack {
    base: *mut u32,
    top: *mut u32,
}

impl Stack {
    /// An empty one, that must not be used longer than its room.
    #[inline(always)]
    pub(super) fn new(room: &mut Room) -> Stack {
        let base = room.as_mut_ptr().cast();
        Stack { base, top: base }
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.top == self.base
    }

    /// The same without anything on it.
    #[inline(always)]
    pub(super) fn cleared(&self) -> Stack {
        Stack { base: self.base, top: self.base }
    }

    /// Where the next reference goes, and those behind it.
    #[inline(always)]
    pub(super) fn references(&self) -> *mut u32 {
        self.top
    }

    /// Where the distance of the next reference goes.
    #[inline(always)]
    pub(super) fn distances(&self) -> *mut u32 {
        self.top.wrapping_add(ROOM)
    }

    /// What was written behind the top belongs to the stack.
    ///
    /// # Safety
    /// It must have been written, and there must be room for [`WIDTH`] more.
    #[inline(always)]
    pub(super) unsafe fn grow(&mut self, by: usize) {
        // SAFETY: the tree is not deeper than there is room for.
        self.top = unsafe { self.top.add(by) };
    }

    /// # Safety
    /// As for [`Stack::grow`].
    #[inline(always)]
    pub(super) unsafe fn put(&mut self, reference: Ref, enter: u32) {
        // SAFETY: as above.
        unsafe {
            self.references().write(reference.0);
            self.distances().write(enter);
            self.grow(1);
        }
    }

    /// # Safety
    /// The stack must not be empty.
    #[inline(always)]
    pub(super) unsafe fn take_reference(&mut self) -> Ref {
        // SAFETY: everything below the top has been written.
        unsafe {
            self.top = self.top.sub(1);
            Ref(self.top.read())
        }
    }

    /// # Safety
    /// The stack must not be empty, and hold distances.
    #[inline(always)]
    pub(super) unsafe fn take(&mut self) -> (Ref, u32) {
        // SAFETY: as above.
        unsafe { (self.take_reference(), self.distances().read()) }
    }
}
