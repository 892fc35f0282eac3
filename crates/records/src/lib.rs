//! Accelerogram files → evenly spaced ground accelerations in m/s².
//!
//! [`read`] detects the format from the content and returns a [`Record`], a piecewise linear ground acceleration. Missing
//! information (unit, time step) comes from [`ReadOptions`]; the statements of the file must agree with them. A file that
//! cannot be read completely and without doubt is refused with a [`RecordError`] of one line.
//!
//! | module | in → out |
//! | --- | --- |
//! | `unit`, `format` | words → unit, format |
//! | `fixed_layout` | edit descriptor of Fortran → columns of a line |
//! | `options` | the caller's knowledge of a file |
//! | `error` | file, line, found, expected → a message of one line |
//! | `processing` | changes to a record, in words |
//! | `record` | samples → accelerations at any time, peak |
//! | `filter` | a record → without its trend, filtered, with another time step |
//! | `text` | bytes → lines and numbers |
//! | `claims` | text of a header, options → unit and time step |
//! | `raw` | content of a file in its own unit, options → a record |
//! | `time_axis` | column of times → start and time step |
//! | `clock` | date and time of day → seconds |
//! | `channels` | file of several channels → the lines of one |
//! | `table` | lines → separator, header row, first row of numbers |
//! | `rows`, `volume` | layouts that several formats share → numbers of one channel |
//! | `peer`, `smc`, `columns`, `cosmos`, `csmip`, `esm`, `knet`, `geonet`, `nsmn`, `unam`, `renadic`, `bhrc`, `usc`, `jma`, `cwb`, `csmnc`, `esd`, `npts`, `fixed` | lines of a format → raw content |
//! | `plausibility` | a record → a reason for doubt |

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod unit;

mod format;

mod fixed_layout;

mod options;

mod error;

mod processing;

mod record;

mod filter;

mod text;

mod claims;

mod raw;

mod time_axis;

mod clock;

mod channels;

mod table;

mod rows;

mod volume;

mod peer;

mod smc;

mod columns;

mod cosmos;

mod csmip;

mod esm;

mod knet;

mod geonet;

mod nsmn;

mod unam;

mod renadic;

mod bhrc;

mod usc;

mod jma;

mod cwb;

mod csmnc;

mod esd;

mod npts;

mod fixed;

mod plausibility;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

pub use error::RecordError;
pub use fixed_layout::{FixedLayout, UnknownLayout};
pub use format::{Format, UnknownFormat};
pub use options::{Choice, ReadOptions, Setting};
pub use processing::Processing;
pub use record::{Peak, Record};
pub use unit::{Unit, UnknownUnit};

use text::FileText;

/// Largest file that is read (MiB). The longest accelerograms have 10⁶ values, a few tens of MiB.
pub const LARGEST_FILE: u64 = 512;

/// Reads an accelerogram file.
///
/// # Errors
/// [`RecordError::Unreadable`] before the content is examined, then those of [`parse`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    parse(&path.display().to_string(), &bytes(path)?, options)
}

/// Reads an accelerogram file, with the reason to doubt its content, if there is one.
///
/// # Errors
/// Those of [`read`].
pub fn read_with_doubt(path: &Path, options: &ReadOptions) -> Result<(Record, Option<String>), RecordError> {
    parse_with_doubt(&path.display().to_string(), &bytes(path)?, options)
}

/// Reads the bytes of a file, up to one more than [`parse`] accepts. Its path may be a URL of this machine, as `file:///tmp/a%20b.smc`.
///
/// # Errors
/// [`RecordError::Unreadable`].
pub fn bytes(path: &Path) -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    local_path(path)
        .and_then(File::open)
        .and_then(|file| file.take((LARGEST_FILE << 20) + 1).read_to_end(&mut bytes))
        .map_err(|error| RecordError::Unreadable { file: path.display().to_string(), error })?;
    Ok(bytes)
}

/// Returns the path of a file's URL (RFC 8089), or any other path unchanged.
///
/// # Errors
/// The URL is of another machine.
pub fn local_path(path: &Path) -> io::Result<PathBuf> {
    let text = path.to_string_lossy();
    let Some(rest) = text.strip_prefix("file:").filter(|rest| rest.starts_with('/')) else { return Ok(path.into()) };
    let encoded = match rest.strip_prefix("//") {
        None => rest,
        Some(rest) => match rest.strip_prefix("localhost").unwrap_or(rest) {
            local if local.starts_with('/') => local,
            _ => {
                let expected = "a URL of another machine; expected file:///, or a path";
                return Err(io::Error::new(io::ErrorKind::InvalidInput, expected));
            }
        },
    };
    // A drive has no slash before it: file:///C:/records.
    let encoded = if cfg!(windows) { &encoded[1..] } else { encoded };
    let (mut bytes, mut rest) = (Vec::with_capacity(encoded.len()), encoded.as_bytes());
    while let [first, others @ ..] = rest {
        let digit = |place: usize| others.get(place).and_then(|byte| char::from(*byte).to_digit(16));
        let (byte, after) = match (first, digit(0), digit(1)) {
            (b'%', Some(high), Some(low)) => ((16 * high + low) as u8, &others[2..]),
            _ => (*first, others),
        };
        bytes.push(byte);
        rest = after;
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned().into())
}

