//! Finished part of the work → a bar on the terminal.

use std::io::IsTerminal;
use std::sync::Once;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar with the time left, shown on the terminal after one second.
pub struct Progress {
    since: Instant,
    before: u64,
    bar: ProgressBar,
    shown: Once,
}

impl Progress {
    /// Begins a bar; parts done `before` do not count towards the speed.
    pub fn new(parts: u64, before: u64) -> Progress {
        let style = ProgressStyle::with_template("{msg}{wide_bar} {percent}% {eta} left");
        let bar = ProgressBar::with_draw_target(Some(parts.saturating_sub(before)), ProgressDrawTarget::hidden())
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Progress { since: Instant::now(), before, bar, shown: Once::new() }
    }

    /// Shows the number of finished parts.
    pub fn show(&self, done: u64) {
        if self.since.elapsed() > Duration::from_secs(1) {
            self.shown.call_once(|| {
                if std::io::stderr().is_terminal() {
                    self.bar.set_draw_target(ProgressDrawTarget::stderr());
                }
            });
        }
        self.bar.set_position(done.saturating_sub(self.before));
    }

    /// Shows the name of the step and the finished parts. Their total changes during the work.
    pub fn show_step(&self, step: &str, done: u64, parts: u64) {
        if self.bar.message().trim_end() != step {
            self.bar.set_message(format!("{step} "));
        }
        self.show_of(done, parts);
    }

    /// Shows the number of finished parts of a total that changes during the work.
    pub fn show_of(&self, done: u64, parts: u64) {
        self.bar.set_length(parts.saturating_sub(self.before));
        self.show(done);
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
