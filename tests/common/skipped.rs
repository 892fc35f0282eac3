//! Reports of skipped tests.

use std::io::Write;

/// Reports a skipped test and the reason: in the test's output, which is hidden when the test passes, and in the file named by
/// `ROCKING_BLOCK_SKIPPED`, which scripts/test prints at its end.
pub fn skip(what: &str) {
    println!("skipped: {what}");
    if let Some(path) = std::env::var_os("ROCKING_BLOCK_SKIPPED") {
        // One write per line at the end of the file, so that parallel tests do not interleave.
        let file = std::fs::File::options().create(true).append(true).open(&path);
        let written = file.and_then(|mut file| file.write_all(format!("{what}\n").as_bytes()));
        written.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}
