//! Labels → their widths, and their outlines in an SVG drawing, independent of installed fonts.
//!
//! Labels are single lines of Latin and Greek letters, signs and subscripts, set by the advances and the kerning of the font;
//! a combining mark stands over the letter before it.

use std::fmt::Write as _;
use std::sync::LazyLock;

use roxmltree::{Document, Node};
use ttf_parser::{Face, GlyphId, OutlineBuilder, Rect};

/// The font of all pictures, embedded in the program (studies/charts/assets/LICENSE_DEJAVU).
///
/// It holds the Latin, Greek and Cyrillic letters, punctuation and signs of DejaVu Sans 2.35: fonttools' `pyftsubset` with
/// `--unicodes=U+0-24F,U+2B0-3FF,U+400-45F,U+1E00-1EFF,U+2000-22FF,U+2500-25FF --legacy-kern --layout-features= --no-hinting`.
static FONT: LazyLock<Face<'static>> = LazyLock::new(|| {
    let font = Face::parse(include_bytes!("../assets/DejaVuSans.ttf"), 0);
    font.expect("the embedded font is valid, as tests show")
});

/// Name of the font.
pub const FONT_FAMILY: &str = "DejaVu Sans";

/// Space between a letter and a mark over it, relative to the font size.
const UNDER_MARK: f64 = 0.05;

/// Returns the width of a text of this font size, in the same unit.
pub fn width(text: &str, size: f64) -> f64 {
    let mut line = Line::default();
    line.append(text, size);
    line.x
}

/// Replaces the text elements of a drawing by the outlines of their glyphs.
pub fn outlined(svg: &str) -> Result<String, roxmltree::Error> {
    let document = Document::parse(svg)?;
    let mut drawn = String::with_capacity(2 * svg.len());
    let mut after = 0;
    for text in document.descendants().filter(|node| node.has_tag_name((SVG, "text"))) {
        let span = text.range();
        drawn.push_str(&svg[after..span.start]);
        drawn.push_str(&outline(text));
        after = span.end;
    }
    drawn.push_str(&svg[after..]);
    Ok(drawn)
}

const SVG: &str = "http://www.w3.org/2000/svg";

/// Converts a text element to a path.
fn outline(text: Node) -> String {
    let number = |name: &str| text.attribute(name).and_then(|value| value.parse().ok()).unwrap_or(0.0);
    let size = number("font-size");
    let mut line = Line { y: number("y") + size * shift(text), ..Line::default() };
    let pieces: Vec<Node> = text.descendants().filter(Node::is_text).collect();
    for (i, piece) in pieces.iter().enumerate() {
        // plotters writes the content on a separate line.
        let mut content = piece.text().unwrap_or_default().replace('\n', "");
        if i == 0 {
            content = content.trim_start().into();
        }
        if i + 1 == pieces.len() {
            content = content.trim_end().into();
        }
        let span = piece.parent().filter(|parent| *parent != text);
        let size = size * span.and_then(|span| ems(span, "font-size")).unwrap_or(1.0);
        line.y += size * span.map_or(0.0, shift);
        line.append(&content, size);
    }
    let start = match text.attribute("text-anchor") {
        Some("end") => number("x") - line.x,
        Some("middle") => number("x") - line.x / 2.0,
        _ => number("x"),
    };
    let mut path = String::from("<path");
    for attribute in text.attributes().filter(|attribute| ["fill", "opacity"].contains(&attribute.name())) {
        let _ = write!(path, " {}=\"{}\"", attribute.name(), attribute.value());
    }
    let turned = text.attribute("transform").unwrap_or_default();
    let _ = write!(path, " transform=\"{turned} translate({start:.3} 0)\" d=\"{}\"/>", line.path);
    path
}

/// Returns the downward shift of an element, relative to its font size.
fn shift(element: Node) -> f64 {
    // An `ex` counts as half the font size.
    let in_ex = element.attribute("dy").and_then(|dy| dy.strip_suffix("ex")?.parse::<f64>().ok());
    in_ex.map(|dy| dy / 2.0).or_else(|| ems(element, "dy")).unwrap_or(0.0)
}

fn ems(element: Node, attribute: &str) -> Option<f64> {
    element.attribute(attribute)?.strip_suffix("em")?.parse().ok()
}

/// Glyphs along a line, with y downwards.
#[derive(Default)]
struct Line {
    /// Start of the next glyph.
    x: f64,
    y: f64,
    /// Outlines of the glyphs, as SVG path data.
    path: String,
}

/// A glyph on a line.
#[derive(Clone, Copy)]
struct Placed {
    glyph: GlyphId,
    bounds: Option<Rect>,
    x: f64,
}

