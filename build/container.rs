//! Files → a zip archive; same files, same bytes.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Writes the archive and moves it into place atomically, so that a partial archive never appears.
pub fn write(path: &Path, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    let temporary = path.with_extension(format!("fmu.{}", std::process::id()));
    let written = fill(&temporary, files)
        .and_then(|()| std::fs::rename(&temporary, path).map_err(|e| format!("{}: {e}", path.display())));
    if written.is_err() {
        // The first error is the one to report.
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

fn fill(path: &Path, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut archive = ZipWriter::new(std::fs::File::create(path).map_err(|e| failed(&e))?);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for (name, content) in files {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        archive.start_file(name.as_str(), options.unix_permissions(mode)).map_err(|e| failed(&e))?;
        archive.write_all(content).map_err(|e| failed(&e))?;
    }
    archive.finish().map_err(|e| failed(&e))?;
    Ok(())
}
