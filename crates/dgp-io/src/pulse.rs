//! Reports from within a parallel loop over rows.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use dgp_mesh::{Cancelled, Progress};

/// Rows between two reports: a megabyte or two, some hundred microseconds of work.
const EVERY: usize = 1 << 16;

/// What a loop asks at every row.
pub(crate) struct Pulse<'a> {
    progress: Progress<'a>,
    rows: usize,
    done: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Pulse<'a> {
    /// For a loop over that many rows, in whatever order.
    pub(crate) fn new(rows: usize, progress: Progress<'a>) -> Self {
        Pulse { progress, rows, done: AtomicUsize::new(0), stopped: AtomicBool::new(false) }
    }

    /// Whether row `row` is still wanted.
    #[inline]
    pub(crate) fn beat(&self, row: usize) -> bool {
        if row.is_multiple_of(EVERY) {
            self.report();
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    #[cold]
    fn report(&self) {
        let done = self.done.fetch_add(EVERY, Ordering::Relaxed) as f64;
        if self.progress.report(done / self.rows as f64).is_err() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    /// An error if the loop was stopped.
    pub(crate) fn end(&self) -> Result<(), Cancelled> {
        if self.stopped.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    #[test]
    fn loops_stop_soon_after_they_are_told() {
        let stop =
            |x: f64| if x > 0.4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let rows = 10 * EVERY;
        let pulse = Pulse::new(rows, Progress::new(&stop));
        let wanted = (0..rows).filter(|&row| pulse.beat(row)).count();
        assert_eq!(wanted, 5 * EVERY);
        assert_eq!(pulse.end(), Err(Cancelled));
        assert_eq!(Pulse::new(0, Progress::NONE).end(), Ok(()));
    }
}
