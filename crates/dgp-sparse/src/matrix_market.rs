//! Matrix Market: the text in which collections of matrices are kept.
//!
//! ```text
//! %%MatrixMarket matrix coordinate real symmetric
//! % rows columns entries, then row column value, counted from 1
//! 3 3 2
//! 1 1 4.0
//! 3 1 -1.0
//! ```
//!
//! - Input: the coordinate format with real, integer or pattern entries, general, symmetric or
//!   skew-symmetric.
//! - Cost: O(text).
//! - Guarantees: what is written reads back bit for bit.
//! - Reference: Boisvert, Pozo and Remington, "The Matrix Market exchange formats", 1996.

use std::fmt::Write;

use crate::{Error, MAX_ENTRIES, SparseMatrix};

/// What the first line says of the entries.
struct Header {
    /// Entries without values are ones.
    pattern: bool,
    /// The value of the mirror image of an entry is this times its own; `None` for general matrices.
    mirror: Option<f64>,
}

impl SparseMatrix {
    /// The matrix that `text` describes. Entries of one place are summed.
    pub fn from_matrix_market(text: &str) -> Result<SparseMatrix, Error> {
        let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
        let (_, first) = lines.next().unwrap_or((1, ""));
        let header = header(first)?;
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('%'));
        let (line, sizes) =
            lines.next().ok_or_else(|| wrong(1, "the line with the sizes is missing"))?;
        let sizes: Result<Vec<usize>, _> = sizes.split_ascii_whitespace().map(str::parse).collect();
        let Ok(&[rows, columns, count]) = sizes.as_deref() else {
            return Err(wrong(line, "three sizes are expected: rows, columns, entries"));
        };
        for (kind, count) in [("rows", rows), ("columns", columns), ("entries", count)] {
            if count > MAX_ENTRIES {
                return Err(Error::TooLarge { kind, count, limit: MAX_ENTRIES });
            }
        }
        // No more than the text can hold, whatever it claims: an entry takes at least four bytes.
        let mut triplets = Vec::with_capacity(count.min(text.len() / 4) * 2);
        let mut read = 0;
        let mut last = line;
        for (line, text) in lines {
            last = line;
            read += 1;
            if read > count {
                return Err(wrong(line, "there are more entries than announced"));
            }
            let (i, j, value) = entry(text, line, &header)?;
            if !(1..=rows).contains(&i) || !(1..=columns).contains(&j) {
                return Err(wrong(line, "the entry lies outside the matrix"));
            }
            let (i, j) = (i as u32 - 1, j as u32 - 1);
            triplets.push((i, j, value));
            match header.mirror {
                Some(_) if i < j => {
                    return Err(wrong(
                        line,
                        "only the lower triangle of a symmetric matrix is stored",
                    ));
                }
                Some(factor) if i > j => {
                    if j as usize >= rows || i as usize >= columns {
                        return Err(wrong(line, "a symmetric matrix must be square"));
                    }
                    triplets.push((j, i, factor * value));
                }
                _ => {}
            }
        }
        if read < count {
            return Err(wrong(last, "there are fewer entries than announced"));
        }
        SparseMatrix::from_triplets(rows, columns, &triplets)
    }

    /// The matrix as text, general and real.
    pub fn to_matrix_market(&self) -> String {
        let mut text = String::from("%%MatrixMarket matrix coordinate real general\n");
        let mut line = |values: std::fmt::Arguments<'_>| {
            text.write_fmt(values).expect("a string takes everything");
        };
        line(format_args!("{} {} {}\n", self.rows(), self.columns(), self.entries()));
        for (i, j, value) in self.triplets() {
            line(format_args!("{} {} {value:?}\n", i + 1, j + 1));
        }
        text
    }
}

