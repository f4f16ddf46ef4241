//! Text as words and numbers: the cutting of a file into blocks of lines, and a [`Cursor`] over them.

mod cursor;

use std::{
    ops::Range,
    sync::atomic::{AtomicUsize, Ordering},
};

use dgp_mesh::{Progress, parallel};

pub(crate) use cursor::Cursor;

use crate::{
    Format,
    error::{Cause, Fault, Stop},
};

/// Bytes of text a thread works on at a time: some thousand lines, so that starting a task costs
/// nothing, and few enough that what is parsed of them stays in the second-level cache.
const BLOCK: usize = 1 << 18;

/// A file of text.
#[derive(Clone, Copy)]
pub(crate) struct Text<'a> {
    pub(crate) bytes: &'a [u8],
    /// What ends a line: `\n`, or `\r` where there is no `\n`. Another `\r` is a blank.
    eol: u8,
    /// Whether `\` before the end of a line joins it with the next one.
    joined: bool,
}

impl<'a> Text<'a> {
    /// The text in `bytes`, unless there is none or it is of the wrong kind.
    pub(crate) fn new(bytes: &'a [u8], format: Format) -> Result<Self, Fault> {
        if bytes.is_empty() {
            return Err(Fault::new(0, Cause::Empty));
        }
        // A byte order mark, or Latin letters with zeros between them.
        let marked = bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF");
        let spaced = |first: usize| {
            bytes.len() >= 8 && bytes[..8].iter().skip(first).step_by(2).all(|&byte| byte == 0)
        };
        if marked || spaced(0) || spaced(1) {
            return Err(Fault::new(0, Cause::Utf16));
        }
        let eol = match memchr::memchr2(b'\n', b'\r', bytes) {
            Some(end) if bytes[end] == b'\r' && memchr::memchr(b'\n', bytes).is_none() => b'\r',
            _ => b'\n',
        };
        Ok(Text { bytes, eol, joined: format == Format::Obj })
    }

    /// A cursor at the beginning, behind the byte order mark.
    pub(crate) fn start(self) -> Cursor<'a> {
        let mark: &[u8] = b"\xEF\xBB\xBF";
        let at = if self.bytes.starts_with(mark) { mark.len() } else { 0 };
        self.cursor(at..self.bytes.len())
    }

    /// A cursor over a part of the text.
    pub(crate) fn cursor(self, range: Range<usize>) -> Cursor<'a> {
        Cursor {
            bytes: &self.bytes[..range.end],
            at: range.start,
            eol: self.eol,
            joined: self.joined,
        }
    }

    /// The text from byte `start` cut at ends of lines. The cuts depend on the text only.
    pub(crate) fn blocks(self, start: usize) -> Vec<Range<usize>> {
        let len = self.bytes.len();
        let mut blocks = Vec::new();
        let mut at = start;
        while at < len {
            let mut end = at;
            let mut search = (at + BLOCK).min(len);
            while end == at {
                match memchr::memchr(self.eol, &self.bytes[search..]) {
                    Some(found) if self.is_joined(search + found) => search += found + 1,
                    Some(found) => end = search + found + 1,
                    None => end = len,
                }
            }
            blocks.push(at..end);
            at = end;
        }
        blocks
    }

    /// Whether the line that ends at `end` goes on in the next one.
    fn is_joined(self, end: usize) -> bool {
        let line = &self.bytes[..end];
        self.joined && line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\")
    }

    /// The blocks from byte `start` on with the number of the first row in each. A row is a line,
    /// or, counted with more care, a line that is neither blank nor a comment.
    pub(crate) fn row_blocks(self, start: usize, count: RowCount) -> Vec<(Range<usize>, usize)> {
        let blocks = self.blocks(start);
        let counts = parallel::map_blocks(blocks.len(), 1, |b| {
            let block = blocks[b.start].clone();
            match count {
                RowCount::Lines => memchr::memchr_iter(self.eol, &self.bytes[block]).count(),
                RowCount::Filled => {
                    let mut cursor = self.cursor(block);
                    let mut rows = 0;
                    while !cursor.is_at_end() {
                        rows += usize::from(!cursor.ends_line());
                        cursor.skip_line();
                    }
                    rows
                }
            }
        });
        let mut first = 0;
        let numbered = blocks.into_iter().zip(counts).map(|(block, count)| {
            first += count;
            (block, first - count)
        });
        numbered.collect()
    }
}

