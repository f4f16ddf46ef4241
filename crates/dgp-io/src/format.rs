//! The formats and how to tell them apart.

use std::{fmt, path::Path, str::FromStr};

use crate::Error;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: polygons, texture coordinates, normals, groups; text.
    Obj,
    /// Stanford PLY: any property of any element; text or binary.
    Ply,
    /// Stereolithography: triangles of single precision; text or binary.
    Stl,
    /// Geomview OFF: polygons, colors; text or binary.
    Off,
    /// Points, one a line.
    Xyz,
    /// Points with normals, one a line.
    Pwn,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 6] =
        [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Xyz, Format::Pwn];

    /// The format of a file with this extension.
    pub fn from_path(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().unwrap_or_default();
        Format::from_name(&extension.to_string_lossy()).map_err(|error| {
            let source = Box::new(error);
            Error::InFile { path: path.to_owned(), source }
        })
    }

    /// The format of this name, an extension in any case.
    pub fn from_name(name: &str) -> Result<Self, Error> {
        let lower = name.to_ascii_lowercase();
        let known = Format::ALL.into_iter().find(|format| format.name() == lower);
        known.ok_or_else(|| Error::UnknownFormat { name: name.to_owned() })
    }

    /// The format that `bytes` look like, if they look like any. XYZ and PWN cannot be told apart:
    /// lines of numbers are taken for XYZ.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        if crate::stl::is_binary(bytes) {
            return Some(Format::Stl);
        }
        let head = &bytes[..bytes.len().min(4096)];
        let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
        let lines = head.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
        let mut lines = lines.filter(|line| !line.is_empty() && line[0] != b'#');
        let word = lines.next()?.split(u8::is_ascii_whitespace).next()?;
        match word {
            b"ply" => Some(Format::Ply),
            b"solid" => Some(Format::Stl),
            b"v" | b"vn" | b"vt" | b"f" | b"o" | b"g" | b"mtllib" | b"usemtl" | b"s" => {
                Some(Format::Obj)
            }
            _ if crate::off::is_keyword(word) => Some(Format::Off),
            _ if fast_float2::parse::<f64, _>(word).is_ok() => Some(Format::Xyz),
            _ => None,
        }
    }

    /// The name of the format in lower case, its extension too.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Off => "off",
            Format::Xyz => "xyz",
            Format::Pwn => "pwn",
        }
    }

    /// How files of this format are written unless told otherwise.
    pub const fn default_encoding(self) -> Encoding {
        match self {
            Format::Ply | Format::Stl => Encoding::LittleEndian,
            Format::Obj | Format::Off | Format::Xyz | Format::Pwn => Encoding::Text,
        }
    }

    /// Whether files of this format can be written in this way.
    pub const fn has_encoding(self, encoding: Encoding) -> bool {
        match self {
            Format::Ply | Format::Off => true,
            Format::Stl => matches!(encoding, Encoding::Text | Encoding::LittleEndian),
            Format::Obj | Format::Xyz | Format::Pwn => matches!(encoding, Encoding::Text),
        }
    }
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Format::from_name(name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Off => "OFF",
            Format::Xyz => "XYZ",
            Format::Pwn => "PWN",
        })
    }
}

/// How numbers stand in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// As text that reads back bit for bit.
    Text,
    /// As bytes, the lowest first.
    LittleEndian,
    /// As bytes, the highest first.
    BigEndian,
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Encoding::Text => "text",
            Encoding::LittleEndian => "little endian",
            Encoding::BigEndian => "big endian",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_extensions_are_found_in_any_case() {
        assert_eq!(Format::from_path(Path::new("a/b.STL")).unwrap(), Format::Stl);
        assert!(matches!(Format::from_name("gltf"), Err(Error::UnknownFormat { .. })));
        assert!(Format::from_path(Path::new("mesh")).is_err());
    }

    #[test]
    fn contents_tell_the_format() {
        let cases: [(&[u8], Option<Format>); 6] = [
            (b"ply\nformat ascii 1.0\n", Some(Format::Ply)),
            (b"# made by hand\r\nv 0 0 0\r\n", Some(Format::Obj)),
            (b"solid box\nendsolid\n", Some(Format::Stl)),
            (b"# a comment\nCNOFF\n3 1 0\n", Some(Format::Off)),
            (b" 0.5 1 2\n", Some(Format::Xyz)),
            (b"<svg>", None),
        ];
        for (bytes, format) in cases {
            assert_eq!(Format::sniff(bytes), format, "{}", String::from_utf8_lossy(bytes));
        }
    }
}
