//! Text as words and numbers: a cursor over bytes, and the cutting of a file into blocks of lines.

use std::{
    ops::Range,
    sync::atomic::{AtomicUsize, Ordering},
};

use dgp_mesh::{Progress, parallel};

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

/// A place in a text that moves over words and numbers. Blanks are all bytes up to the space that
/// do not end a line.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    pub(crate) at: usize,
    eol: u8,
    joined: bool,
}

impl<'a> Cursor<'a> {
    /// Whether everything was read.
    pub(crate) fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// How many bytes are left.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The byte here, 0 at the end.
    #[inline]
    pub(crate) fn peek(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(0)
    }

    /// Moves to the next word of this line, or to its end.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte > b' ' {
                if byte == b'\\' && self.joined && self.skip_joint() {
                    continue;
                }
                return;
            }
            if byte == self.eol {
                return;
            }
            self.at += 1;
        }
    }

    /// Moves over a `\` that joins two lines, if it does.
    #[cold]
    fn skip_joint(&mut self) -> bool {
        let rest = &self.bytes[self.at + 1..];
        let rest = if self.eol == b'\n' { rest.strip_prefix(b"\r").unwrap_or(rest) } else { rest };
        let joins = rest.first() == Some(&self.eol);
        if joins {
            self.at = self.bytes.len() - rest.len() + 1;
        }
        joins
    }

    /// Whether the line has no more words; comments that begin with `#` are none.
    #[inline]
    pub(crate) fn ends_line(&mut self) -> bool {
        self.skip_blanks();
        self.is_at_end() || self.peek() == self.eol || self.peek() == b'#'
    }

    /// Moves to the beginning of the next line.
    #[inline]
    pub(crate) fn skip_line(&mut self) {
        let found = memchr::memchr(self.eol, &self.bytes[self.at.min(self.bytes.len())..]);
        self.at = found.map_or(self.bytes.len(), |end| self.at + end + 1);
    }

    /// Moves to the beginning of the next line that is not joined with this one.
    pub(crate) fn skip_statement(&mut self) {
        let text = Text { bytes: self.bytes, eol: self.eol, joined: self.joined };
        loop {
            self.skip_line();
            if self.is_at_end() || !text.is_joined(self.at - 1) {
                return;
            }
        }
    }

    /// Moves to the next word on this line or a later one, over comments, whose texts go
    /// to `comment`.
    pub(crate) fn skip_to_word(&mut self, mut comment: impl FnMut(&'a [u8])) {
        loop {
            self.skip_blanks();
            if self.is_at_end() {
                return;
            }
            match self.peek() {
                byte if byte == self.eol => self.at += 1,
                b'#' => comment(self.rest_of_line()[1..].trim_ascii()),
                _ => return,
            }
        }
    }

    /// Moves to the next word on this line or a later one; there are no comments.
    pub(crate) fn skip_blank_lines(&mut self) {
        loop {
            self.skip_blanks();
            if self.is_at_end() || self.peek() != self.eol {
                return;
            }
            self.at += 1;
        }
    }

    /// The number that comes next on this line, which may end with a comma.
    pub(crate) fn separated_number(&mut self) -> Result<f64, Fault> {
        self.skip_blanks();
        let start = self.at;
        if let Ok((value, len)) = fast_float2::parse_partial::<f64, _>(&self.bytes[start..])
            && self.bytes.get(start + len) == Some(&b',')
        {
            self.at = start + len + 1;
            return Ok(value);
        }
        self.number()
    }

    /// The next word of this line, empty at its end.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|&byte| byte > b' ') {
            self.at += 1;
        }
        &self.bytes[start..self.at]
    }

    /// What is left of this line, without blanks around it; the cursor moves to its end.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let start = self.at;
        let found = memchr::memchr(self.eol, &self.bytes[start..]);
        self.at = found.map_or(self.bytes.len(), |end| start + end);
        self.bytes[start..self.at].trim_ascii()
    }

    /// The number that comes next on this line.
    #[inline]
    pub(crate) fn number(&mut self) -> Result<f64, Fault> {
        self.skip_blanks();
        if let Ok((value, len)) = fast_float2::parse_partial::<f64, _>(&self.bytes[self.at..])
            && self.ends_word(self.at + len)
            && !self.is_odd(self.at + len)
        {
            self.at += len;
            return Ok(value);
        }
        self.odd_number()
    }

    /// The `N` numbers that come next on this line.
    #[inline]
    pub(crate) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Fault> {
        let mut numbers = [0.0; N];
        for (found, number) in numbers.iter_mut().enumerate() {
            *number = self.number().map_err(|fault| match fault.cause {
                Cause::TooFewNumbers { .. } => {
                    Fault { cause: Cause::TooFewNumbers { found, expected: N }, ..fault }
                }
                _ => fault,
            })?;
        }
        Ok(numbers)
    }

    /// Whether a number that ends at `at` goes on as in `1.#INF`.
    #[inline]
    fn is_odd(&self, at: usize) -> bool {
        self.bytes.get(at) == Some(&b'#') && self.bytes[at - 1] == b'.'
    }

    /// Not-a-number and infinity as Microsoft's library prints them, such as `-1.#IND`.
    #[cold]
    fn odd_number(&mut self) -> Result<f64, Fault> {
        let start = self.at;
        let word = self.word();
        let (sign, digits) = match word.strip_prefix(b"-") {
            Some(digits) => (-1.0, digits),
            None => (1.0, word.strip_prefix(b"+").unwrap_or(word)),
        };
        let printed = |prefix: &[u8]| {
            let rest = digits.strip_prefix(prefix);
            rest.is_some_and(|rest| rest.iter().all(|&byte| byte == b'0'))
        };
        match () {
            () if printed(b"1.#IND") || printed(b"1.#QNAN") => Ok(f64::NAN),
            () if printed(b"1.#INF") => Ok(sign * f64::INFINITY),
            () if word.is_empty() => {
                Err(Fault::new(start, Cause::TooFewNumbers { found: 0, expected: 1 }))
            }
            () => Err(Fault::new(start, Cause::NotANumber { text: shown(word) })),
        }
    }

    /// The number that comes next on this line, and whether it is spelled as a whole number.
    pub(crate) fn spelled_number(&mut self) -> Result<(f64, bool), Fault> {
        self.skip_blanks();
        let start = self.at;
        let number = self.number()?;
        let word = &self.bytes[start..self.at];
        Ok((number, word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+'))))
    }

    /// The whole number that comes next on this line, whatever follows it.
    #[inline]
    pub(crate) fn integer_prefix(&mut self) -> Option<i64> {
        let negative = self.peek() == b'-';
        let mut at = self.at + usize::from(negative || self.peek() == b'+');
        let start = at;
        let mut value = 0_i64;
        while let Some(digit) = self.bytes.get(at).map(|byte| byte.wrapping_sub(b'0'))
            && digit < 10
        {
            // Beyond all counts it stays beyond: what matters is that it is out of range.
            value = value.saturating_mul(10).saturating_add(i64::from(digit));
            at += 1;
        }
        if at == start {
            return None;
        }
        self.at = at;
        Some(if negative { -value } else { value })
    }

    /// The whole number that comes next on this line.
    #[inline]
    pub(crate) fn integer(&mut self) -> Result<i64, Fault> {
        self.skip_blanks();
        let start = self.at;
        match self.integer_prefix() {
            Some(value) if self.ends_word(self.at) => Ok(value),
            _ => {
                self.at = start;
                let text = shown(self.word());
                Err(Fault::new(start, Cause::NotAWholeNumber { text }))
            }
        }
    }

    /// Whether no word goes on at `at`.
    #[inline]
    fn ends_word(&self, at: usize) -> bool {
        self.bytes.get(at).is_none_or(|&byte| byte <= b' ' || byte == b'#' || byte == b'\\')
    }
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
    fn numbers_are_what_c_reads_and_no_more() {
        let mut cursor = text(b"1 -2.5 .5 +3. 1e-3 inf -NaN 1.#INF -1.#IND00").start();
        let numbers: Vec<f64> = (0..9).map(|_| cursor.number().unwrap()).collect();
        assert_eq!(numbers[..6], [1.0, -2.5, 0.5, 3.0, 1e-3, f64::INFINITY]);
        assert!(numbers[6].is_nan() && numbers[7] == f64::INFINITY && numbers[8].is_nan());
        for bad in ["3.1+e2", "1,5", "0x", "--1", "1e", "1.#X", "e5", "."] {
            let fault = text(bad.as_bytes()).start().number().unwrap_err();
            assert_eq!(fault.cause, Cause::NotANumber { text: bad.to_owned() });
        }
    }

    #[test]
    fn whole_numbers_saturate() {
        let mut cursor = text(b"-12 99999999999999999999 7x").start();
        assert_eq!(cursor.integer().unwrap(), -12);
        assert_eq!(cursor.integer().unwrap(), i64::MAX);
        assert!(cursor.integer().is_err());
    }

    #[test]
    fn joined_lines_are_one() {
        let joined = b"1 \\\r\n 2\n3\n";
        let mut cursor = text(joined).start();
        assert_eq!((cursor.number().unwrap(), cursor.number().unwrap()), (1.0, 2.0));
        assert!(cursor.ends_line());
        assert_eq!(line(joined, cursor.at), 2);
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