/// Which lines count as rows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowCount {
    /// All.
    Lines,
    /// Those with a word.
    Filled,
}

/// The byte at which the line `row` begins, counted from the line at `start`, blank lines left aside.
pub(crate) fn row_byte(bytes: &[u8], start: usize, row: usize) -> usize {
    let eol = if memchr::memchr(b'\n', bytes).is_some() { b'\n' } else { b'\r' };
    let text = Text { bytes, eol, joined: false };
    let mut cursor = text.cursor(start..bytes.len());
    let mut left = row;
    while !cursor.is_at_end() {
        if !cursor.ends_line() {
            if left == 0 {
                break;
            }
            left -= 1;
        }
        cursor.skip_line();
    }
    cursor.at
}

/// The number of the line that byte `at` is in, from 1.
pub(crate) fn line(bytes: &[u8], at: usize) -> usize {
    let before = &bytes[..at.min(bytes.len())];
    let ends = memchr::memchr_iter(b'\n', before).count();
    let old = ends == 0 && memchr::memchr(b'\n', bytes).is_none();
    1 + if old { memchr::memchr_iter(b'\r', before).count() } else { ends }
}

/// `f` of each block, in order; the first fault in the order of the file counts.
pub(crate) fn map_blocks<T: Send>(
    blocks: &[Range<usize>],
    f: impl Fn(usize, Range<usize>) -> Result<T, Stop> + Sync + Send,
    progress: Progress<'_>,
) -> Result<Vec<T>, Stop> {
    let done = AtomicUsize::new(0);
    let results = parallel::map_blocks(blocks.len(), 1, |range| {
        let result = f(range.start, blocks[range.start].clone())?;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(done as f64 / blocks.len() as f64)?;
        Ok(result)
    });
    results.into_iter().collect()
}

/// A word as messages show it: not too much of it, and only what can be printed.
pub(crate) fn shown(word: &[u8]) -> String {
    const MOST: usize = 40;
    let cut = String::from_utf8_lossy(&word[..word.len().min(MOST)]);
    let mut text: String = cut.chars().map(|c| if c.is_control() { '·' } else { c }).collect();
    if word.len() > MOST {
        text.push('…');
    }
    text
}

/// Bytes as text: UTF-8, or else Latin-1, in which every byte is a letter.
pub(crate) fn decoded(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> Text<'_> {
        Text::new(bytes, Format::Obj).unwrap()
    }

    #[test]
    fn blocks_end_with_lines_and_cover_the_text() {
        let mut bytes = b"f 1 2 3\n".repeat(BLOCK / 3);
        bytes.extend(b"v 1 2 \\\n".repeat(BLOCK / 4));
        let blocks = text(&bytes).blocks(0);
        assert!(blocks.len() > 2);
        assert_eq!(blocks.iter().map(Range::len).sum::<usize>(), bytes.len());
        let cuts = blocks[1..].iter().map(|block| block.start);
        assert!(cuts.into_iter().all(|at| bytes[..at].ends_with(b"3\n")));
    }

    #[test]
    fn utf16_and_nothing_are_refused() {
        let utf16: Vec<u8> = "v 1 2 3".bytes().flat_map(|byte| [0, byte]).collect();
        assert_eq!(Text::new(&utf16, Format::Obj).err().unwrap().cause, Cause::Utf16);
        assert_eq!(Text::new(b"", Format::Obj).err().unwrap().cause, Cause::Empty);
    }
}
