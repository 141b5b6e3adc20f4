//! An animated PNG with at most 256 colours. Each frame contains only the changes since the
//! previous frame.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufWriter, Cursor};
use std::path::Path;
use std::time::Duration;

use anyhow::ensure;
use png::{BitDepth, BlendOp, ColorType, Compression, Decoder, Encoder, Filter, Transformations};

/// Red, green and blue.
type Colour = [u8; 3];

/// A picture, and the time from which it is shown.
pub(crate) struct Frame {
    pub(crate) at: Duration,
    size: (u32, u32),
    pixels: Vec<Colour>,
}

impl Frame {
    /// Reads a PNG.
    pub(crate) fn of(picture: &[u8], at: Duration) -> anyhow::Result<Self> {
        let mut decoder = Decoder::new(Cursor::new(picture));
        decoder.set_transformations(Transformations::normalize_to_color8());
        let mut reader = decoder.read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().unwrap_or_default()];
        let info = reader.next_frame(&mut bytes)?;
        let samples = info.color_type.samples();
        ensure!(samples >= 3, "{:?} are no colours", info.color_type);
        let pixels = bytes.chunks_exact(samples);
        Ok(Self {
            at,
            size: (info.width, info.height),
            pixels: pixels.map(|it| [it[0], it[1], it[2]]).collect(),
        })
    }
}

/// Writes frames as an animation that repeats indefinitely. The last frame ends at `end`.
pub(crate) fn write(file: &Path, frames: &[Frame], end: Duration) -> anyhow::Result<()> {
    let (width, height) = frames[0].size;
    let (palette, places) = colours(frames);
    let indexed = |frame: &Frame| -> Vec<u8> { frame.pixels.iter().map(|it| places[it]).collect() };
    // A frame without changes prolongs the previous frame.
    let mut shown: Vec<(Duration, Vec<u8>)> = Vec::new();
    for frame in frames {
        let pixels = indexed(frame);
        if shown.last().is_none_or(|(_, last)| *last != pixels) {
            shown.push((frame.at, pixels));
        }
    }
    let mut encoder = Encoder::new(BufWriter::new(File::create(file)?), width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.concat());
    // The last palette entry means unchanged.
    let mut seen = vec![255; palette.len()];
    seen[usize::from(KEPT)] = 0;
    encoder.set_trns(seen);
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_animated(u32::try_from(shown.len())?, 0)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    for (i, (at, pixels)) in shown.iter().enumerate() {
        let next = shown.get(i + 1).map_or(end, |(at, _)| *at);
        writer.set_frame_delay(u16::try_from((next - *at).as_millis())?, 1000)?;
        if i == 0 {
            writer.write_image_data(pixels)?;
            continue;
        }
        let (area, changed) = changes(&shown[i - 1].1, pixels, width as usize);
        writer.reset_frame_position()?;
        writer.set_frame_dimension(area.width as u32, area.height as u32)?;
        writer.set_frame_position(area.left as u32, area.top as u32)?;
        writer.write_image_data(&changed)?;
    }
    Ok(writer.finish()?)
}

struct Area {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// Returns the smallest area that contains all changes of a picture, and its contents.
fn changes(before: &[u8], after: &[u8], width: usize) -> (Area, Vec<u8>) {
    let differing = || (0..after.len()).filter(|i| before[*i] != after[*i]);
    let (mut left, mut right) = (width, 0);
    for column in differing().map(|i| i % width) {
        left = left.min(column);
        right = right.max(column);
    }
    let top = differing().next().unwrap_or(0) / width;
    let bottom = differing().next_back().unwrap_or(0) / width;
    let mut changed = Vec::new();
    for row in top..=bottom {
        for i in row * width + left..=row * width + right {
            let same = before[i] == after[i];
            changed.push(if same { KEPT } else { after[i] });
        }
    }
    let area = Area {
        left,
        top,
        width: right + 1 - left,
        height: bottom + 1 - top,
    };
    (area, changed)
}

/// Returns a palette, and the palette index of each colour. A colour of many pixels is closer to
/// its palette entry than a colour of few pixels.
fn colours(frames: &[Frame]) -> (Vec<Colour>, HashMap<Colour, u8>) {
    let mut counts: HashMap<Colour, u32> = HashMap::new();
    for pixel in frames.iter().flat_map(|frame| &frame.pixels) {
        *counts.entry(*pixel).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_unstable_by_key(|&(colour, count)| (std::cmp::Reverse(count), colour));
    let mut palette = Vec::new();
    // Doubles the allowed error until the colours are few enough.
    let mut error = 32.0;
    loop {
        palette.clear();
        for (colour, count) in &counts {
            let weight = f64::from(*count).sqrt();
            let far = |it: &Colour| f64::from(apart(it, colour)) * weight > error;
            if palette.iter().all(far) {
                palette.push(*colour);
            }
            if palette.len() > usize::from(KEPT) {
                break;
            }
        }
        if palette.len() <= usize::from(KEPT) {
            break;
        }
        error *= 1.2;
    }
    let nearest = |colour: &Colour| {
        let places = 0..palette.len();
        let best = places.min_by_key(|i| apart(&palette[*i], colour));
        best.unwrap_or(0) as u8
    };
    let places = counts.iter().map(|(it, _)| (*it, nearest(it))).collect();
    palette.resize(usize::from(KEPT) + 1, [0; 3]);
    (palette, places)
}

/// Returns the squared distance of two colours.
fn apart(a: &Colour, b: &Colour) -> u32 {
    let off = |i: usize| u32::from(a[i].abs_diff(b[i])).pow(2);
    off(0) + off(1) + off(2)
}

/// Palette index that stands for an unchanged pixel.
const KEPT: u8 = 255;