impl Line {
    fn append(&mut self, text: &str, size: f64) {
        let scale = size / f64::from(FONT.units_per_em());
        let mut last: Option<Placed> = None;
        for character in text.chars() {
            // Glyph 0, an empty box, stands for characters that the font lacks.
            let glyph = FONT.glyph_index(character).unwrap_or_default();
            let bounds = FONT.glyph_bounding_box(glyph);
            let over = last.filter(|_| ('\u{300}'..='\u{36F}').contains(&character));
            if let (Some(mark), Some((under, x))) = (bounds, over.and_then(|last| Some((last.bounds?, last.x)))) {
                let middle = |bounds: Rect| f64::from(bounds.x_min + bounds.x_max) / 2.0;
                let lowest = f64::from(under.y_max) + UNDER_MARK * f64::from(FONT.units_per_em());
                let up = (lowest - f64::from(mark.y_min)).max(0.0);
                self.draw(glyph, x + scale * (middle(under) - middle(mark)), self.y - scale * up, scale);
                continue;
            }
            self.x += last.map_or(0.0, |last| scale * kerning(last.glyph, glyph));
            self.draw(glyph, self.x, self.y, scale);
            last = Some(Placed { glyph, bounds, x: self.x });
            self.x += scale * f64::from(FONT.glyph_hor_advance(glyph).unwrap_or(0));
        }
    }

    fn draw(&mut self, glyph: GlyphId, x: f64, y: f64, scale: f64) {
        FONT.outline_glyph(glyph, &mut Pen { path: &mut self.path, x, y, scale });
    }
}

/// Returns the kerning of two adjacent glyphs, in font units.
fn kerning(first: GlyphId, second: GlyphId) -> f64 {
    let tables = FONT.tables().kern.into_iter().flat_map(|kern| kern.subtables);
    let mut pairs = tables.filter(|table| table.horizontal && !table.has_cross_stream && !table.has_state_machine);
    pairs.find_map(|table| table.glyphs_kerning(first, second)).map_or(0.0, f64::from)
}

/// Writes outlines in font units, with y upwards, as SVG path data.
struct Pen<'p> {
    path: &'p mut String,
    x: f64,
    y: f64,
    scale: f64,
}

impl Pen<'_> {
    fn write(&mut self, command: char, points: &[(f32, f32)]) {
        self.path.push(command);
        for (x, y) in points {
            let (x, y) = (self.x + self.scale * f64::from(*x), self.y - self.scale * f64::from(*y));
            let _ = write!(self.path, "{x:.3} {y:.3} ");
        }
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.write('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.write('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.write('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.write('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.write('Z', &[]);
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use resvg::usvg::{Options, Tree};

    /// Returns left, top, right and bottom of a drawing's texts.
    pub fn bounds_of(svg: &str) -> [f32; 4] {
        let tree = Tree::from_str(&outlined(svg).unwrap(), &Options::default()).unwrap();
        let bounds = tree.root().abs_bounding_box();
        [bounds.left(), bounds.top(), bounds.right(), bounds.bottom()]
    }

    /// Returns left, top, right and bottom of a text element of size 40 at (500, 100).
    fn bounds(attributes: &str, content: &str) -> [f32; 4] {
        let svg = format!(
            "<svg xmlns=\"{SVG}\" width=\"1000\" height=\"200\"><text x=\"500\" y=\"100\" font-size=\"40\" \
             {attributes}>\n{content}\n</text></svg>"
        );
        bounds_of(&svg)
    }

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() < 0.01
    }

    #[test]
    fn texts_stand_where_their_anchor_says() {
        let width = width("Hl", 40.0) as f32;
        let [start, middle, end] = ["start", "middle", "end"].map(|name| format!("text-anchor=\"{name}\""));
        let at_start = bounds(&start, "Hl");
        assert!((500.0..505.0).contains(&at_start[0]) && close(at_start[3], 100.0), "{at_start:?}");
        assert!(close(at_start[0] - bounds(&middle, "Hl")[0], width / 2.0));
        assert!(close(at_start[2] - bounds(&end, "Hl")[2], width));
    }

    /// An `ex` is half the font size; an `em` of a span refers to the span's own size.
    #[test]
    fn texts_are_lowered_and_turned() {
        let flat = bounds("", "H");
        assert!(close(bounds("dy=\"0.5ex\"", "H")[3], 110.0) && close(bounds("dy=\"0.76em\"", "H")[3], 130.4));
        let lowered = bounds("", "<tspan dy=\"0.5em\" font-size=\"0.5em\">H</tspan>");
        assert!(close(lowered[3], 110.0) && close(lowered[3] - lowered[1], (flat[3] - flat[1]) / 2.0), "{lowered:?}");
        let turned = bounds("transform=\"rotate(270, 500, 100)\"", "H");
        assert!(close(turned[2], 500.0) && close(turned[3] - turned[1], flat[2] - flat[0]), "{turned:?}");
    }

    /// Entities count as characters, and kerning moves letters together.
    #[test]
    fn entities_and_kerning_are_respected() {
        assert!(close(bounds("", "&lt;")[2] - 500.0, bounds("", "=")[2] - 500.0));
        assert!(width("AV", 40.0) < width("A", 40.0) + width("V", 40.0) - 1.0);
        assert!(width("a b", 40.0) > width("ab", 40.0) + 10.0);
    }
}
