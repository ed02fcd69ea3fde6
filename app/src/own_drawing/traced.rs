//! A picture of pixels (PNG, JPEG) as a drawing.
//!
//! A pixel differs from the ground, the median of the pixels at the border, by the largest
//! difference of its colours and its opacity. The picture is traced where this is a part of the
//! largest one: by default the middle between the means of the ground and of the shape, which are
//! told apart as Otsu does (IEEE Trans. SMC 9, 1979, 62). The shape of a drawn line is what it
//! encloses, less what lines inside of it enclose.

use contour::ContourBuilder;
use design::geometry::{polygon, region::Ring};
use image::{
    DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Rgba, RgbaImage,
    guess_format,
};
use std::{f64::consts::PI, fmt::Write, io::Cursor};
use support::{Extremes, Fault, at, ensure, statistics::median};

/// Pixels along the longer side of a picture that is traced; a larger one is reduced.
const PIXELS: u32 = 1000;
/// Standard deviation of the blur that removes noise and the stairs of pixels (pixels), and the
/// longer side of a picture from which on it is so large.
const BLUR: f32 = 1.0;
const BLURRED: f32 = 500.0;
/// Largest difference of a picture that shows nothing.
const FAINT: f64 = 0.1;
/// Smallest area in a traced line over the largest one: in smaller ones are specks.
const SPECK: f64 = 1e-3;
/// Area of a shape over the area in its outline up to which it is a drawn line.
const LINE: f64 = 0.15;
/// The same of a disc with the circumference of a shape up to which it is a line with two ends.
const OPEN: f64 = 0.04;
/// How a JPEG ends, and how many bytes may be behind that.
const JPEG_END: [u8; 2] = [0xFF, 0xD9];
const BEHIND_END: usize = 4096;

/// Whether the contents of a file are a picture that can be traced.
pub(super) fn is_picture(contents: &[u8]) -> bool {
    matches!(guess_format(contents), Ok(ImageFormat::Png | ImageFormat::Jpeg))
}

/// A traced picture.
pub(super) struct Traced {
    /// Text of the SVG file.
    pub svg: String,
    /// The difference at which it is traced, over the largest one.
    pub threshold: f64,
    /// Whether its shape is a drawn line.
    pub is_line: bool,
}

/// Traces a picture at a difference, over the largest one, if one is given.
pub(super) fn traced(picture: &[u8], threshold: Option<f64>) -> Result<Traced, Fault> {
    let pixels = upright(picture).map_err(at("the picture cannot be read"))?;
    let tail = &picture[picture.len().saturating_sub(BEHIND_END)..];
    ensure!(
        guess_format(picture).is_ok_and(|it| it != ImageFormat::Jpeg)
            || tail.windows(2).any(|bytes| bytes == JPEG_END),
        "the picture cannot be read: its end is missing"
    );
    let (width, height) = pixels.dimensions();
    let ground = ground(&pixels);
    // A border of ground closes the lines that end at the edge of the picture.
    let [columns, rows] = [width, height].map(|count| count as usize + 2);
    let mut differences = vec![0.0; columns * rows];
    for (x, y, pixel) in pixels.enumerate_pixels() {
        let by_channel = std::iter::zip(seen(pixel), ground);
        let most = by_channel.map(|(own, ground)| (own - ground).abs()).largest();
        differences[(y as usize + 1) * columns + x as usize + 1] = most;
    }
    let most = differences.iter().copied().largest();
    ensure!(
        most > FAINT,
        "nothing in the picture differs from its border: it has to be a shape on a ground of one colour"
    );
    differences.iter_mut().for_each(|difference| *difference /= most);
    let threshold = threshold.unwrap_or_else(|| between(&differences));
    let lines = ContourBuilder::new(columns, rows, true).lines(&differences, &[threshold]);
    let lines = lines.map_err(at("the picture cannot be traced"))?;
    let rings = lines.iter().flat_map(|line| &line.geometry().0);
    let rings = rings.map(|ring| ring.0.iter().map(|at| [at.x, at.y]).collect()).collect();
    let (rings, is_line) = shapes(rings);
    ensure!(
        rings.first().is_some_and(|ring| roundness(ring) > OPEN),
        "the picture is a line with two ends: close it, so that it encloses the shape"
    );
    let mut path = String::new();
    for ring in rings {
        for (i, [x, y]) in ring.iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{command}{x:.2} {y:.2}");
        }
        path.push('Z');
    }
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {columns} {rows}'>\
         <path fill-rule='evenodd' d='{path}'/></svg>\n"
    );
    Ok(Traced { svg, threshold, is_line })
}

