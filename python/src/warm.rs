//! The states that the next solves of a problem start from.

use design::equilibrium::warm_start::WarmStart;
use std::sync::Arc;

/// What the next solves start from.
#[derive(Default)]
pub(crate) struct Warm {
    pub path: KnownPath,
    pub state: KnownPath,
}

/// Load steps that are known, and how many solves have been corrected from one another since the
/// last followed path.
#[derive(Default)]
pub(crate) struct KnownPath {
    pub path: Option<Arc<WarmStart>>,
    pub corrected: usize,
}

impl KnownPath {
    /// The path to start from; none when the next one is to be followed from the flat sheet.
    pub(crate) fn usable(&self, follow_every: usize) -> Option<Arc<WarmStart>> {
        self.path.clone().filter(|_| self.corrected + 1 < follow_every)
    }

    pub(crate) fn keep(&mut self, deployment: &design::Deployment) {
        self.corrected = if deployment.followed { 0 } else { self.corrected + 1 };
        self.path = Some(Arc::new(deployment.warm_start()));
    }
}
