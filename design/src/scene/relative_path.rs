//! Paths relative to the scene file.

use std::path::{Path, PathBuf};

/// The folder of a scene file.
pub(super) fn folder(scene: &Path) -> &Path {
    scene.parent().unwrap_or(Path::new(""))
}

/// A path written relative to the scene file, without `.` inside.
pub(super) fn beside(scene: &Path, path: &Path) -> PathBuf {
    folder(scene).join(path).components().collect()
}
