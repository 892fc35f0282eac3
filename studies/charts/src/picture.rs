//! SVG drawings → SVG or PNG files, the same on every machine.

use std::path::Path;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::glyphs;
use rocking_studies::spec::words::Words;

/// Error of a picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file name ends in neither `.svg` nor `.png`.
    #[error("{0}")]
    Extension(String),
    /// The drawing failed.
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
}

/// Format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Scalable vector graphics.
    Svg,
    /// Pixels.
    Png,
}

impl Words for PictureFormat {
    const WORDS: &'static [(&'static str, PictureFormat)] = &[("png", PictureFormat::Png), ("svg", PictureFormat::Svg)];
}

impl PictureFormat {
    /// Returns the format for the extension of a file name.
    ///
    /// # Errors
    /// [`PictureError::Extension`].
    pub fn of(path: &Path) -> Result<PictureFormat, PictureError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let advice = match extension.as_deref() {
            Some("svg") => return Ok(PictureFormat::Svg),
            Some("png") => return Ok(PictureFormat::Png),
            Some("pdf" | "eps" | "ps" | "emf") => "write .svg and convert it with rsvg-convert or Inkscape",
            Some("csv" | "txt" | "tsv" | "dat") => "use --csv for the table",
            Some(_) => "write .png, or .svg for a scalable drawing",
            None => "--plot-format chooses one for a name without extension",
        };
        let found = extension.map_or("no extension".into(), |extension| format!(".{extension}"));
        let path = path.display();
        Err(PictureError::Extension(format!("{path}: found {found}; expected a picture as .svg or .png; {advice}")))
    }

    /// Encodes a drawing.
    ///
    /// # Errors
    /// [`PictureError::Drawing`].
    pub fn encode(self, svg: &str) -> Result<Vec<u8>, PictureError> {
        match self {
            PictureFormat::Svg => Ok(svg.as_bytes().to_vec()),
            PictureFormat::Png => png(svg),
        }
    }
}

fn png(svg: &str) -> Result<Vec<u8>, PictureError> {
    let failed = |error: &dyn std::fmt::Display| PictureError::Drawing(error.to_string());
    let outlined = glyphs::outlined(svg).map_err(|e| failed(&e))?;
    let tree = Tree::from_str(&outlined, &Options::default()).map_err(|e| failed(&e))?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or_else(|| failed(&"too large for memory"))?;
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| failed(&e))
}