/// The pixels of a picture, as it is to be seen, reduced to [`PIXELS`].
fn upright(picture: &[u8]) -> ImageResult<RgbaImage> {
    let reader = ImageReader::new(Cursor::new(picture)).with_guessed_format()?;
    let mut decoder = reader.into_decoder()?;
    let orientation = decoder.orientation()?;
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    let longer = picture.width().max(picture.height());
    if longer > PIXELS {
        picture = picture.thumbnail(PIXELS, PIXELS);
    }
    Ok(picture.blur(BLUR * f32::min(1.0, longer as f32 / BLURRED)).into_rgba8())
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

/// The middle between the means of the two classes of numbers from 0 to 1 with the largest variance
/// between them.
fn between(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (count, total) = (sorted.len() as f64, sorted.iter().sum::<f64>());
    let (mut below, mut sum) = (0.0, 0.0);
    let mut found = (0.0, 0.5);
    for number in sorted {
        (below, sum) = (below + 1.0, sum + number);
        let means = [sum / below, (total - sum) / f64::max(count - below, 1.0)];
        let variance = below * (count - below) * (means[1] - means[0]).powi(2);
        if variance > found.0 {
            found = (variance, 0.5 * (means[0] + means[1]));
        }
    }
    found.1
}

/// The outlines of the shapes in rings, the largest first, and whether one of them is a drawn line. The
/// outer side of a line is counter-clockwise, its inner side clockwise, as everything that encloses
/// ground.
fn shapes(mut rings: Vec<Ring>) -> (Vec<Ring>, bool) {
    let area = |ring: &Ring| polygon::area(ring);
    rings.sort_by(|one, other| area(other).abs().total_cmp(&area(one).abs()));
    let largest = rings.first().map_or(0.0, |ring| area(ring).abs());
    rings.retain(|ring| area(ring).abs() > SPECK * largest);
    let around: Vec<Vec<usize>> = (0..rings.len())
        .map(|i| (0..i).filter(|outer| polygon::contains(&rings[*outer], rings[i][0])).collect())
        .collect();
    let is_line = |outermost: usize| {
        let members =
            (0..rings.len()).filter(|i| *i == outermost || around[*i].contains(&outermost));
        members.map(|i| area(&rings[i])).sum::<f64>().abs() < LINE * area(&rings[outermost]).abs()
    };
    let of_line: Vec<bool> =
        (0..rings.len()).map(|i| is_line(*around[i].first().unwrap_or(&i))).collect();
    // The outer side of a line has its inner side as the next ring in it.
    let is_outer = |i: usize| {
        let depth = around[i].len();
        let next = |ring: &Vec<usize>| ring.len() == depth + 1 && ring.contains(&i);
        depth.is_multiple_of(2) && around.iter().any(next)
    };
    let kept: Vec<bool> = (0..rings.len()).map(|i| !of_line[i] || is_outer(i)).collect();
    let mut kept = kept.into_iter();
    rings.retain(|_| kept.next().unwrap_or_default());
    (rings, of_line.contains(&true))
}

/// The area in a ring over the area in a circle of its length.
fn roundness(ring: &Ring) -> f64 {
    let length: f64 = polygon::edges(ring).map(|(p, q)| polygon::distance(p, q)).sum();
    4.0 * PI * polygon::area(ring).abs() / (length * length)
}
