//! Number, caption and keys of a figure → a page, with room for its charts.

use crate::study::chart::{Area, Drawn, Sample, headed, keys, keys_height};
use crate::study::formula::formula;
use crate::study::picture::PictureError;

/// Draws a page: number, caption and keys, and under them a part of this height. `body` gets the whole page and that part.
pub fn page(
    number: u8,
    caption: &str,
    samples: &[(Sample, String)],
    height: u32,
    body: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let caption = formula(&format!("Figure\u{A0}{number}. {caption}"));
    headed(&[String::new(), caption], keys_height(samples) + height, |root, rest| {
        let (samples_area, rest) = rest.split_vertically(keys_height(samples));
        keys(&samples_area, samples)?;
        body(root, &rest)
    })
}

#[cfg(test)]
mod tests {
    use crate::study::chart::{TEXT, wrapped};
    use crate::study::figures::parameters::{NUMBERS, caption};
    use crate::study::formula::width;

    /// Every caption fits its lines, and no line ends inside a formula.
    #[test]
    fn captions_break_between_words() {
        for caption in NUMBERS.map(|number| caption(number).unwrap()) {
            let lines = wrapped(&caption, TEXT, 12_000.0);
            assert!(lines.len() > 1 && lines.iter().all(|line| width(line, TEXT) <= 12_000.0), "{lines:?}");
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
