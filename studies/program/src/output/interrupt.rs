//! Ctrl-C → the command that continues a study.

use std::path::Path;

/// Prints the command that continues this one when Ctrl-C ends it. The table must be a file.
#[cfg(unix)]
pub fn print_continuation(table: &Path) -> anyhow::Result<()> {
    use rocking_studies::output::output_target::OutputTarget;
    use signal_hook::consts::SIGINT;

    if is_ignored() || !matches!(OutputTarget::of(table)?, OutputTarget::File(_)) {
        return Ok(());
    }
    let mut signals = signal_hook::iterator::Signals::new([SIGINT])?;
    std::thread::spawn(move || {
        if signals.forever().next().is_some() {
            eprintln!("\nrocking: interrupted; the table keeps its rows. To continue: {}", continuation());
            // Ends the program as without a handler, so that a script ends with it.
            let _ = signal_hook::low_level::emulate_default_handler(SIGINT);
        }
    });
    Ok(())
}

/// There is no signal of Ctrl-C to catch.
#[cfg(not(unix))]
pub fn print_continuation(_: &Path) -> anyhow::Result<()> {
    Ok(())
}

/// Returns whether the program was started to ignore Ctrl-C. It is so in the background of a shell script.
#[cfg(unix)]
fn is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask >> (signal_hook::consts::SIGINT - 1) & 1 == 1)
}

/// Returns the command line with `--resume`.
#[cfg(unix)]
fn continuation() -> String {
    let words = std::env::args().filter(|word| word != "--force" && word != "--resume").map(|word| quoted(&word));
    words.chain(["--resume".into()]).collect::<Vec<_>>().join(" ")
}

/// Quotes a word for a shell if required.
#[cfg(unix)]
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/=,:+%@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}
