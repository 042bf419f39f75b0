//! SVG to PNG, with letters that come along: machines without fonts draw the same.

use super::FigureError;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// Pixels of the picture for one of the drawing: enough for print at the width of a column.
const ENLARGEMENT: f32 = 2.0;

/// An SVG document as PNG, on white, twice as many pixels as the SVG has units.
///
/// # Errors
/// [`FigureError`] if the SVG cannot be read or the picture is too large.
pub fn png(svg: &str) -> Result<Vec<u8>, FigureError> {
    let failed = |what: &str| FigureError(what.to_owned());
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
    let tree =
        usvg::Tree::from_str(svg, &options).map_err(|error| FigureError(error.to_string()))?;
    let size = tree.size().to_int_size().scale_by(ENLARGEMENT);
    let size = size.ok_or_else(|| failed("the picture has no size"))?;
    let mut picture = tiny_skia::Pixmap::new(size.width(), size.height())
        .ok_or_else(|| failed("the picture is too large"))?;
    picture.fill(tiny_skia::Color::WHITE);
    let enlarge = tiny_skia::Transform::from_scale(ENLARGEMENT, ENLARGEMENT);
    resvg::render(&tree, enlarge, &mut picture.as_mut());
    draw_pictures(tree.root(), enlarge, &mut picture)?;
    picture.encode_png().map_err(|error| FigureError(error.to_string()))
}

/// Draws the PNG pictures of a group over the rest: resvg draws them with decoders of more formats alone.
fn draw_pictures(
    group: &usvg::Group,
    enlarge: tiny_skia::Transform,
    onto: &mut tiny_skia::Pixmap,
) -> Result<(), FigureError> {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => draw_pictures(group, enlarge, onto)?,
            usvg::Node::Image(image) => {
                let usvg::ImageKind::PNG(bytes) = image.kind() else { continue };
                let pixels = tiny_skia::Pixmap::decode_png(bytes)
                    .map_err(|error| FigureError(error.to_string()))?;
                let place = enlarge.pre_concat(image.abs_transform());
                let paint = tiny_skia::PixmapPaint::default();
                onto.draw_pixmap(0, 0, pixels.as_ref(), &paint, place, None);
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(body: &str) -> usize {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"40\">{body}</svg>"
        );
        let picture = tiny_skia::Pixmap::decode_png(&png(&svg).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (400, 80));
        picture.pixels().iter().filter(|pixel| pixel.red() < 128).count()
    }

    #[test]
    fn letters_are_drawn_without_fonts_of_the_machine() {
        assert_eq!(dark_pixels(""), 0);
        let text = |text: &str| {
            dark_pixels(&format!("<text x=\"5\" y=\"25\" font-family=\"sans-serif\">{text}</text>"))
        };
        assert!(text("µ 10⁻³") > 100);
        assert!(text("friction coefficient") > text("friction"));
    }

    #[test]
    fn pictures_are_drawn() {
        let mut black = tiny_skia::Pixmap::new(1, 1).unwrap();
        black.fill(tiny_skia::Color::BLACK);
        let bytes = base64::Engine::encode(
            &base64::engine::general_purpose::STANDARD,
            black.encode_png().unwrap(),
        );
        let picture = format!(
            "<image x=\"10\" y=\"5\" width=\"20\" height=\"10\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{bytes}\"/>"
        );
        // 40 by 20 pixels of the enlarged drawing.
        assert_eq!(dark_pixels(&picture), 800);
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        assert!(png("<svg").is_err());
    }
}
