//! What of a result can be compared and judged whatever its type.

use std::{
    fmt::{Debug, Write},
    hash::{DefaultHasher, Hasher},
};

use dgp_mesh::Mesh;

/// A result in short.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    /// Of its text, which for numbers is exact.
    pub(crate) digest: u64,
    pub(crate) has_nan: bool,
    pub(crate) is_cancelled: bool,
    /// Why a mesh that came out is none.
    pub(crate) invalid: Option<String>,
}

impl Outcome {
    /// Of a value, or of an error.
    pub(crate) fn of(value: &impl Debug) -> Self {
        let mut reader = Reader::default();
        write!(reader, "{value:?}").expect("hashing does not fail");
        Outcome {
            digest: reader.hasher.finish(),
            has_nan: reader.has_nan,
            is_cancelled: reader.is_cancelled,
            invalid: None,
        }
    }

    /// Of a mesh and what was told about it; or of the error, after which the mesh must be one too.
    pub(crate) fn of_mesh(mesh: &Mesh, told: &impl Debug) -> Self {
        let invalid = mesh.validate().err().map(|invalid| invalid.to_string());
        Outcome { invalid, ..Outcome::of(&(mesh, told)) }
    }
}

/// Hashes text as it is written, instead of keeping it.
#[derive(Default)]
struct Reader {
    hasher: DefaultHasher,
    has_nan: bool,
    is_cancelled: bool,
}

impl Write for Reader {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.hasher.write(text.as_bytes());
        self.has_nan |= text == "NaN";
        self.is_cancelled |= text.contains("Cancelled");
        Ok(())
    }
}

#[test]
fn what_is_no_number_and_what_is_cancelled_is_seen() {
    assert!(Outcome::of(&vec![Some(1.0), Some(f64::NAN)]).has_nan);
    assert!(Outcome::of(&dgp_mesh::DVec3::new(0.0, f64::NAN, 0.0)).has_nan);
    assert!(!Outcome::of(&"NaN in a text, and 1.5").has_nan);
    assert!(Outcome::of(&dgp_mesh::Error::from(dgp_mesh::Cancelled)).is_cancelled);
    assert_ne!(Outcome::of(&0.0).digest, Outcome::of(&-0.0).digest);
}
