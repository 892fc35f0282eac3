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
    /// CSMIP (DMG) volume 2.
    Csmip,
    /// ASC of the European ESM and ITACA databases.
    Esm,
}

impl Format {
    pub(super) const ALL: [Format; 6] =
        [Format::Peer, Format::Smc, Format::Columns, Format::Cosmos, Format::Csmip, Format::Esm];

    /// Names that [`Format::from_str`] reads, for messages.
    pub const NAMES: &'static str = "peer, smc, columns, cosmos, csmip, esm";
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
            "csmip" | "dmg" => Ok(Format::Csmip),
            "esm" | "asc" => Ok(Format::Esm),
            _ => Err(UnknownFormat(text.to_owned())),
        }
    }
}
