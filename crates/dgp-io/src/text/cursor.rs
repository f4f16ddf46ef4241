//! A place in a text that moves over words and numbers.

use super::{Text, shown};
use crate::error::{Cause, Fault};

/// Digits of which every number fits 64 bits.
const MOST_DIGITS: usize = 18;

/// A place in a text that moves over words and numbers. Blanks are all bytes up to the space that
/// do not end a line.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(crate) at: usize,
    pub(super) eol: u8,
    pub(super) joined: bool,
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
            value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
            at += 1;
        }
        if at - start > MOST_DIGITS {
            value = saturated(&self.bytes[start..at]);
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
                let word = self.word();
                Err(Fault::new(
                    start,
                    if word.is_empty() {
                        Cause::TooFewNumbers { found: 0, expected: 1 }
                    } else {
                        Cause::NotAWholeNumber { text: shown(word) }
                    },
                ))
            }
        }
    }

    /// Whether no word goes on at `at`.
    #[inline]
    fn ends_word(&self, at: usize) -> bool {
        self.bytes.get(at).is_none_or(|&byte| byte <= b' ' || byte == b'#' || byte == b'\\')
    }
}

/// The number of these digits. Beyond all counts it stays beyond: what matters is that it is out of
/// range.
#[cold]
fn saturated(digits: &[u8]) -> i64 {
    let add =
        |value: i64, digit: &u8| value.saturating_mul(10).saturating_add((digit - b'0').into());
    digits.iter().fold(0, add)
}

#[cfg(test)]
mod tests {
    use super::{super::line, *};
    use crate::Format;

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
        let mut cursor =
            text(b"-12 99999999999999999999 00000000000000000000042 999999999999999999 7x").start();
        assert_eq!(cursor.integer().unwrap(), -12);
        assert_eq!(cursor.integer().unwrap(), i64::MAX);
        assert_eq!(cursor.integer().unwrap(), 42);
        assert_eq!(cursor.integer().unwrap(), 999_999_999_999_999_999);
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
}
