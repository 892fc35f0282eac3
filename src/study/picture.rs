//! Drawings as SVG → files as SVG or PNG, the same on every machine.

use std::path::Path;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::study::letters;

/// A picture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// Neither SVG nor PNG.
    #[error("{path}: a picture is written as .svg or .png, not as {found}; {advice}")]
    Ending {
        /// The file.
        path: String,
        /// Its ending.
        found: String,
        /// What to do instead.
        advice: &'static str,
    },
    /// The drawing failed.
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
}

/// Kinds of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Scalable vector graphics.
    Svg,
    /// Pixels, one for each unit of the drawing.
    Png,
}

impl PictureFormat {
    /// The format that a file's ending asks for.
    pub fn of(path: &Path) -> Result<PictureFormat, PictureError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(PictureFormat::Svg),
            Some("png") => Ok(PictureFormat::Png),
            other => Err(PictureError::Ending {
                path: path.display().to_string(),
                found: other.map_or("a file without ending".into(), |ending| format!(".{ending}")),
                advice: match other {
                    Some("pdf" | "eps" | "ps" | "emf") => "write .svg and convert it, as with rsvg-convert or Inkscape",
                    Some("csv" | "txt" | "tsv" | "dat") => "the table is written with --csv",
                    Some(_) => "write .png, or .svg for a drawing that scales",
                    None => "--plot-format says which",
                },
            }),
        }
    }

    /// The bytes of the file that holds this drawing.
    pub fn encode(self, svg: &str) -> Result<Vec<u8>, PictureError> {
        match self {
            PictureFormat::Svg => Ok(svg.as_bytes().to_vec()),
            PictureFormat::Png => png(svg),
        }
    }
}

fn png(svg: &str) -> Result<Vec<u8>, PictureError> {
    let failed = |error: &dyn std::fmt::Display| PictureError::Drawing(error.to_string());
    let outlined = letters::outlined(svg).map_err(|e| failed(&e))?;
    let tree = Tree::from_str(&outlined, &Options::default()).map_err(|e| failed(&e))?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or_else(|| failed(&"it is too large for memory"))?;
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| failed(&e))
}
