//! Animated pictures: an APNG, which browsers play and other programs show as its first frame.
//!
//! All frames have one palette, so that the file is small: at most 256 colours, those with the most
//! pixels first, each at a least distance from those before it. A pixel of another colour, at an
//! edge, has the nearest of them.

use crate::{output_file, picture::rasterise};
use anyhow::{Context, Result};
use std::{collections::HashMap, path::Path};

/// Duration of the whole animation (ms) and of its last frame, and the limits of the other frames.
const TOTAL_MS: u16 = 3000;
const LAST_MS: u16 = 1500;
const FRAME_MS: [u16; 2] = [60, 500];

/// Square of the least distance between two colours of the palette.
const APART: u32 = 120;

type Colour = [u8; 3];

/// Writes SVG pictures of the same size as the frames of an animation that repeats, `width` pixels
/// wide.
pub(crate) fn save(frames: &[String], path: &Path, width: u32) -> Result<()> {
    let pixels = frames.iter().map(|svg| {
        let frame = rasterise(svg, width)?;
        let colours = frame.pixels().iter().map(|it| [it.red(), it.green(), it.blue()]);
        Ok((frame.height(), colours.collect()))
    });
    let pixels: Vec<(u32, Vec<Colour>)> = pixels.collect::<Result<_>>()?;
    let (height, _) = *pixels.first().context("an animation without frames")?;
    let frames: Vec<Vec<Colour>> = pixels.into_iter().map(|(_, frame)| frame).collect();
    let bytes = encode(&frames, [width, height])?;
    output_file::write(path, bytes)
}

fn encode(
    frames: &[Vec<Colour>],
    [width, height]: [u32; 2],
) -> Result<Vec<u8>, png::EncodingError> {
    let (palette, place) = palette(frames);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.concat());
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_animated(frames.len() as u32, 0)?;
    let mut writer = encoder.write_header()?;
    let each = (TOTAL_MS / frames.len() as u16).clamp(FRAME_MS[0], FRAME_MS[1]);
    for (i, frame) in frames.iter().enumerate() {
        let last = i + 1 == frames.len();
        writer.set_frame_delay(if last { LAST_MS } else { each }, 1000)?;
        let runs = frame.chunk_by(|one, other| one == other);
        let indices = runs.flat_map(|run| std::iter::repeat_n(place[&run[0]], run.len()));
        let indices: Vec<u8> = indices.collect();
        writer.write_image_data(&indices)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// The most frequent colours, and the place of every colour, or of the nearest one, among them.
fn palette(frames: &[Vec<Colour>]) -> (Vec<Colour>, HashMap<Colour, u8>) {
    let mut counts: HashMap<Colour, usize> = HashMap::new();
    let runs = |frame| <[Colour]>::chunk_by(frame, |one, other| one == other);
    for run in frames.iter().flat_map(|frame| runs(frame)) {
        *counts.entry(run[0]).or_default() += run.len();
    }
    let mut colours: Vec<Colour> = counts.keys().copied().collect();
    // Equally frequent colours in a fixed order, so that the same frames give the same file.
    colours.sort_by_key(|colour| (std::cmp::Reverse(counts[colour]), *colour));
    let mut palette: Vec<Colour> = Vec::new();
    for colour in &colours {
        if palette.len() == 256 {
            break;
        }
        if palette.iter().all(|other| distance(colour, other) >= APART) {
            palette.push(*colour);
        }
    }
    let nearest = |colour: &Colour| {
        let places = palette.iter().enumerate();
        let nearest = places.min_by_key(|(_, other)| distance(colour, other));
        nearest.map_or(0, |(place, _)| place as u8)
    };
    let place = colours.iter().map(|colour| (*colour, nearest(colour))).collect();
    (palette, place)
}

/// Square of the distance of two colours.
fn distance(one: &Colour, other: &Colour) -> u32 {
    let components = std::iter::zip(one, other);
    components.map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> (png::Info<'static>, Vec<Vec<u8>>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let info = reader.info().clone();
        let count = info.animation_control.unwrap().num_frames;
        let frames = (0..count).map(|_| {
            let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut buffer).unwrap();
            buffer
        });
        let frames = frames.collect();
        (info, frames)
    }

    #[test]
    fn every_frame_is_read_back_and_the_animation_repeats() {
        let frame =
            |shift: u8| -> Vec<Colour> { (0..12).map(|i| [i * 20, shift, 255 - i]).collect() };
        let frames: Vec<_> = [0, 60, 120].map(frame).to_vec();
        let (info, found) = decoded(&encode(&frames, [4, 3]).unwrap());
        assert_eq!((info.width, info.height), (4, 3));
        assert_eq!(info.animation_control.unwrap().num_plays, 0);
        let expected: Vec<Vec<u8>> = frames.iter().map(|frame| frame.concat()).collect();
        assert_eq!(found, expected);
    }

    /// A frequent grey, a rare colour next to it, a rare colour far from it.
    #[test]
    fn the_palette_keeps_rare_colours_that_no_frequent_one_is_near_to() {
        let frame = [vec![[90; 3]; 50], vec![[90, 95, 92], [253, 231, 37]]].concat();
        let (palette, place) = palette(&[frame]);
        assert_eq!(palette, [[90; 3], [253, 231, 37]]);
        assert_eq!((place[&[90, 95, 92]], place[&[253, 231, 37]]), (0, 1));
        // Of more than 256 distant colours the most frequent are kept, and each of them is its own
        // nearest.
        let grid = |i: usize| [i % 7, i / 7 % 7, i / 49].map(|c| 40 * c as u8);
        let many: Vec<Colour> = (0..343).flat_map(|i| vec![grid(i); 400 - i]).collect();
        let (palette, place) = super::palette(&[many]);
        assert_eq!(palette, (0..256).map(grid).collect::<Vec<_>>());
        for (i, colour) in palette.iter().enumerate() {
            assert_eq!(usize::from(place[colour]), i);
        }
    }

    #[test]
    fn frames_of_a_broken_picture_are_an_error() {
        let folder = std::env::temp_dir();
        assert!(save(&["<svg".to_owned()], &folder.join("none.png"), 100).is_err());
        assert!(save(&[], &folder.join("none.png"), 100).is_err());
    }
}
