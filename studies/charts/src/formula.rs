//! Labels with formulas such as `ξ_v` → text with subscripts.

use crate::glyphs;

/// Start and end of a subscript in a label under way. They are characters of Unicode's private use area.
const SUBSCRIPT: [char; 2] = ['\u{E000}', '\u{E001}'];

/// Size of a subscript and its depth below the line. Both are relative to the font size of the formula.
const SIZE: f64 = 0.72;
const DEPTH: f64 = 0.22;

/// Marks the subscripts of a label, which [`typeset`] sets after drawing.
///
/// Letters and digits after `_` are a subscript; `R0` is R with the subscript 0.
pub fn formula(label: &str) -> String {
    let [begin, end] = SUBSCRIPT;
    let mut marked = String::new();
    let label = label.replace("R0", "R_0");
    let mut parts = label.split('_');
    marked.extend(parts.next());
    for part in parts {
        let length = part.find(|c: char| !c.is_alphanumeric()).unwrap_or(part.len());
        let (subscript, rest) = part.split_at(length);
        marked.push(begin);
        marked.push_str(subscript);
        marked.push(end);
        marked.push_str(rest);
    }
    marked
}

/// Shrinks and lowers the subscripts that [`formula`] has marked in an SVG drawing.
pub fn typeset(svg: &str) -> String {
    let [begin, end] = SUBSCRIPT;
    let lower = format!("<tspan dy=\"{:.4}em\" font-size=\"{SIZE}em\">", DEPTH / SIZE);
    let mut set = String::with_capacity(svg.len());
    // The text after a subscript returns to the base line.
    for (i, part) in svg.split(begin).enumerate() {
        match part.split_once(end) {
            Some((subscript, rest)) if i > 0 => {
                let (rest, further) = rest.split_at(rest.find(['<', '\n']).unwrap_or(rest.len()));
                set.push_str(&format!("{lower}{subscript}</tspan>"));
                if !rest.is_empty() {
                    set.push_str(&format!("<tspan dy=\"-{DEPTH}em\">{rest}</tspan>"));
                }
                set.push_str(further);
            }
            _ => set.push_str(part),
        }
    }
    set
}

/// Returns the width of a label.
pub fn width(label: &str, size: f64) -> f64 {
    marked_width(&formula(label), size)
}

/// Returns the width of a text whose subscripts [`formula`] has marked.
pub fn marked_width(marked: &str, size: f64) -> f64 {
    let parts = marked.split_inclusive(SUBSCRIPT).map(|part| match part.strip_suffix(SUBSCRIPT[1]) {
        Some(subscript) => glyphs::width(subscript, SIZE * size),
        None => glyphs::width(part.trim_end_matches(SUBSCRIPT[0]), size),
    });
    parts.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glyphs::tests::bounds_of as bounds;

    /// Writes a label in a text element, like plotters.
    fn drawn(label: &str) -> String {
        let text = formula(label);
        typeset(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"2000\" height=\"200\">\n<text x=\"20\" y=\"100\" \
             font-family=\"DejaVu Sans\" font-size=\"40\">\n{text}\n</text>\n</svg>"
        ))
    }

    /// Subscripts are small and lowered; the text after them is on the base line again.
    #[test]
    fn subscripts_stand_below_the_line() {
        let svg = drawn("ξ_v = 0.1, ω_p/p, R0");
        assert!(!svg.contains('_') && !svg.contains(SUBSCRIPT[0]) && !svg.contains(SUBSCRIPT[1]), "{svg}");
        assert_eq!(svg.matches("</tspan>").count(), 5, "{svg}");
        let [plain, lowered, back, flat] = ["a0", "a_0", "a_00 0", "a 0"].map(|label| bounds(&drawn(label)));
        assert!(lowered[3] > plain[3] + 5.0 && lowered[2] < plain[2], "{plain:?} {lowered:?}");
        assert!((back[1] - flat[1]).abs() < 0.1, "{back:?} {flat:?}");
    }

    /// A file name with underscores has no subscripts unless it is marked as a formula.
    #[test]
    fn unmarked_labels_keep_their_underscores() {
        let svg = "<text>np01002p_4225a_a.smc</text>";
        assert_eq!(typeset(svg), svg);
    }

    #[test]
    fn the_dot_of_a_rate_stands_over_its_letter() {
        let [with, without] = ["θ̇/(α p)", "θ/(α p)"].map(|label| bounds(&drawn(label)));
        assert!((with[2] - without[2]).abs() < 0.1 && with[1] < without[1] - 1.0, "{with:?} {without:?}");
    }

    /// Outlines fill the width of their label except for the side bearings of the first and the last letter.
    #[test]
    fn widths_are_those_of_the_outlines() {
        for label in
            ["η = 20", "ξ_v = 0.1, ε = 0.4", "complete separation, where the analysis ends", "M g R0 (1 − cos α)"]
        {
            let [left, _, right, _] = bounds(&drawn(label));
            let (drawn, width) = (f64::from(right - left), width(label, 40.0));
            assert!(drawn < width && width < drawn + 0.2 * 40.0, "{label}: {width}, drawn {drawn}");
        }
        assert!(width("a_b", 40.0) < width("ab", 40.0));
    }
}
