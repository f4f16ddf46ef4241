//! Numbers as text: as short as they can be and still read back bit for bit.

use std::{mem, ops::Range};

use dgp_mesh::Progress;

use crate::{Error, output::Output};

/// Elements whose text a thread prints at a time: some hundred kilobytes.
const BLOCK: usize = 1 << 12;

/// The decimal digits of the numbers below 100.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut i = 0;
    while i < 100 {
        pairs[i] = [b'0' + i as u8 / 10, b'0' + i as u8 % 10];
        i += 1;
    }
    pairs
};

/// A growing piece of a text file.
pub(crate) struct Printer {
    pub(crate) bytes: Vec<u8>,
    buffer: zmij::Buffer,
}

impl Printer {
    pub(crate) fn new() -> Self {
        Printer { bytes: Vec::new(), buffer: zmij::Buffer::new() }
    }

    #[inline]
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    #[inline]
    pub(crate) fn byte(&mut self, byte: u8) {
        self.bytes.push(byte);
    }

    /// A number; `nan`, `inf` and `-inf` as C prints them.
    #[inline]
    pub(crate) fn f64(&mut self, x: f64) {
        let text = if x.is_finite() { self.buffer.format_finite(x) } else { odd(x) };
        self.bytes.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
    }

    /// A number of single precision.
    #[inline]
    pub(crate) fn f32(&mut self, x: f32) {
        let text = if x.is_finite() { self.buffer.format_finite(x) } else { odd(f64::from(x)) };
        self.bytes.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
    }

    /// A number that does not look like a whole one.
    pub(crate) fn f32_with_point(&mut self, x: f32) {
        let text = if x.is_finite() { self.buffer.format_finite(x) } else { odd(f64::from(x)) };
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// A whole number.
    #[inline]
    pub(crate) fn integer(&mut self, x: i64) {
        match u32::try_from(x) {
            Ok(small) if small < 100_000_000 => self.small_integer(small),
            _ => self.bytes.extend_from_slice(x.to_string().as_bytes()),
        }
    }

    /// A whole number of at most eight digits, as nearly all are.
    #[inline]
    fn small_integer(&mut self, x: u32) {
        let len = x.checked_ilog10().unwrap_or(0) as usize + 1;
        let mut digits = [0_u8; 8];
        let (mut end, mut rest) = (len, x);
        while end >= 2 {
            digits[end - 2..end].copy_from_slice(&PAIRS[(rest % 100) as usize]);
            rest /= 100;
            end -= 2;
        }
        if end == 1 {
            digits[0] = b'0' + rest as u8;
        }
        // Eight bytes are copied faster than a number of bytes that is not known here.
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&digits);
        self.bytes.truncate(start + len);
    }

    /// Numbers with blanks between them.
    #[inline]
    pub(crate) fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for (i, x) in numbers.into_iter().enumerate() {
            if i > 0 {
                self.bytes.push(b' ');
            }
            self.f64(x);
        }
    }
}

fn odd(x: f64) -> &'static str {
    match x {
        f64::INFINITY => "inf",
        f64::NEG_INFINITY => "-inf",
        _ => "nan",
    }
}

/// Writes the text of `len` elements, each printed by `print`, in parallel.
pub(crate) fn print_all(
    output: &mut Output<'_>,
    len: usize,
    print: impl Fn(&mut Printer, usize) + Sync + Send,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let text = |range: Range<usize>, room: &mut Vec<u8>| {
        let mut printer = Printer { bytes: mem::take(room), ..Printer::new() };
        for i in range {
            print(&mut printer, i);
        }
        *room = printer.bytes;
    };
    output.blocks(len, BLOCK, text, progress)
}

/// A name on one line: what would end the line becomes a blank.
pub(crate) fn one_line(name: &str) -> String {
    name.replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(print: impl Fn(&mut Printer)) -> String {
        let mut printer = Printer::new();
        print(&mut printer);
        String::from_utf8(printer.bytes).unwrap()
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [1.0, -0.0, 0.1, 1e300, f64::NAN, f64::NEG_INFINITY];
        assert_eq!(printed(|p| p.numbers(numbers)), "1 -0 0.1 1e+300 nan -inf");
        assert_eq!(printed(|p| p.f32(0.1)), "0.1");
        let whole = [0, 9, 10, 99, 100, 101, 999, 1000, 65_535, 99_999_999, 100_000_000, -7, -42];
        for x in whole.into_iter().chain([i64::MAX, i64::MIN]) {
            assert_eq!(printed(|p| p.integer(x)), x.to_string());
        }
    }
}
