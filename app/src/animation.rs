//! Animated pictures: an APNG, which browsers play and other programs show as its first frame.

use crate::{output_file, picture::rasterise};
use anyhow::{Context, Result};
use std::path::Path;

/// Duration of the whole animation (ms) and of its last frame, and the limits of the other frames.
const TOTAL_MS: u16 = 3000;
const LAST_MS: u16 = 1500;
const FRAME_MS: [u16; 2] = [60, 500];

/// Writes SVG pictures of the same size as the frames of an animation that repeats, `width` pixels
/// wide.
pub(crate) fn save(frames: &[String], path: &Path, width: u32) -> Result<()> {
    let pixels = frames.iter().map(|svg| {
        let frame = rasterise(svg, width)?;
        let colours = frame
            .pixels()
            .iter()
            .flat_map(|it| [it.red(), it.green(), it.blue()].map(|c| c & 0xf8 | c >> 5));
        Ok((frame.height(), colours.collect()))
    });
    let pixels: Vec<(u32, Vec<u8>)> = pixels.collect::<Result<_>>()?;
    let (height, _) = *pixels.first().context("an animation without frames")?;
    let frames: Vec<Vec<u8>> = pixels.into_iter().map(|(_, frame)| frame).collect();
    let bytes = encode(&frames, [width, height])?;
    output_file::write(path, bytes)
}

/// The file of frames of red, green and blue.
fn encode(frames: &[Vec<u8>], [width, height]: [u32; 2]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_animated(frames.len() as u32, 0)?;
    let mut writer = encoder.write_header()?;
    let each = (TOTAL_MS / frames.len() as u16).clamp(FRAME_MS[0], FRAME_MS[1]);
    for (i, frame) in frames.iter().enumerate() {
        let last = i + 1 == frames.len();
        writer.set_frame_delay(if last { LAST_MS } else { each }, 1000)?;
        writer.write_image_data(frame)?;
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> (png::Info<'static>, Vec<Vec<u8>>) {
        let decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        let mut reader = decoder.read_info().unwrap();
        let info = reader.info().clone();
        let count = info.animation_control.unwrap().num_frames;
        let frames = (0..count).map(|_| {
            let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut buffer).unwrap();
            buffer
        });
        (info, frames.collect())
    }

    #[test]
    fn every_frame_is_read_back_and_the_animation_repeats() {
        let frame = |shift: u8| (0..12).flat_map(|i| [i * 20, shift, 255 - i]).collect();
        let frames: [Vec<u8>; 3] = [0, 60, 120].map(frame);
        let (info, found) = decoded(&encode(&frames, [4, 3]).unwrap());
        assert_eq!((info.width, info.height), (4, 3));
        assert_eq!(info.animation_control.unwrap().num_plays, 0);
        assert_eq!(found, frames);
    }

    #[test]
    fn frames_of_a_broken_picture_are_an_error() {
        let none = std::env::temp_dir().join("none.png");
        let broken = [vec!["<svg".to_owned()], Vec::new()];
        assert!(broken.iter().all(|frames| save(frames, &none, 100).is_err()));
    }
}
