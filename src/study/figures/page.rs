//! Number, caption and keys of a figure → a page, with room for its charts.

use crate::study::chart::{Area, Drawn, Sample, TEXT, WIDTH, drawing, keys, keys_height, text};
use crate::study::formula::{formula, width};
use crate::study::picture::PictureError;

/// Height of a line of the caption (pixels).
const LINE: u32 = 50;
/// Room at the left and right of the caption (pixels).
const MARGIN: u32 = 48;

/// Draws a page: number, caption and keys, and under them, in so many pixels, what `body` draws, which is given the whole
/// page and that part.
pub fn page(
    number: u8,
    caption: &str,
    samples: &[(Sample, String)],
    height: u32,
    body: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let lines = wrapped(&format!("Figure\u{A0}{number}. {caption}"), f64::from(WIDTH - 2 * MARGIN));
    let head = 60 + LINE * lines.len() as u32;
    drawing(head + keys_height(samples) + height, |root| {
        let (top, rest) = root.split_vertically(head);
        for (i, line) in lines.iter().enumerate() {
            let line = line.replace('\u{A0}', " ");
            top.draw_text(&formula(&line), &text(TEXT), (MARGIN as i32, 32 + (LINE * i as u32) as i32))?;
        }
        let (samples_area, rest) = rest.split_vertically(keys_height(samples));
        keys(&samples_area, samples)?;
        body(root, &rest)
    })
}

/// A caption in lines of at most this width (pixels). Formulas, held together by no-break spaces, stay whole.
fn wrapped(caption: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in caption.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), TEXT) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::figures::parameters::{NUMBERS, caption};

    /// Every caption fits its lines, and no line ends inside a formula.
    #[test]
    fn captions_break_between_words() {
        for caption in NUMBERS.map(|number| caption(number).unwrap()) {
            let lines = wrapped(&caption, 1200.0);
            assert!(lines.len() > 1 && lines.iter().all(|line| width(line, TEXT) <= 1200.0), "{lines:?}");
            for line in &lines[..lines.len() - 1] {
                let end = line.trim_end_matches([',', '.', ';', ')']).chars().last().unwrap();
                assert!(!"=+−·".contains(end), "{lines:?}");
            }
            for line in &lines[1..] {
                assert!(!line.starts_with(['=', '+', '−', '·']), "{lines:?}");
            }
        }
    }
}
