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
    /// Columns of fixed width in a layout that the caller describes.
    Fixed,
}

impl Format {
    pub(super) const ALL: [Format; 16] = [
        Format::Peer,
        Format::Smc,
        Format::Columns,
        Format::Cosmos,
        Format::Csmip,
        Format::Esm,
        Format::Knet,
        Format::Geonet,
        Format::Nsmn,
        Format::Unam,
        Format::Renadic,
        Format::Bhrc,
        Format::Usc,
        Format::Jma,
        Format::Cwb,
        Format::Fixed,
    ];

    /// Formats whose files may have several channels.
    pub(super) const WITH_CHANNELS: [Format; 10] = [
        Format::Cosmos,
        Format::Csmip,
        Format::Knet,
        Format::Geonet,
        Format::Nsmn,
        Format::Unam,
        Format::Renadic,
        Format::Bhrc,
        Format::Jma,
        Format::Cwb,
    ];

    /// Names that [`Format::from_str`] reads, for messages.
    pub const NAMES: &'static str =
        "peer, smc, columns, cosmos, csmip, esm, knet, geonet, nsmn, unam, renadic, bhrc, usc, jma, cwb, fixed";
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Format::Peer => "PEER AT2",
            Format::Smc => "SMC",
            Format::Columns => "columns",
            Format::Cosmos => "COSMOS",
            Format::Csmip => "CSMIP",
            Format::Esm => "ESM ASC",
            Format::Knet => "K-NET",
            Format::Geonet => "GeoNet",
            Format::Nsmn => "NSMN",
            Format::Unam => "UNAM",
            Format::Renadic => "RENADIC",
            Format::Bhrc => "BHRC",
            Format::Usc => "USC",
            Format::Jma => "JMA",
            Format::Cwb => "CWB",
            Format::Fixed => "fixed width",
        })
    }
}

/// A word that names no [`Format`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found format {0:?}, expected one of {list}", list = Format::NAMES)]
pub struct UnknownFormat(pub String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<Format, UnknownFormat> {
        match text.to_ascii_lowercase().as_str() {
            "peer" | "at2" => Ok(Format::Peer),
            "smc" => Ok(Format::Smc),
            "columns" | "csv" | "txt" => Ok(Format::Columns),
            "cosmos" => Ok(Format::Cosmos),
            "csmip" | "dmg" | "cesmd" => Ok(Format::Csmip),
            "esm" | "asc" | "itaca" | "dyna" | "afad" | "tadas" => Ok(Format::Esm),
            "knet" | "k-net" | "kiknet" | "kik-net" => Ok(Format::Knet),
            "geonet" => Ok(Format::Geonet),
            "nsmn" => Ok(Format::Nsmn),
            "unam" | "racm" => Ok(Format::Unam),
            "renadic" => Ok(Format::Renadic),
            "bhrc" => Ok(Format::Bhrc),
            "usc" => Ok(Format::Usc),
            "jma" => Ok(Format::Jma),
            "cwb" | "cwa" => Ok(Format::Cwb),
            "fixed" => Ok(Format::Fixed),
            _ => Err(UnknownFormat(text.to_owned())),
        }
    }
}
