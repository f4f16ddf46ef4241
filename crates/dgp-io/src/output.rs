//! Where a file goes piece by piece: blocks are made in parallel and written in order, while the
//! next ones are made. All formats write through it.

use std::{io::Write, mem, ops::Range};

use dgp_mesh::{Progress, parallel};

use crate::Error;

/// Blocks made at a time. Two such batches are all of the file that is in memory: few enough to stay
/// in the cache, where making a block anew costs no fresh memory.
const BATCH: usize = 8;

/// A sink for the bytes of a file.
pub(crate) struct Output<'a> {
    sink: &'a mut (dyn Write + Send),
    bytes: usize,
    /// The blocks being made.
    made: Vec<Vec<u8>>,
    /// The blocks being written.
    ready: Vec<Vec<u8>>,
}

impl<'a> Output<'a> {
    pub(crate) fn new(sink: &'a mut (dyn Write + Send)) -> Self {
        let room = || vec![Vec::new(); BATCH];
        Output { sink, bytes: 0, made: room(), ready: room() }
    }

    /// How many bytes were written.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Writes `bytes`.
    pub(crate) fn put(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.bytes += bytes.len();
        self.sink.write_all(bytes).map_err(|source| Error::Sink { source })
    }

    /// Writes what `make` adds to an empty buffer for consecutive ranges of `0..len`, each of `block`
    /// elements but the last.
    pub(crate) fn blocks(
        &mut self,
        len: usize,
        block: usize,
        make: impl Fn(Range<usize>, &mut Vec<u8>) + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        let fill = |first: usize, room: &mut [Vec<u8>]| {
            let count = (len - first).div_ceil(block).min(BATCH);
            parallel::for_each_chunk(&mut room[..count], 1, |i, chunk| {
                let start = first + i * block;
                chunk[0].clear();
                make(start..(start + block).min(len), &mut chunk[0]);
            });
            count
        };
        let mut first = 0;
        let mut count = fill(first, &mut self.made);
        while count > 0 {
            mem::swap(&mut self.made, &mut self.ready);
            let end = (first + count * block).min(len);
            let (ready, made, sink) = (&self.ready[..count], &mut self.made, &mut *self.sink);
            let write = || ready.iter().try_for_each(|bytes| sink.write_all(bytes));
            let (written, next) = parallel::join(write, || fill(end, made));
            written.map_err(|source| Error::Sink { source })?;
            self.bytes += ready.iter().map(Vec::len).sum::<usize>();
            progress.report(end as f64 / len as f64)?;
            (first, count) = (end, next);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, io, ops::ControlFlow, sync::Mutex};

    use super::*;

    /// A disk with room for that many bytes.
    struct Disk(usize);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn numbers(output: &mut Output<'_>, len: usize, progress: Progress<'_>) -> Result<(), Error> {
        let make = |range: Range<usize>, bytes: &mut Vec<u8>| {
            bytes.extend(range.flat_map(|i| (i as u32).to_le_bytes()));
        };
        output.blocks(len, 10, make, progress)
    }

    #[test]
    fn blocks_come_in_order_and_whole() {
        for len in [0, 1, 10, 11, 10 * BATCH, 10 * BATCH + 1, 777] {
            let mut bytes = Vec::new();
            let mut output = Output::new(&mut bytes);
            numbers(&mut output, len, Progress::NONE).unwrap();
            assert_eq!(output.bytes(), 4 * len);
            let expected: Vec<u8> = (0..len as u32).flat_map(u32::to_le_bytes).collect();
            assert_eq!(bytes, expected);
        }
    }

    #[test]
    fn a_full_disk_is_an_error() {
        for room in [0, 100, 1001] {
            let mut disk = Disk(room);
            let result = numbers(&mut Output::new(&mut disk), 1000, Progress::NONE);
            let Err(Error::Sink { source }) = result else { panic!("{result:?}") };
            assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        }
    }

    #[test]
    fn progress_rises_and_stops_within_a_batch() {
        let seen = Mutex::new(Vec::new());
        let stop = |x: f64| {
            let mut seen = seen.lock().unwrap();
            seen.push(x);
            if x > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut bytes = Vec::new();
        let result = numbers(&mut Output::new(&mut bytes), 1000, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))));
        let seen = seen.into_inner().unwrap();
        assert!(seen.is_sorted() && seen.len() > 3, "{seen:?}");
        assert!(bytes.len() < 4 * (500 + 2 * 10 * BATCH), "{} bytes", bytes.len());
    }

    #[test]
    fn buffers_are_used_again() {
        let mut bytes = Vec::new();
        let mut output = Output::new(&mut bytes);
        numbers(&mut output, 1000, Progress::NONE).unwrap();
        let places = |output: &Output<'_>| -> BTreeSet<usize> {
            output.made.iter().chain(&output.ready).map(|room| room.as_ptr().addr()).collect()
        };
        let before = places(&output);
        numbers(&mut output, 5000, Progress::NONE).unwrap();
        assert_eq!(places(&output), before);
    }
}
