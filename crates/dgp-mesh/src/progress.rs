//! How a long computation tells how far it is, and is told to stop.

use std::{fmt, ops::ControlFlow};

/// The caller asked the computation to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Where a computation reports to. Copy it, pass it on, hand out [parts](Progress::part) of it.
///
/// ```
/// use std::ops::ControlFlow;
/// use dgp_mesh::{Cancelled, Progress};
///
/// fn work(progress: Progress<'_>) -> Result<(), Cancelled> {
///     progress.report(0.0)?;
///     progress.part(0.5, 1.0).report(0.5)
/// }
///
/// let stop_late = |x: f64| if x > 0.7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
/// assert_eq!(work(Progress::new(&stop_late)), Err(Cancelled));
/// assert_eq!(work(Progress::NONE), Ok(()));
/// ```
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    callback: Option<&'a Callback<'a>>,
    start: f64,
    length: f64,
}

/// Gets the fraction done, from 0 to 1; answers whether to go on.
pub type Callback<'a> = dyn Fn(f64) -> ControlFlow<()> + Sync + 'a;

impl<'a> Progress<'a> {
    /// Reports to nobody and never stops.
    pub const NONE: Progress<'static> = Progress { callback: None, start: 0.0, length: 1.0 };

    /// Reports to `callback`, which stops the computation by `ControlFlow::Break`.
    pub fn new(callback: &'a Callback<'a>) -> Self {
        Progress { callback: Some(callback), start: 0.0, length: 1.0 }
    }

    /// Tells that the fraction `done` is done; an error if the caller wants no more of it.
    pub fn report(self, done: f64) -> Result<(), Cancelled> {
        match self.callback.map(|callback| callback(self.start + self.length * done)) {
            Some(ControlFlow::Break(())) => Err(Cancelled),
            _ => Ok(()),
        }
    }

    /// The progress of a step that leads from fraction `from` to fraction `to` of this one.
    pub fn part(self, from: f64, to: f64) -> Self {
        let start = self.start + self.length * from;
        Progress { callback: self.callback, start, length: self.length * (to - from) }
    }
}

impl fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Progress({}..{})", self.start, self.start + self.length)
    }
}
