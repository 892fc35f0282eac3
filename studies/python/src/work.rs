//! Long work → its result, while Python shows progress and handles Ctrl-C.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Interval between Python's checks of progress and signals. It is too long to cost time and too short to notice.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// Progress of the work, and whether the caller still waits for it.
#[derive(Default)]
pub struct Progress {
    done: AtomicU64,
    total: AtomicU64,
    abandoned: AtomicBool,
}

/// Panic payload that unwinds a thread whose work was abandoned.
struct Abandoned;

impl Progress {
    /// Records the progress.
    pub fn show(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.fetch_max(done, Ordering::Relaxed);
    }

    /// Records the progress, and unwinds the thread if the caller has stopped waiting.
    pub fn advance(&self, done: u64, total: u64) {
        self.show(done, total);
        self.end_if_abandoned();
    }

    /// Unwinds the thread, without a panic message, if the caller has stopped waiting for its result.
    pub fn end_if_abandoned(&self) {
        if self.abandoned.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Abandoned));
        }
    }
}

/// Does work on a separate thread, without the interpreter lock. `tick(done, total)` is called about 20 times a
/// second, and Python's signals are handled at the same rate. An exception of either, such as `KeyboardInterrupt`, is raised at
/// once; the work ends when it next reports progress.
pub fn wait<T: Send + 'static>(
    py: Python,
    tick: &Bound<PyAny>,
    work: impl FnOnce(&Progress) -> T + Send + 'static,
) -> PyResult<T> {
    let progress = Arc::new(Progress::default());
    let (sender, receiver) = channel();
    let shared = Arc::clone(&progress);
    std::thread::Builder::new().name("rocking-block".into()).spawn(move || {
        // There is no receiver if the work was abandoned.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&shared))));
    })?;
    // A receiver cannot be shared, but detaching requires it.
    let receiver = std::sync::Mutex::new(receiver);
    loop {
        let received = py.detach(|| match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(CHECK_INTERVAL),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match received {
            Ok(Ok(result)) => return Ok(result),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Disconnected) => return Err(PyRuntimeError::new_err("the work was lost")),
            Err(RecvTimeoutError::Timeout) => {
                let [done, total] = [&progress.done, &progress.total].map(|count| count.load(Ordering::Relaxed));
                if let Err(error) = py.check_signals().and_then(|()| tick.call1((done, total))) {
                    progress.abandoned.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    }
}
