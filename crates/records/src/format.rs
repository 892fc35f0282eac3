//! Formats of accelerogram files and their names.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

/// Format of an accelerogram file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// PEER AT2, with or without header; values in reading order.
    Peer,
    /// SMC of the U.S. Geological Survey.
    Smc,
    /// Delimited or blank-separated columns: acceleration alone or with time.
    Columns,
    /// COSMOS volumes 1 and 2.
    Cosmos,
    /// CSMIP (DMG, CESMD) volumes 1 and 2.
    Csmip,
    /// ASC of the European ESM and ITACA databases, and DYNA 1.2 of the Turkish AFAD.
    Esm,
    /// K-NET and KiK-net of Japan, in ASCII and CSV.
    Knet,
    /// GeoNet of New Zealand, volumes 1 and 2.
    Geonet,
    /// Text of the Turkish strong-motion network before DYNA.
    Nsmn,
    /// Standard file of UNAM and RACM, Mexico.
    Unam,
    /// RENADIC of the Universidad de Chile.
    Renadic,
    /// BHRC of Iran, volume 1.
    Bhrc,
    /// University of Southern California, volumes 1 and 2.
    Usc,
    /// CSV of the Japan Meteorological Agency.
    Jma,
    /// Free-field text of the Central Weather Administration of Taiwan, before the Central Weather Bureau.
    Cwb,
    /// CSMNC of China.
    Csmnc,
    /// European Strong-Motion Database and ISESD (".cor").
    Esd,
    /// Text, count and time step, then the values: eqsig, DEEPSOIL, RspMatch, SIV, EMOD3D.
    Npts,
    /// Columns of fixed width in a layout that the caller describes.
    Fixed,
}

impl Format {
    /// Names that [`Format::from_str`] reads, for messages.
    pub const NAMES: &'static str = "peer, smc, columns, cosmos, csmip, esm, knet, geonet, nsmn, unam, renadic, bhrc, usc, jma, cwb, csmnc, esd, npts, fixed";

    /// Returns whether the files of this format may have several channels.
    pub(super) fn has_channels(self) -> bool {
        match self {
            Format::Peer | Format::Smc | Format::Columns | Format::Esm | Format::Usc | Format::Fixed => false,
            Format::Csmnc | Format::Esd | Format::Npts => false,
            Format::Cosmos | Format::Csmip | Format::Knet | Format::Geonet | Format::Nsmn => true,
            Format::Unam | Format::Renadic | Format::Bhrc | Format::Jma | Format::Cwb => true,
        }
    }
}

/// All formats with their titles and the words that [`Format::from_str`] reads.
pub(super) const FORMATS: [(Format, &str, &[&str]); 19] = [
    (Format::Peer, "PEER AT2", &["peer", "at2"]),
    (Format::Smc, "SMC", &["smc"]),
    (Format::Columns, "columns", &["columns", "csv", "txt"]),
    (Format::Cosmos, "COSMOS", &["cosmos"]),
    (Format::Csmip, "CSMIP", &["csmip", "dmg", "cesmd"]),
    (Format::Esm, "ESM ASC", &["esm", "asc", "itaca", "dyna", "afad", "tadas"]),
    (Format::Knet, "K-NET", &["knet", "k-net", "kiknet", "kik-net"]),
    (Format::Geonet, "GeoNet", &["geonet"]),
    (Format::Nsmn, "NSMN", &["nsmn"]),
    (Format::Unam, "UNAM", &["unam", "racm"]),
    (Format::Renadic, "RENADIC", &["renadic"]),
    (Format::Bhrc, "BHRC", &["bhrc"]),
    (Format::Usc, "USC", &["usc"]),
    (Format::Jma, "JMA", &["jma"]),
    (Format::Cwb, "CWB", &["cwb", "cwa"]),
    (Format::Csmnc, "CSMNC", &["csmnc"]),
    (Format::Esd, "ESD", &["esd", "isesd"]),
    (Format::Npts, "NPTS DT", &["npts", "eqsig", "deepsoil", "rspmatch", "emod3d"]),
    (Format::Fixed, "fixed width", &["fixed"]),
];

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(FORMATS.iter().find(|(format, ..)| format == self).map_or("", |(_, title, _)| title))
    }
}

/// A word that names no [`Format`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found format {0:?}, expected one of {list}", list = Format::NAMES)]
pub struct UnknownFormat(pub String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<Format, UnknownFormat> {
        let named = FORMATS.iter().find(|(.., words)| words.iter().any(|word| text.eq_ignore_ascii_case(word)));
        named.map(|(format, ..)| *format).ok_or_else(|| UnknownFormat(text.to_owned()))
    }
}
