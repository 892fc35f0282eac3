//! How far a long run is, on the terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar with the time left, on the terminal once the work takes over a second.
pub struct Progress {
    since: Instant,
    before: u64,
    bar: ProgressBar,
    shown: bool,
}

impl Progress {
    /// A bar of so many parts, of which some were done before: these say nothing of the speed and are left out.
    pub fn new(parts: u64, before: u64) -> Progress {
        let style = ProgressStyle::with_template("{wide_bar} {percent}% {eta} left");
        let bar = ProgressBar::with_draw_target(Some(parts.saturating_sub(before)), ProgressDrawTarget::hidden())
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Progress { since: Instant::now(), before, bar, shown: false }
    }

    /// Shows how many parts are done.
    pub fn show(&mut self, done: u64) {
        if !self.shown && self.since.elapsed() > Duration::from_secs(1) {
            self.shown = true;
            if std::io::stderr().is_terminal() {
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
            }
        }
        self.bar.set_position(done.saturating_sub(self.before));
    }

    /// Shows how many parts are done where their number turns out on the way.
    pub fn show_of(&mut self, done: u64, parts: u64) {
        self.bar.set_length(parts.saturating_sub(self.before));
        self.show(done);
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
