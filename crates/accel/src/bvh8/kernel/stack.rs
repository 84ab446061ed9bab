//! The traversal stack.

use crate::bvh8::build::binary::MAX_DEPTH;
use crate::bvh8::layout::{Ref, WIDTH};
use std::mem::MaybeUninit;

/// Maximum number of references on the stack when a search begins: the tails of a ray in an incoherent packet.
pub(super) const MAX_AT_START: usize = 24;

/// Every node on the way down leaves at most seven others on the stack; a whole vector is written at the top.
pub(super) const CAPACITY: usize = MAX_AT_START + MAX_DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// Memory of a stack: first the references, then the distances at which the ray enters each. It is not initialised,
/// because clearing it would take as long as a short ray.
pub(super) type StackStorage = MaybeUninit<[u32; 2 * CAPACITY]>;

/// References still to be visited, and the bits of the entry distances, whose last three bits have no meaning.
#[derive(Clone, Copy)]
pub(in crate::bvh8) struct Stack {
    base: *mut u32,
    top: *mut u32,
}

impl Stack {
    /// An empty stack, which must not outlive its memory.
    #[inline(always)]
    pub(super) fn new(storage: &mut StackStorage) -> Stack {
        let base = storage.as_mut_ptr().cast();
        Stack { base, top: base }
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.top == self.base
    }

    /// Empty stack in the same memory.
    #[inline(always)]
    pub(super) fn cleared(&self) -> Stack {
        Stack { base: self.base, top: self.base }
    }

    /// Address of the next reference, followed by those of later ones.
    #[inline(always)]
    pub(super) fn references(&self) -> *mut u32 {
        self.top
    }

    /// Address of the distance of the next reference.
    #[inline(always)]
    pub(super) fn distances(&self) -> *mut u32 {
        self.top.wrapping_add(CAPACITY)
    }

    /// Takes what was written above the top into the stack.
    ///
    /// # Safety
    /// It must have been written, and there must be space for [`WIDTH`] more.
    #[inline(always)]
    pub(super) unsafe fn grow(&mut self, by: usize) {
        // SAFETY: the tree is not deeper than the stack allows.
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
