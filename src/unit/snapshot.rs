//! A saved state ↔ bytes: magic, version, GUID, length, content, checksum.

use serde::{Deserialize, Serialize};

use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;

const MAGIC: [u8; 8] = *b"rockblk\x1a";

/// Version of the content of the planar block. Raise it with every change of [`Unit`](crate::unit::instance::Unit)'s fields.
pub const VERSION: u32 = 13;

#[derive(Serialize, Deserialize)]
struct Header {
    magic: [u8; 8],
    version: u32,
    guid: String,
    length: u64,
    checksum: u32,
}

/// Returns a state as bytes.
///
/// # Errors
/// A state that [`postcard`] cannot write. No state of a run is one.
pub fn serialize<U: Fmu>(unit: &U) -> Result<Vec<u8>, Fault> {
    let internal = |error: postcard::Error| Fault::new(format!("the state cannot be written: {error}"));
    let content = postcard::to_allocvec(unit).map_err(internal)?;
    let header = Header {
        magic: MAGIC,
        version: U::CONTENT_VERSION,
        guid: U::GUID.into(),
        length: content.len() as u64,
        checksum: crc32fast::hash(&content),
    };
    postcard::to_extend(&header, Vec::new())
        .map(|mut bytes| {
            bytes.extend_from_slice(&content);
            bytes
        })
        .map_err(internal)
}

/// Returns the state in these bytes.
///
/// # Errors
/// Bytes of another program or another version, truncated bytes and altered bytes.
pub fn deserialize<U: Fmu>(bytes: &[u8]) -> Result<U, Fault> {
    let refuse = |message: String| Fault::new(format!("serialized state refused: {message}"));
    let (header, content): (Header, &[u8]) = postcard::take_from_bytes(bytes)
        .map_err(|_| refuse(format!("found {} bytes; expected a complete header", bytes.len())))?;
    if header.magic != MAGIC {
        return Err(refuse("found another beginning; expected that of a state of this FMU".into()));
    }
    if header.version != U::CONTENT_VERSION {
        return Err(refuse(format!("found version {}; expected {}", header.version, U::CONTENT_VERSION)));
    }
    if header.guid != U::GUID {
        return Err(refuse(format!("found GUID {:?}; expected {:?}", header.guid, U::GUID)));
    }
    // The importer's buffer may be longer than the content.
    let content = usize::try_from(header.length)
        .ok()
        .and_then(|length| content.get(..length))
        .ok_or_else(|| refuse(format!("found {} bytes of content; expected {}", content.len(), header.length)))?;
    let checksum = crc32fast::hash(content);
    if checksum != header.checksum {
        let expected = header.checksum;
        return Err(refuse(format!("found altered content of checksum {checksum:08x}; expected {expected:08x}")));
    }
    let unit: U = postcard::from_bytes(content)
        .map_err(|error| refuse(format!("found broken content; expected a state: {error}")))?;
    if unit.is_valid() {
        Ok(unit)
    } else {
        Err(refuse("found impossible numbers; expected the state of a block".into()))
    }
}