/// Reads an accelerogram from the bytes of its file.
///
/// `name` names the file in errors and replaces a missing title. Text that is not UTF-8 is read as Latin-1, which real headers
/// contain.
///
/// # Errors
/// The file is not an accelerogram, is incomplete, disagrees with `options`, or leaves a choice that `options` does not make.
pub fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Record, RecordError> {
    parse_with_doubt(name, bytes, options).map(|(record, _)| record)
}

/// Reads an accelerogram from the bytes of its file, with any reason for doubt. The reason is a peak other than that of the header, one
/// beyond any earthquake, or the frequencies of velocities.
///
/// # Errors
/// Those of [`parse`].
pub fn parse_with_doubt(
    name: &str,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<(Record, Option<String>), RecordError> {
    let refused = |message: String| RecordError::File { file: name.to_owned(), message };
    if bytes.len() as u64 > LARGEST_FILE << 20 {
        return Err(refused(format!("more than {LARGEST_FILE} MiB, expected one accelerogram")));
    }
    for (option, value) in
        [("time step", options.time_step), ("gravity", Some(options.gravity)), ("value scale", options.value_scale)]
    {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return Err(refused(format!("{option} = {value}; expected a finite number above 0")));
        }
    }
    let source = FileText::new(name, bytes)?;
    let format = match options.format {
        Some(format) => format,
        None if options.layout.is_some() => Format::Fixed,
        None => detect(&source, options),
    };
    let channel = options.channel.as_ref();
    let mut raw = match format {
        Format::Peer => peer::read(&source),
        Format::Smc => smc::read(&source),
        Format::Columns => columns::read(&source, options),
        Format::Cosmos => cosmos::read(&source, channel),
        Format::Csmip => csmip::read(&source, channel),
        Format::Esm => esm::read(&source),
        Format::Knet => knet::read(&source, channel),
        Format::Geonet => geonet::read(&source, channel),
        Format::Nsmn => nsmn::read(&source, channel),
        Format::Unam => unam::read(&source, channel),
        Format::Renadic => renadic::read(&source, channel),
        Format::Bhrc => bhrc::read(&source, channel),
        Format::Usc => usc::read(&source),
        Format::Jma => jma::read(&source, channel),
        Format::Cwb => cwb::read(&source, channel),
        Format::Csmnc => csmnc::read(&source),
        Format::Esd => esd::read(&source),
        Format::Npts => npts::read(&source),
        Format::Fixed => fixed::read(&source, options),
    }?;
    if let (Some(scale), Format::Columns | Format::Fixed) = (options.value_scale, format) {
        raw.values.iter_mut().for_each(|value| *value *= scale);
    }
    let (record, differing_peak) = raw.into_record(&source, options)?;
    let doubt = differing_peak.or_else(|| plausibility::implausibility(bytes, &record));
    let record = options.processing.apply(record).map_err(refused)?;
    Ok((record, doubt))
}

/// Detects the format by a line that no other format has. Otherwise the layout of the numbers decides.
fn detect(source: &FileText<'_>, options: &ReadOptions) -> Format {
    let head = source.head();
    let first = head.first().copied().unwrap_or_default();
    let columns_chosen = options.time_column.is_some() || options.acceleration_column.is_some();
    let any = |is_line: fn(&str) -> bool| head.iter().any(|line| is_line(line));
    let found = [
        (smc::is_first_line(first), Format::Smc),
        (cosmos::is_first_line(first), Format::Cosmos),
        (bhrc::is_first_line(first), Format::Bhrc),
        (jma::is_first_line(first), Format::Jma),
        (geonet::is_head(&head), Format::Geonet),
        (usc::is_head(&head), Format::Usc),
        (any(renadic::is_header_line), Format::Renadic),
        (any(esm::is_header_line), Format::Esm),
        (any(knet::is_header_line), Format::Knet),
        (any(nsmn::is_header_line), Format::Nsmn),
        (any(unam::is_header_line), Format::Unam),
        (any(cwb::is_header_line), Format::Cwb),
        (any(csmnc::is_header_line), Format::Csmnc),
        (any(esd::is_header_line), Format::Esd),
        (csmip::is_volume_one(first) || any(volume::is_block_line), Format::Csmip),
        (!any(peer::has_npts) && npts::is_head(&head), Format::Npts),
        (any(peer::has_npts) || !columns_chosen && table::is_block(&head), Format::Peer),
    ];
    found.into_iter().find(|(is_found, _)| *is_found).map_or(Format::Columns, |(_, format)| format)
}
