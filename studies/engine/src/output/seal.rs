//! The bytes of a file → a checksum in its end, by which damage is found.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crc32fast::Hasher;

/// Text in the end of a file whose zeros the checksum of all its bytes replaces.
pub const BLANK: &str = "crc32 of this file with zeros here: 00000000";

/// Hexadecimal digits of the checksum.
const DIGITS: usize = 8;

/// The end of a file of text, which has the checksum.
const LINE: usize = 128;

/// Passes bytes on, and puts their checksum into the last ones.
pub struct SealingWriter<W> {
    out: W,
    hasher: Hasher,
    /// The end of the file, once it has begun.
    end: Option<Vec<u8>>,
}

impl<W: Write> SealingWriter<W> {
    /// Begins a file.
    pub fn new(out: W) -> SealingWriter<W> {
        SealingWriter { out, hasher: Hasher::new(), end: None }
    }

    /// Keeps further bytes, the end of the file.
    pub fn begin_end(&mut self) {
        self.end.get_or_insert_default();
    }

    /// Writes the last line of a file of text, a comment with the checksum.
    ///
    /// # Errors
    /// The output takes no bytes.
    pub fn finish_text(mut self) -> io::Result<W> {
        self.begin_end();
        writeln!(self, "# {BLANK}")?;
        self.finish()
    }

    /// Writes the end of the file with the checksum in place of the zeros of its [`BLANK`].
    ///
    /// # Errors
    /// The output takes no bytes, or the end has no blank.
    pub fn finish(self) -> io::Result<W> {
        let SealingWriter { mut out, mut hasher, end } = self;
        let mut end = end.unwrap_or_default();
        let at = place(&end).ok_or_else(|| io::Error::other("the end of the file has no place for its checksum"))?;
        hasher.update(&end);
        end[at..at + DIGITS].copy_from_slice(digits(hasher).as_bytes());
        out.write_all(&end)?;
        out.flush()?;
        Ok(out)
    }
}

impl<W: Write> Write for SealingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(end) = &mut self.end {
            end.extend_from_slice(bytes);
            return Ok(bytes.len());
        }
        let written = self.out.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The checksum in hexadecimal digits.
fn digits(hasher: Hasher) -> String {
    format!("{:08x}", hasher.finalize())
}

/// The place of the checksum after the last [`BLANK`], with or without its zeros.
fn place(end: &[u8]) -> Option<usize> {
    let text = BLANK.len() - DIGITS;
    let found = end.windows(BLANK.len()).rposition(|window| window[..text] == BLANK.as_bytes()[..text]);
    found.map(|begin| begin + text)
}

/// The state of the bytes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// They are those that were written.
    Whole,
    /// Some are others.
    Broken,
    /// There is no checksum: the file is not of this program, or lacks its end.
    Absent,
}

/// Compares the bytes of a file with the checksum in its end.
///
/// # Errors
/// The file cannot be read.
pub fn check(path: &Path) -> io::Result<Seal> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let end = end_of(&mut file, length)?;
    let begin = length - end.len() as u64;
    let Some(at) = place(&end) else { return Ok(Seal::Absent) };
    file.seek(SeekFrom::Start(0))?;
    let (mut reader, mut hasher) = (BufReader::with_capacity(1 << 16, file.take(begin)), Hasher::new());
    loop {
        let bytes = reader.fill_buf()?;
        let count = bytes.len();
        if count == 0 {
            break;
        }
        hasher.update(bytes);
        reader.consume(count);
    }
    hasher.update(&end[..at]);
    hasher.update(&[b'0'; DIGITS]);
    hasher.update(&end[at + DIGITS..]);
    Ok(if digits(hasher).as_bytes() == &end[at..at + DIGITS] { Seal::Whole } else { Seal::Broken })
}

/// The bytes in which the checksum is: the last line of text, or the footer of Parquet, whose length and mark are its last eight bytes.
fn end_of(file: &mut File, length: u64) -> io::Result<Vec<u8>> {
    let mut read = |count: u64| {
        let count = count.min(length);
        let mut bytes = vec![0; count as usize];
        file.seek(SeekFrom::Start(length - count))?;
        file.read_exact(&mut bytes).map(|()| bytes)
    };
    let last = read(8)?;
    match last.split_first_chunk() {
        Some((footer, b"PAR1")) => read(u64::from(u32::from_le_bytes(*footer)) + 8),
        _ => read(LINE as u64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed(text: &[u8]) -> Vec<u8> {
        let mut writer = SealingWriter::new(Vec::new());
        writer.write_all(text).unwrap();
        writer.finish_text().unwrap()
    }

    fn state(content: &[u8]) -> Seal {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), content).unwrap();
        check(file.path()).unwrap()
    }

    /// The checksum is that of zlib: `zlib.crc32` of the text with eight zeros.
    #[test]
    fn every_bit_counts() {
        let content = sealed(b"row,x\n0,1.5\n1,2.5\n");
        assert!(
            content.ends_with(b"# crc32 of this file with zeros here: 989c7733\n"),
            "{}",
            String::from_utf8_lossy(&content)
        );
        assert_eq!(state(&content), Seal::Whole);
        for bit in 0..8 * content.len() {
            let mut spoilt = content.clone();
            spoilt[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(state(&spoilt), Seal::Whole, "bit {bit}");
        }
        for length in 0..content.len() {
            assert_ne!(state(&content[..length]), Seal::Whole, "{length} bytes");
        }
    }

    #[test]
    fn files_of_any_length_are_read() {
        for length in [0, 1, 100, 1 << 16, 200_000] {
            let text: Vec<u8> = (0..length).map(|i: u32| b'a' + (i % 23) as u8).collect();
            let mut content = sealed(&text);
            assert_eq!(state(&content), Seal::Whole, "{length}");
            content.insert(0, b'#');
            assert_eq!(state(&content), Seal::Broken, "{length}");
        }
        assert_eq!(state(b""), Seal::Absent);
        assert_eq!(state(b"row,x\n"), Seal::Absent);
    }
}
