//! How far a long run is, on the terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// A bar with the time left, on the terminal once the work takes over a second.
pub struct Progress {
    since: Instant,
    /// What was done before: it says nothing of the speed.
    before: u64,
    parts: u64,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// A bar of so many parts, of which some were done before.
    pub fn new(parts: u64, before: u64) -> Progress {
        Progress { since: Instant::now(), before, parts, bar: None }
    }

    /// Shows how many parts are done.
    pub fn show(&mut self, done: u64) {
        if self.bar.is_none() && self.since.elapsed() > Duration::from_secs(1) && std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{wide_bar} {percent}% {eta} left");
            let bar = ProgressBar::new(self.parts).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_position(self.before);
            bar.reset_eta();
            self.bar = Some(bar.with_elapsed(self.since.elapsed()));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(done);
        }
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
