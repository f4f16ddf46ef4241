//! How a long computation tells how far it is, and is told to stop.

use std::{fmt, ops::ControlFlow};

use crate::Error;

/// Where a computation reports to. Copy it, pass it on, hand out [parts](Progress::part) of it.
///
/// ```
/// use std::ops::ControlFlow;
/// use dgp_sparse::{Error, Progress};
///
/// let stop = |_| ControlFlow::Break(());
/// assert_eq!(Progress::new(&stop).report(0.5), Err(Error::Cancelled));
/// assert_eq!(Progress::NONE.report(0.5), Ok(()));
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

    /// Tells that the fraction `done` is done; [`Error::Cancelled`] if the caller wants no more of it.
    pub fn report(self, done: f64) -> Result<(), Error> {
        match self.callback.map(|callback| callback(self.start + self.length * done)) {
            Some(ControlFlow::Break(())) => Err(Error::Cancelled),
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
