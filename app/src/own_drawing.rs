//! The drawing of a project: its folder has a copy, or the tracing of a picture (PNG, JPEG).

mod traced;

use crate::{
    output_file,
    own_drawing::traced::{Traced, is_picture, traced},
    progress::announce,
};
use anyhow::Result;
use scene::{
    drawing::drawn_outline::{NumberedPiece, numbered, pieces},
    target::Target,
};
use std::path::{Path, PathBuf};
use support::{Point, at, regular_file, unread};

/// A drawing.
pub struct OwnDrawing {
    /// The file that it was read from.
    origin: PathBuf,
    /// The number of its outline, if it is named.
    number: Option<usize>,
    /// SVG or DXF.
    contents: Vec<u8>,
    /// How the picture was traced that it was.
    picture: Option<Traced>,
}

impl OwnDrawing {
    /// The drawing in a file, behind whose name the number of an outline may stand; a picture is
    /// traced at a difference from its ground over the largest one, if one is given.
    pub fn read(named: &Path, threshold: Option<f64>) -> Result<Self> {
        let (file, number) = numbered(named);
        let contents = regular_file::read(&file).map_err(unread(&file))?;
        let own = Self::new(file, number, contents, threshold)?;
        if let Some(Traced { threshold, is_line, .. }) = &own.picture {
            let lines = if *is_line { "; its shape is what a drawn line encloses" } else { "" };
            announce(&format!(
                "{} is traced where it differs from its border by {:.0} % of the largest difference (--threshold){lines}",
                own.origin.display(),
                100.0 * threshold
            ));
        }
        Ok(own)
    }

    /// The drawing with the contents of a file.
    pub fn new(
        origin: PathBuf,
        number: Option<usize>,
        contents: Vec<u8>,
        threshold: Option<f64>,
    ) -> Result<Self> {
        let picture = is_picture(&contents).then(|| traced(&contents, threshold));
        let picture = picture.transpose().map_err(at(origin.display()))?;
        let contents = picture.as_ref().map_or(contents, |picture| picture.svg.clone().into());
        Ok(Self { origin, number, contents, picture })
    }

    /// Its pieces, the largest first.
    pub fn pieces(&self) -> Result<Vec<NumberedPiece>> {
        Ok(pieces(&self.contents).map_err(at(self.origin.display()))?)
    }

    /// How a scene names its outline: a file in the folder of the scene, with `mark` behind its stem.
    pub fn name(&self, mark: &str) -> PathBuf {
        let file = self.file(mark);
        self.number.map_or(file.clone(), |number| format!("{file}#{number}")).into()
    }

    /// The difference from its ground at which a picture was traced, over the largest one.
    pub fn threshold(&self) -> Option<f64> {
        self.picture.as_ref().map(|picture| picture.threshold)
    }

    /// Hash of the drawing.
    pub fn hash(&self) -> String {
        blake3::hash(&self.contents).to_hex().to_string()
    }

    /// Writes the file.
    pub fn write(&self, folder: &Path, mark: &str) -> Result<()> {
        output_file::write(&folder.join(self.file(mark)), &self.contents)
    }

    fn file(&self, mark: &str) -> String {
        let stem = self.origin.file_stem().unwrap_or_default().to_string_lossy();
        let own = self.origin.extension().filter(|_| self.picture.is_none());
        let extension = own.map_or("svg".into(), |own| own.to_string_lossy());
        format!("{stem}{mark}.{extension}")
    }

