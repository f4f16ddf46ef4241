//! What can go wrong.

use dgp_mesh::Cancelled;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

    /// The picture has no pixels, or more than fit in memory.
    #[error(
        "a picture of {width}×{height} pixels with {samples}×{samples} samples each has \
         {total} samples; there must be 1 to {limit}: make it smaller or take fewer samples"
    )]
    ImageSize {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Samples per pixel and direction.
        samples: u32,
        /// Samples in all.
        total: u64,
        /// How many there may be.
        limit: u64,
    },

    /// The picture is too small for its panels, captions and color bars.
    #[error("{panels} panels do not fit into {width}×{height} pixels: make the picture larger")]
    PanelsDoNotFit {
        /// How many panels there are.
        panels: usize,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },

    /// An option has a value outside its range.
    #[error("option `{name}` is {value}, but must be {expected}")]
    InvalidOption {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },

    /// Colors, values or vectors do not match the model they are for.
    #[error(
        "model {model} of panel {panel} has {expected} {element}s, but there are {count} {what}: \
         give one for each"
    )]
    CountMismatch {
        /// The panel, counted from 0.
        panel: usize,
        /// The model in it, counted from 0.
        model: usize,
        /// What was given.
        what: &'static str,
        /// For what kind of element.
        element: &'static str,
        /// How many were given.
        count: usize,
        /// How many there should be.
        expected: usize,
    },

    /// A model without edges of its own (a face set or points) was to show edges by their ids.
    #[error(
        "model {model} of panel {panel} has no edge ids: mark its edges by their ends instead \
         (Marked::Segments)"
    )]
    NoEdges {
        /// The panel, counted from 0.
        panel: usize,
        /// The model in it, counted from 0.
        model: usize,
    },

    /// A mark or a segment names an element the model does not have.
    #[error("model {model} of panel {panel} has {count} {element}s, but number {index} is marked")]
    ElementOutOfRange {
        /// The panel, counted from 0.
        panel: usize,
        /// The model in it, counted from 0.
        model: usize,
        /// The kind of element.
        element: &'static str,
        /// The first index out of range.
        index: usize,
        /// How many elements there are.
        count: usize,
    },

    /// There is no attribute of that name, or none whose values can be shown as colors.
    #[error("no attribute `{name}` can be shown as colors; there are: {available}")]
    NoSuchAttribute {
        /// The name asked for.
        name: String,
        /// The names there are, separated by commas.
        available: String,
    },

    /// More triangles, lines and points than can be numbered.
    #[error("{count} triangles, lines and points in one panel are more than 2³² − 2")]
    TooMany {
        /// How many there are.
        count: usize,
    },

    /// A word is none of those expected.
    #[error("`{word}` is no {what}: take {expected}")]
    UnknownName {
        /// What was given.
        word: String,
        /// What it should name.
        what: &'static str,
        /// The names there are.
        expected: &'static str,
    },
}

impl Error {
    /// The error for an option out of range.
    pub(crate) fn option(name: &'static str, value: f64, expected: &'static str) -> Self {
        Error::InvalidOption { name, value, expected }
    }
}
