//! Numbers as text: as short as they can be and still read back bit for bit.

use dgp_mesh::{Progress, parallel};

use crate::error::Error;

/// Elements whose text a thread prints at a time.
const BLOCK: usize = 1 << 13;

/// After how many elements the length of the text is guessed.
const SAMPLE: usize = 64;

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
        let mut digits = [0_u8; 20];
        let mut start = digits.len();
        let mut rest = x.unsigned_abs();
        while rest >= 100 {
            start -= 2;
            digits[start..start + 2].copy_from_slice(&PAIRS[(rest % 100) as usize]);
            rest /= 100;
        }
        let pair = PAIRS[rest as usize];
        if rest >= 10 {
            start -= 1;
            digits[start] = pair[1];
        }
        start -= 1;
        digits[start] = pair[usize::from(rest < 10)];
        if x < 0 {
            self.bytes.push(b'-');
        }
        self.bytes.extend_from_slice(&digits[start..]);
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

/// The text of `len` elements in chunks, each printed by `print`, in parallel.
pub(crate) fn print_all(
    len: usize,
    print: impl Fn(&mut Printer, usize) + Sync + Send,
    progress: Progress<'_>,
) -> Result<Vec<Vec<u8>>, Error> {
    let chunks = parallel::map_blocks(len, BLOCK, |range| {
        let end = range.end;
        let mut printer = Printer::new();
        for (done, i) in range.clone().enumerate() {
            print(&mut printer, i);
            if done == SAMPLE {
                // The rest is about as long; growing step by step would copy it several times.
                let mean = printer.bytes.len() / (SAMPLE + 1) + 1;
                printer.bytes.reserve(mean * (range.len() - SAMPLE));
            }
        }
        progress.report(end as f64 / len as f64)?;
        Ok(printer.bytes)
    });
    chunks.into_iter().collect()
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
        for x in [0, 9, 10, 99, 100, 101, 999, 1000, 65_535, -7, -42, i64::MAX, i64::MIN] {
            assert_eq!(printed(|p| p.integer(x)), x.to_string());
        }
    }
}
