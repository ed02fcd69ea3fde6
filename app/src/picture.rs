//! Raster images: a PNG is written next to every SVG.

use crate::output_file;
use anyhow::{Context, Result};
use resvg::{
    tiny_skia,
    usvg::{self, fontdb::Database},
};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock},
};

/// Writes `<stem>.svg` and `<stem>.png`, the latter `width` pixels wide; returns both paths.
pub fn save(svg: &str, stem: &Path, width: u32) -> Result<[PathBuf; 2]> {
    let [vector, raster] = ["svg", "png"].map(|extension| stem.with_extension(extension));
    let png = rasterise(svg, width)?.encode_png()?;
    output_file::write(&vector, svg)?;
    output_file::write(&raster, png)?;
    Ok([vector, raster])
}

static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Arc::new(fonts)
});

/// The pixels of a picture. Uses only the bundled DejaVu Sans, so that it is the same on every
/// machine.
pub(crate) fn rasterise(svg: &str, width: u32) -> Result<tiny_skia::Pixmap> {
    let options = usvg::Options {
        font_family: "DejaVu Sans".into(),
        fontdb: Arc::clone(&FONTS),
        ..Default::default()
    };
    let tree = usvg::Tree::from_str(svg, &options).context("the picture is not valid SVG")?;
    let scale = width as f32 / tree.size().width();
    let height = (tree.size().height() * scale).ceil() as u32;
    let mut pixels = tiny_skia::Pixmap::new(width, height)
        .with_context(|| format!("cannot draw a picture of {width} x {height} pixels"))?;
    pixels.fill(tiny_skia::Color::WHITE);
    let transform = tiny_skia::Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_shapes_leave_ink() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100">
            <text x="10" y="60" font-size="40">ink</text></svg>"##;
        let pixels = rasterise(svg, 400).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (400, 200));
        assert!(pixels.pixels().iter().any(|p| p.red() < 50));
    }

    #[test]
    fn a_broken_picture_is_an_error() {
        assert!(rasterise("<svg", 100).is_err());
    }
}
