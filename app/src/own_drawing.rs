//! The drawing of a project, of which its folder has a copy.
//!
//! A picture of pixels (PNG, JPEG) is traced along the line where pixels differ from the ground by a
//! part of the largest difference, in colour or opacity. The ground is the median of the pixels at
//! the border. A shape that is a drawn line is filled.

use crate::{input_file, output_file, progress::announce};
use anyhow::Result;
use contour::ContourBuilder;
use design::geometry::polygon;
use image::{
    DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Rgba, RgbaImage,
    guess_format,
};
use scene::{
    drawing::drawn_outline::{NumberedPiece, numbered, pieces},
    target::Target,
};
use std::{
    fmt::Write,
    io::Cursor,
    path::{Path, PathBuf},
};
use support::{Fault, at, ensure, regular_file, statistics::median, unread};

/// The difference from the ground at which a picture is traced, relative to the largest one.
pub const THRESHOLD: f64 = 0.5;
/// Pixels along the longer side of a picture that is traced; a larger one is reduced.
const PIXELS: u32 = 1000;
/// Standard deviation of the blur that removes noise and the stairs of pixels (pixels).
const BLUR: f32 = 1.0;
/// Largest difference of a picture that shows nothing.
const FAINT: f64 = 0.1;
/// Smallest area in a traced line over the largest one: in smaller ones are specks.
const SPECK: f64 = 1e-3;
/// Area of the shape over the area that it encloses up to which it is a line: what it encloses is
/// the shape.
const LINES: f64 = 0.25;

/// A drawing.
pub struct OwnDrawing {
    /// The file that it was read from.
    origin: PathBuf,
    /// The number of its outline, if it is named.
    number: Option<usize>,
    /// SVG or DXF.
    contents: Vec<u8>,
    traced: bool,
}

impl OwnDrawing {
    /// The drawing in a file, behind whose name the number of an outline may stand.
    pub fn read(named: &Path) -> Result<Self> {
        let (file, number) = numbered(named);
        input_file::require(&file, "--target")?;
        let contents = regular_file::read(&file).map_err(unread(&file))?;
        let own = Self::new(file, number, contents, THRESHOLD)?;
        if own.traced {
            announce(&format!(
                "tracing {}: what differs from the colour of its border; the studio has a slider for how much",
                own.origin.display()
            ));
        }
        Ok(own)
    }

    /// The drawing with the contents of a file.
    pub fn new(
        origin: PathBuf,
        number: Option<usize>,
        contents: Vec<u8>,
        threshold: f64,
    ) -> Result<Self> {
        let traced = matches!(guess_format(&contents), Ok(ImageFormat::Png | ImageFormat::Jpeg));
        let contents = match traced {
            true => traced_at(&contents, threshold).map_err(at(origin.display()))?.into_bytes(),
            false => contents,
        };
        Ok(Self { origin, number, contents, traced })
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

    /// Whether it was a picture.
    pub fn is_traced(&self) -> bool {
        self.traced
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
        let own = self.origin.extension().unwrap_or_default().to_string_lossy();
        format!("{stem}{mark}.{}", if self.traced { "svg" } else { &own })
    }

    /// Centre of its bounding box and height (mm), if it has an area (mm^2) and the mean of its
    /// outline is at `centre` (mm).
    pub fn placed(&self, centre: [f64; 2], area: f64) -> Result<([f64; 2], f64)> {
        let placed = Target::place_drawing(&self.contents, self.number, centre, area);
        Ok(placed.map_err(at(self.origin.display()))?)
    }
}

/// Text of the SVG file of the lines in a picture.
fn traced_at(picture: &[u8], threshold: f64) -> Result<String, Fault> {
    let pixels = upright(picture).map_err(at("the picture cannot be read"))?;
    let (width, height) = pixels.dimensions();
    let ground = ground(&pixels);
    // A border of ground closes the lines that end at the edge of the picture.
    let [columns, rows] = [width, height].map(|count| count as usize + 2);
    let mut differences = vec![0.0; columns * rows];
    for (x, y, pixel) in pixels.enumerate_pixels() {
        let by_channel = std::iter::zip(seen(pixel), ground);
        let most = by_channel.map(|(own, ground)| (own - ground).abs()).fold(0.0, f64::max);
        differences[(y as usize + 1) * columns + x as usize + 1] = most;
    }
    let most = differences.iter().copied().fold(0.0, f64::max);
    ensure!(
        most > FAINT,
        "nothing in the picture differs from its border: it has to be a shape on a ground of one colour"
    );
    let lines = ContourBuilder::new(columns, rows, true).lines(&differences, &[threshold * most]);
    let lines = lines.map_err(at("the picture cannot be traced"))?;
    let rings = lines.iter().flat_map(|line| &line.geometry().0);
    let rings: Vec<Vec<[f64; 2]>> =
        rings.map(|ring| ring.0.iter().map(|at| [at.x, at.y]).collect()).collect();
    let ink = rings.iter().map(|ring| polygon::area(ring)).sum::<f64>().abs();
    let enclosed = rings.iter().map(|ring| polygon::area(ring).abs()).fold(0.0, f64::max);
    let least = if ink < LINES * enclosed { 1.0 } else { SPECK };
    let mut path = String::new();
    for ring in rings.iter().filter(|ring| polygon::area(ring).abs() >= least * enclosed) {
        for (i, [x, y]) in ring.iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{command}{x:.2} {y:.2}");
        }
        path.push('Z');
    }
    Ok(format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {columns} {rows}'>\
         <path fill-rule='evenodd' d='{path}'/></svg>\n"
    ))
}