fn header(line: &str) -> Result<Header, Error> {
    let words: Vec<String> = line.split_ascii_whitespace().map(str::to_ascii_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["%%matrixmarket", "matrix", "coordinate", field, symmetry] = words.as_slice() else {
        return Err(wrong(1, "expected `%%MatrixMarket matrix coordinate <field> <symmetry>`"));
    };
    let pattern = match *field {
        "real" | "integer" => false,
        "pattern" => true,
        _ => return Err(wrong(1, "entries must be real, integer or pattern")),
    };
    let mirror = match *symmetry {
        "general" => None,
        "symmetric" => Some(1.0),
        "skew-symmetric" => Some(-1.0),
        _ => return Err(wrong(1, "the matrix must be general, symmetric or skew-symmetric")),
    };
    Ok(Header { pattern, mirror })
}

/// Row and column, counted from 1, and value.
fn entry(text: &str, line: usize, header: &Header) -> Result<(usize, usize, f64), Error> {
    let problem = || wrong(line, "expected row, column and value");
    let mut words = text.split_ascii_whitespace();
    let mut index = || words.next().and_then(|word| word.parse().ok()).ok_or_else(problem);
    let (i, j) = (index()?, index()?);
    let value = match (header.pattern, words.next()) {
        (true, None) => 1.0,
        (false, Some(word)) => word.parse().map_err(|_| problem())?,
        _ => return Err(problem()),
    };
    if words.next().is_none() { Ok((i, j, value)) } else { Err(problem()) }
}

fn wrong(line: usize, problem: &'static str) -> Error {
    Error::MatrixMarket { line, problem }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_is_written_reads_back(
            entries in prop::collection::vec((0..5_u32, 0..7_u32, prop::num::f64::NORMAL), 0..20)
        ) {
            let matrix = SparseMatrix::from_triplets(5, 7, &entries).unwrap();
            prop_assert_eq!(SparseMatrix::from_matrix_market(&matrix.to_matrix_market()), Ok(matrix));
        }

        #[test]
        fn any_text_is_read_or_refused(text in ".{0,200}") {
            let _ = SparseMatrix::from_matrix_market(&text);
            let text = format!("%%MatrixMarket matrix coordinate real general\n{text}");
            let _ = SparseMatrix::from_matrix_market(&text);
        }
    }

    #[test]
    fn symmetric_matrices_get_their_other_triangle() {
        let read = |kind: &str| {
            let text = format!(
                "%%MatrixMarket Matrix coordinate {kind}\n% a comment\n\n2 2 2\n1 1 4\n2 1 -1.5e0\n"
            );
            let matrix = SparseMatrix::from_matrix_market(&text).unwrap();
            [matrix.get(0, 0), matrix.get(0, 1), matrix.get(1, 0), matrix.get(1, 1)]
        };
        assert_eq!(read("real symmetric"), [4.0, -1.5, -1.5, 0.0]);
        assert_eq!(read("real skew-symmetric"), [4.0, 1.5, -1.5, 0.0]);
        assert_eq!(read("real general"), [4.0, 0.0, -1.5, 0.0]);
        let text = "%%MatrixMarket matrix coordinate pattern symmetric\n2 2 1\n2 1\n";
        assert_eq!(SparseMatrix::from_matrix_market(text).unwrap().get(0, 1), 1.0);
    }

    #[test]
    fn mistakes_are_named_by_line() {
        let head = "%%MatrixMarket matrix coordinate real general\n";
        let line_of = |text: &str| match SparseMatrix::from_matrix_market(text) {
            Err(Error::MatrixMarket { line, .. }) => line,
            other => panic!("{other:?}"),
        };
        assert_eq!(line_of(""), 1);
        assert_eq!(line_of("%%MatrixMarket matrix array real general\n"), 1);
        assert_eq!(line_of(&format!("{head}2 2\n")), 2);
        assert_eq!(line_of(&format!("{head}2 2 1\n1 3 1.0\n")), 3);
        assert_eq!(line_of(&format!("{head}2 2 1\n1 0 1.0\n")), 3);
        assert_eq!(line_of(&format!("{head}2 2 2\n1 1 1.0\n")), 3);
        assert_eq!(line_of(&format!("{head}2 2 1\n1 1 1.0\n1 1 1.0\n")), 4);
        assert_eq!(line_of(&format!("{head}2 2 1\n1 1 one\n")), 3);
        let symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
        assert_eq!(line_of(&format!("{symmetric}2 2 1\n1 2 1.0\n")), 3);
        assert_eq!(line_of(&format!("{symmetric}3 2 1\n3 1 1.0\n")), 3);
        let huge = format!("{head}9999999999 2 1\n1 1 1.0\n");
        assert!(matches!(SparseMatrix::from_matrix_market(&huge), Err(Error::TooLarge { .. })));
    }
}
