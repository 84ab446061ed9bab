//! The queries of a level, each a function that is compiled for its instructions.

/// The queries of a level, each compiled for its features with all of the body inlined.
macro_rules! entries {
    ($level:ty, $features:literal) => {
        /// See [`super::closest`]; for [`crate::Query::PLAIN`].
        ///
        /// # Safety
        /// The machine must have the level, and the view must be sound; this applies to all that follow.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest<
            F: $crate::bvh8::kernel::node_format::NodeFormat,
            C: $crate::counters::Count,
        >(
            units: &[$crate::bvh8::layout::Unit],
            outline: &$crate::bvh8::summary::TreeSummary,
            ray: &$crate::Ray,
            count: &mut C,
        ) -> Option<$crate::Hit> {
            let view = $crate::bvh8::kernel::view::TreeView { units, outline };
            // SAFETY: as the caller promises.
            unsafe {
                $crate::bvh8::kernel::body::closest::<$level, F, C, true>(
                    view,
                    ray,
                    &$crate::Query::PLAIN,
                    count,
                )
            }
        }

        /// See [`super::closest`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_by<
            F: $crate::bvh8::kernel::node_format::NodeFormat,
            C: $crate::counters::Count,
        >(
            view: $crate::bvh8::kernel::view::TreeView<'_>,
            ray: &$crate::Ray,
            query: &$crate::Query,
            count: &mut C,
        ) -> Option<$crate::Hit> {
            // SAFETY: as the caller promises.
            unsafe { $crate::bvh8::kernel::body::closest::<$level, F, C, false>(view, ray, query, count) }
        }

        /// See [`super::any`]; for [`crate::Query::PLAIN`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any<
            F: $crate::bvh8::kernel::node_format::NodeFormat,
            C: $crate::counters::Count,
        >(
            units: &[$crate::bvh8::layout::Unit],
            outline: &$crate::bvh8::summary::TreeSummary,
            ray: &$crate::Ray,
            count: &mut C,
        ) -> $crate::bvh8::kernel::blocker::Blocker {
            let view = $crate::bvh8::kernel::view::TreeView { units, outline };
            // SAFETY: as the caller promises.
            unsafe {
                $crate::bvh8::kernel::body::any::<$level, F, C, true>(view, ray, &$crate::Query::PLAIN, count)
            }
        }

        /// See [`super::any`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_by<
            F: $crate::bvh8::kernel::node_format::NodeFormat,
            C: $crate::counters::Count,
        >(
            view: $crate::bvh8::kernel::view::TreeView<'_>,
            ray: &$crate::Ray,
            query: &$crate::Query,
            count: &mut C,
        ) -> $crate::bvh8::kernel::blocker::Blocker {
            // SAFETY: as the caller promises.
            unsafe { $crate::bvh8::kernel::body::any::<$level, F, C, false>(view, ray, query, count) }
        }
    };
}

/// Queries of a level for batches, at levels that support them.
macro_rules! batch_entries {
    ($level:ty, $features:literal) => {
        /// See [`super::closest_each`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_each(
            view: $crate::bvh8::kernel::view::TreeView<'_>,
            rays: &[$crate::Ray],
            query: &$crate::Query,
            hits: &mut [Option<$crate::Hit>],
        ) {
            let rays = &rays[..rays.len().min(hits.len())];
            // SAFETY: as the caller promises.
            unsafe {
                $crate::bvh8::kernel::batch::each::<$level, false>(view, rays, query, |index, hit| {
                    hits[index] = hit
                })
            }
        }

        /// See [`super::any_each`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_each(
            view: $crate::bvh8::kernel::view::TreeView<'_>,
            rays: &[$crate::Ray],
            query: &$crate::Query,
            blockers: &mut [$crate::bvh8::kernel::blocker::Blocker],
        ) {
            let rays = &rays[..rays.len().min(blockers.len())];
            let note = |index: usize, hit: Option<$crate::Hit>| {
                blockers[index] = hit.and_then(|hit| $crate::bvh8::kernel::blocker::blocker(hit.primitive));
            };
            // SAFETY: as the caller promises.
            unsafe { $crate::bvh8::kernel::batch::each::<$level, true>(view, rays, query, note) }
        }
    };
}

pub(super) use {batch_entries, entries};
