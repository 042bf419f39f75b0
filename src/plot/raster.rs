//! Pictures of maps and colour bars, as elements of an SVG that hold their PNG.

use super::FigureError;
use super::colours::{NOTHING, of_share};
use super::panel::{Axis, Map};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use resvg::tiny_skia;
use std::fmt::Write;
use std::ops::Range;

/// Colours of a colour bar.
const STEPS: u32 = 256;

/// A picture and its place in the units of the drawing.
pub(super) struct Picture {
    /// Left, top, width and height.
    pub place: [i32; 4],
    png: Vec<u8>,
}

impl Picture {
    /// The cells of a map; `range` is that of its colours, in coordinates.
    pub fn of_map(map: &Map, range: &Range<f64>, place: [i32; 4]) -> Result<Self, FigureError> {
        let [nx, ny] = map.cells;
        let rows = map.values.chunks_exact(nx.max(1)).rev();
        let pixels: Vec<[u8; 3]> =
            rows.flatten().map(|value| colour(*value, &map.colours, range)).collect();
        Ok(Self { place, png: png([nx as u32, ny as u32], &pixels)? })
    }

    /// A colour bar, the largest value on top.
    pub fn of_bar(place: [i32; 4]) -> Result<Self, FigureError> {
        let share = |k: u32| f64::from(k) / f64::from(STEPS - 1);
        let pixels: Vec<[u8; 3]> = (0..STEPS).rev().map(|k| of_share(share(k))).collect();
        Ok(Self { place, png: png([1, STEPS], &pixels)? })
    }

    /// The element of an SVG.
    pub fn element(&self) -> String {
        let [x, y, width, height] = self.place;
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
            STANDARD.encode(&self.png)
        );
        text
    }
}

fn colour(value: f64, axis: &Axis, range: &Range<f64>) -> [u8; 3] {
    match axis.coordinate(value) {
        Some(at) => of_share((at - range.start) / (range.end - range.start)),
        None => NOTHING,
    }
}

fn png([width, height]: [u32; 2], pixels: &[[u8; 3]]) -> Result<Vec<u8>, FigureError> {
    let size = tiny_skia::IntSize::from_wh(width, height);
    let bytes = pixels.iter().flat_map(|[r, g, b]| [*r, *g, *b, u8::MAX]).collect();
    let picture = size.and_then(|size| tiny_skia::Pixmap::from_vec(bytes, size));
    let picture =
        picture.ok_or_else(|| FigureError("a map has not as many values as cells".into()))?;
    picture.encode_png().map_err(|error| FigureError(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_is_at_the_bottom_and_no_value_is_grey() {
        let map = Map {
            cells: [2, 2],
            size: [1.0, 1.0],
            unit: "mm",
            values: vec![0.0, f64::NAN, 1.0, 0.5],
            colours: Axis::linear("p"),
            arrow: None,
            notes: vec![],
        };
        let picture = Picture::of_map(&map, &(0.0..1.0), [0, 0, 8, 8]).unwrap();
        let pixels = tiny_skia::Pixmap::decode_png(&picture.png).unwrap();
        let colours: Vec<[u8; 3]> = pixels
            .pixels()
            .iter()
            .map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
            .collect();
        assert_eq!(colours, [of_share(1.0), of_share(0.5), of_share(0.0), NOTHING]);
        assert!(Picture::of_map(&Map { values: vec![0.0], ..map }, &(0.0..1.0), [0; 4]).is_err());
    }
}