    /// Centre of its bounding box and height (mm), if it has an area (mm^2) and the mean of its
    /// outline is at `centre` (mm).
    pub fn placed(&self, centre: Point, area: f64) -> Result<(Point, f64)> {
        let placed = Target::place_drawing(&self.contents, self.number, centre, area);
        Ok(placed.map_err(at(self.origin.display()))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

    /// A picture of 200 x 160 pixels whose colours are a function of the place.
    fn picture(colour: impl Fn(f64, f64) -> [u8; 4]) -> Vec<u8> {
        let pixels = (0..160).flat_map(|y| (0..200).map(move |x| (x, y)));
        let pixels: Vec<u8> =
            pixels.flat_map(|(x, y)| colour(f64::from(x) + 0.5, f64::from(y) + 0.5)).collect();
        let mut png = Vec::new();
        PngEncoder::new(&mut png).write_image(&pixels, 200, 160, ExtendedColorType::Rgba8).unwrap();
        png
    }

    /// The height of the outline in a picture that gives it an area of 10 000 and, at the same
    /// place, its centre.
    fn placed(png: Vec<u8>) -> Result<([f64; 2], f64)> {
        OwnDrawing::new("p.png".into(), None, png, None)?.placed([0.0; 2], 1e4)
    }

    const WHITE: [u8; 4] = [255; 4];

    /// A disc with a hole has the height of a circle with the area of its outline, whatever its
    /// colours are.
    #[test]
    fn shapes_of_all_colours_are_traced() {
        let ring = |x: f64, y: f64| (20.0..60.0).contains(&(x - 90.0).hypot(y - 80.0));
        let height = 2.0 * (1e4 / std::f64::consts::PI).sqrt();
        for [ink, ground] in [
            [[0, 0, 0, 255], WHITE],
            [[255, 220, 0, 255], WHITE],
            [WHITE, [30, 30, 60, 255]],
            [[255, 255, 255, 200], [0; 4]],
        ] {
            let png = picture(|x, y| if ring(x, y) { ink } else { ground });
            let drawing = OwnDrawing::new("p.png".into(), Some(1), png.clone(), None).unwrap();
            assert_eq!(drawing.name("-a"), Path::new("p-a.svg#1"));
            assert_eq!(drawing.picture.unwrap().svg.matches('Z').count(), 2);
            let (_, found) = placed(png).unwrap();
            assert!((found / height - 1.0).abs() < 2e-3, "{ink:?}: {found} {height}");
        }
    }

    fn of_ink(shape: impl Fn(f64, f64) -> bool) -> Vec<u8> {
        picture(|x, y| if shape(x, y) { [20, 20, 20, 255] } else { WHITE })
    }

    /// Whether a point is on a circle about the middle, drawn with a pen.
    fn circle(x: f64, y: f64, radius: f64) -> bool {
        ((x - 100.0).hypot(y - 80.0) - radius).abs() < 1.5
    }

    /// A drawn line is filled, less what lines in it enclose, specks are left out, and a shape that
    /// ends at the border is closed.
    #[test]
    fn lines_are_filled_and_specks_left_out() {
        let line = of_ink(|x, y| {
            let inside = |by: f64| (x - 100.0).abs() < 70.0 - by && (y - 80.0).abs() < 50.0 - by;
            (inside(0.0) && !inside(4.0)) || (x - 60.0).hypot(y - 60.0) < 2.0
        });
        let cut = of_ink(|x, y| x > 60.0 && (y - 80.0).abs() < 50.0);
        for png in [line, cut] {
            let (_, height) = placed(png).unwrap();
            let expected = (1e4 / 1.4_f64).sqrt();
            assert!((height / expected - 1.0).abs() < 1e-2, "{height} {expected}");
        }
        let ring = traced(&of_ink(|x, y| circle(x, y, 60.0) || circle(x, y, 30.0)), None).unwrap();
        assert!(ring.is_line && ring.svg.matches('Z').count() == 2, "{}", ring.svg);
    }

    #[test]
    fn pictures_without_a_shape_are_refused() {
        let whole = of_ink(|x, _| x < 50.0);
        for (png, part) in [
            (picture(|_, _| WHITE), "p.png: nothing in the picture differs from its border"),
            (of_ink(|x, y| circle(x, y, 60.0) && y > 30.0), "a line with two ends"),
            (whole[..60].to_vec(), "p.png: the picture cannot be read"),
        ] {
            let error = placed(png).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
