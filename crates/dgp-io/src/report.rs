//! What was done, what was skipped, what was lost.

use std::{borrow::Cow, fmt};

use crate::{Document, Encoding, Format, Place};

/// How to read; the default serves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The format; `None` goes by the extension of the file.
    pub format: Option<Format>,
}

/// How to write; the default serves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// The format; `None` goes by the extension of the file.
    pub format: Option<Format>,
    /// Text or binary; `None` is the format's own way: binary little endian for PLY and STL, text
    /// for the others.
    pub encoding: Option<Encoding>,
}

/// What was read.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct ReadReport {
    /// The format it was read as.
    pub format: Format,
    /// How the numbers stood in it.
    pub encoding: Encoding,
    /// How many bytes there were.
    pub bytes: usize,
    /// What was skipped, completed or odd.
    pub warnings: Vec<Warning>,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct WriteReport {
    /// The format.
    pub format: Format,
    /// How the numbers stand in it.
    pub encoding: Encoding,
    /// How many bytes were written.
    pub bytes: usize,
    /// What the format cannot hold and is therefore not in the file, or not unchanged.
    pub losses: Vec<Loss>,
}

/// Something odd in a file that did not keep it from being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it is and what was made of it.
    pub what: Cow<'static, str>,
    /// How often it occurs.
    pub count: usize,
    /// Where it occurs first.
    pub first: Place,
}

/// Something a format cannot hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// What it is and what became of it.
    pub what: Cow<'static, str>,
    /// How many elements it concerns.
    pub count: usize,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.count {
            1 => write!(f, "{}: {}", self.first, self.what),
            count => write!(f, "{}: {} ({count} times)", self.first, self.what),
        }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.what, self.count)
    }
}

/// Collects losses.
#[derive(Debug, Default)]
pub(crate) struct Losses(pub(crate) Vec<Loss>);

impl Losses {
    /// Notes that `what` concerns `count` elements, if any.
    pub(crate) fn add(&mut self, what: impl Into<Cow<'static, str>>, count: usize) {
        if count > 0 {
            self.0.push(Loss { what: what.into(), count });
        }
    }

    /// Notes a table's columns, all but those named in `kept`.
    pub(crate) fn add_columns<I: dgp_mesh::Id>(
        &mut self,
        table: &dgp_mesh::AttributeTable<I>,
        kept: &[&str],
    ) {
        for name in table.names().filter(|name| !kept.contains(name)) {
            self.add(
                format!("{} attribute `{name}` has no place in the format", I::KIND),
                table.len(),
            );
        }
    }
}

impl Losses {
    /// Notes what only OBJ and PLY files hold.
    pub(crate) fn add_extras(&mut self, document: &Document) {
        self.add_without_elements(document);
        self.add_elements(document);
    }

    /// Notes what only OBJ files hold.
    pub(crate) fn add_without_elements(&mut self, document: &Document) {
        self.add("lines have no place in the format", document.polylines.len());
        self.add("points have no place in the format", document.points.len());
        self.add("subdivision tags have no place in the format", document.tags.len());
        let libraries = document.material_libraries.len();
        self.add("material libraries have no place in the format", libraries);
    }

    /// Notes what only PLY files hold.
    pub(crate) fn add_elements(&mut self, document: &Document) {
        for element in &document.elements {
            let what = format!("element `{}` has no place in the format", element.name);
            self.add(what, element.rows.len());
        }
        self.add("notes have no place in the format", document.notes.len());
    }
}

/// How many different oddities are told apart: a file of nothing but odd lines must not cost more
/// memory than a good one.
const MOST_WARNINGS: usize = 64;

/// Collects warnings by byte, before lines are counted.
#[derive(Debug, Default)]
pub(crate) struct Oddities(Vec<(Cow<'static, str>, usize, usize)>);

impl Oddities {
    /// Notes an oddity at byte `at`.
    pub(crate) fn add(&mut self, what: impl Into<Cow<'static, str>>, at: usize) {
        self.add_many(what.into(), 1, at);
    }

    /// Notes `count` of them, the first at byte `at`.
    pub(crate) fn add_many(&mut self, what: Cow<'static, str>, count: usize, at: usize) {
        if count == 0 {
            return;
        }
        let known = self.0.iter_mut().find(|(other, ..)| *other == what);
        if let Some((_, total, _)) = known {
            *total += count;
        } else if self.0.len() < MOST_WARNINGS {
            self.0.push((what, count, at));
        } else {
            self.0[MOST_WARNINGS - 1].0 = "other odd or unknown things".into();
            self.0[MOST_WARNINGS - 1].1 += count;
        }
    }

    /// Adds those of a later part of the file.
    pub(crate) fn append(&mut self, later: Oddities) {
        for (what, count, at) in later.0 {
            self.add_many(what, count, at);
        }
    }

    /// The warnings, with `place` telling where a byte is.
    pub(crate) fn into_warnings(self, place: impl Fn(usize) -> Place) -> Vec<Warning> {
        let warning = |(what, count, at)| Warning { what, count, first: place(at) };
        self.0.into_iter().map(warning).collect()
    }
}