/// The pixels of a picture, as it is to be seen, reduced to [`PIXELS`].
fn upright(picture: &[u8]) -> ImageResult<RgbaImage> {
    let reader = ImageReader::new(Cursor::new(picture)).with_guessed_format()?;
    let mut decoder = reader.into_decoder()?;
    let orientation = decoder.orientation()?;
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    if picture.width().max(picture.height()) > PIXELS {
        picture = picture.thumbnail(PIXELS, PIXELS);
    }
    Ok(picture.blur(BLUR).into_rgba8())
}

/// Red, green, blue and opacity as far as they are seen, 0 to 1.
fn seen(pixel: &Rgba<u8>) -> [f64; 4] {
    let [red, green, blue, opacity] = pixel.0.map(|channel| f64::from(channel) / 255.0);
    [red * opacity, green * opacity, blue * opacity, opacity]
}

/// The median of every channel at the border.
fn ground(pixels: &RgbaImage) -> [f64; 4] {
    let (width, height) = pixels.dimensions();
    let at_border = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
    let border = pixels.enumerate_pixels().filter(|(x, y, _)| at_border(*x, *y));
    let border: Vec<[f64; 4]> = border.map(|(.., pixel)| seen(pixel)).collect();
    std::array::from_fn(|channel| median(border.iter().map(|pixel| pixel[channel]).collect()))
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
        OwnDrawing::new("p.png".into(), None, png, THRESHOLD)?.placed([0.0; 2], 1e4)
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
            let drawing = OwnDrawing::new("p.png".into(), Some(1), png.clone(), 0.5).unwrap();
            assert_eq!(drawing.name("-a"), Path::new("p-a.svg#1"));
            let text = String::from_utf8(drawing.contents).unwrap();
            assert_eq!(text.matches('Z').count(), 2, "{text}");
            let (_, found) = placed(png).unwrap();
            assert!((found / height - 1.0).abs() < 2e-3, "{ink:?}: {found} {height}");
        }
    }

    /// A drawn line is filled, specks are left out, and a shape that ends at the border is closed.
    #[test]
    fn lines_are_filled_and_specks_left_out() {
        let line = |x: f64, y: f64| {
            let inside = |by: f64| (x - 100.0).abs() < 70.0 - by && (y - 80.0).abs() < 50.0 - by;
            (inside(0.0) && !inside(4.0)) || (x - 60.0).hypot(y - 60.0) < 2.0
        };
        let cut = |x: f64, y: f64| x > 60.0 && (y - 80.0).abs() < 50.0;
        for shape in [&line as &dyn Fn(f64, f64) -> bool, &cut] {
            let png = picture(|x, y| if shape(x, y) { [20, 20, 20, 255] } else { WHITE });
            let (_, height) = placed(png).unwrap();
            let expected = (1e4 / 1.4_f64).sqrt();
            assert!((height / expected - 1.0).abs() < 1e-2, "{height} {expected}");
        }
    }

    #[test]
    fn pictures_without_a_shape_are_refused() {
        let whole = picture(|x, _| if x < 50.0 { [0, 0, 0, 255] } else { WHITE });
        for (png, part) in [
            (picture(|_, _| WHITE), "p.png: nothing in the picture differs from its border"),
            (whole[..60].to_vec(), "p.png: the picture cannot be read"),
        ] {
            let error = placed(png).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
