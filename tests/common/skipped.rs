//! What a test could not do here, told where it is seen.

use std::io::Write;

/// Says that something is skipped, and why: in the test's output, which is hidden when the test passes, and for the end of
/// scripts/test in the file that `ROCKING_BLOCK_SKIPPED` names.
pub fn skip(what: &str) {
    println!("skipped: {what}");
    if let Some(path) = std::env::var_os("ROCKING_BLOCK_SKIPPED") {
        // One write a line, at the end, so that tests that run at once do not mix theirs.
        let file = std::fs::File::options().create(true).append(true).open(&path);
        let written = file.and_then(|mut file| file.write_all(format!("{what}\n").as_bytes()));
        written.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}
