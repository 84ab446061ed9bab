//! What 'bilux bench' runs.
