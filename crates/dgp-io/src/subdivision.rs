//! What the tags of a subdivision surface say: creases, corners, rims.
//!
//! ```text
//! t crease 2/1/0 4 7 2.5            sharpness 2.5 between vertices 4 and 7; a chain may have more
//! t corner 1/1/0 4 10               sharpness 10 at vertex 4
//! t interpolateboundary 1/0/0 2     what becomes of rims
//! ```
//!
//! Chains and lists have one sharpness for all, or one each.

use dgp_mesh::VertexId;

use crate::{Document, Error, SubdivisionTag};

const CREASE: &str = "crease";
const CORNER: &str = "corner";
const BOUNDARY: &str = "interpolateboundary";

/// What the tags of a document say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SubdivisionRules {
    /// Pairs of vertices with an edge between them, and how sharp it is.
    pub creases: Vec<([VertexId; 2], f64)>,
    /// Vertices, and how sharp they are.
    pub corners: Vec<(VertexId, f64)>,
    /// What becomes of rims: 0 nothing, their faces are left out; 1 smooth curves through the vertices of
    /// a single face; 2 smooth curves.
    pub boundary: Option<i64>,
    /// The names of all other tags, each once.
    pub others: Vec<String>,
}

impl Document {
    /// What its tags say. Error: [`Error::Tag`] if one names vertices that are not there or lacks numbers.
    ///
    /// ```
    /// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nt crease 3/1/0 0 1 2 2.5\n";
    /// let document = dgp_io::read_bytes(text, dgp_io::Format::Obj)?;
    /// let rules = document.subdivision_rules()?;
    /// assert_eq!((rules.creases.len(), rules.creases[1].1), (2, 2.5));
    /// # Ok::<(), dgp_io::Error>(())
    /// ```
    pub fn subdivision_rules(&self) -> Result<SubdivisionRules, Error> {
        let mut rules = SubdivisionRules::default();
        for (number, tag) in self.tags.iter().enumerate() {
            let within = |problem: String| Error::Tag { number, name: tag.name.clone(), problem };
            match tag.name.as_str() {
                CREASE => {
                    let vertices = self.tagged_vertices(tag).map_err(within)?;
                    let edges = vertices.len().saturating_sub(1);
                    let values = per_item(&tag.floats, edges, "edges").map_err(within)?;
                    let pairs = vertices.windows(2).map(|pair| [pair[0], pair[1]]);
                    rules.creases.extend(pairs.zip(values));
                }
                CORNER => {
                    let vertices = self.tagged_vertices(tag).map_err(within)?;
                    let values =
                        per_item(&tag.floats, vertices.len(), "vertices").map_err(within)?;
                    rules.corners.extend(vertices.into_iter().zip(values));
                }
                BOUNDARY => match tag.integers[..] {
                    [value @ 0..=2] => rules.boundary = Some(value),
                    _ => return Err(within("it needs one number, 0, 1 or 2".to_owned())),
                },
                other if !rules.others.iter().any(|name| name == other) => {
                    rules.others.push(other.to_owned());
                }
                _ => {}
            }
        }
        Ok(rules)
    }

    /// Puts these creases, corners and rule for rims in place of those that the tags hold; other tags stay.
    pub fn set_subdivision_rules(&mut self, rules: &SubdivisionRules) {
        self.tags.retain(|tag| ![CREASE, CORNER, BOUNDARY].contains(&tag.name.as_str()));
        let tag = |name: &str, integers: Vec<i64>, floats: Vec<f64>| SubdivisionTag {
            name: name.to_owned(),
            integers,
            floats,
            strings: Vec::new(),
        };
        let number = |v: VertexId| v.index() as i64;
        let creases = rules.creases.iter();
        self.tags.extend(creases.map(|(ends, s)| tag(CREASE, ends.map(number).to_vec(), vec![*s])));
        let corners = rules.corners.iter();
        self.tags.extend(corners.map(|(v, s)| tag(CORNER, vec![number(*v)], vec![*s])));
        self.tags.extend(rules.boundary.map(|value| tag(BOUNDARY, vec![value], Vec::new())));
    }

    fn tagged_vertices(&self, tag: &SubdivisionTag) -> Result<Vec<VertexId>, String> {
        let count = self.set.vertex_count();
        let vertex = |&i: &i64| {
            let index = usize::try_from(i).ok().filter(|&index| index < count);
            index.map(VertexId::new).ok_or_else(|| {
                format!("there is no vertex {i}: the file has {count}, which tags count from 0")
            })
        };
        tag.integers.iter().map(vertex).collect()
    }
}

/// One number each; a single one is for all.
fn per_item(floats: &[f64], count: usize, what: &str) -> Result<Vec<f64>, String> {
    match floats {
        _ if count == 0 => Err(format!("it names no {what}")),
        [single] => Ok(vec![*single; count]),
        list if list.len() == count => Ok(list.to_vec()),
        list => {
            Err(format!("it has {} numbers for {count} {what}; give one, or one each", list.len()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, read_bytes};

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

    fn rules(tags: &str) -> Result<SubdivisionRules, Error> {
        read_bytes(format!("{QUAD}{tags}").as_bytes(), Format::Obj)?.subdivision_rules()
    }

    #[test]
    fn chains_and_lists_have_one_sharpness_or_one_each() {
        let v = VertexId::new;
        let found = rules(
            "t crease 3/2/0 0 1 2 1.5 10\nt corner 2/1/0 0 3 2\nt interpolateboundary 1/0/0 1\n\
             t hole 1/0/0 0\nt hole 1/0/0 0\n",
        )
        .unwrap();
        let expected = SubdivisionRules {
            creases: vec![([v(0), v(1)], 1.5), ([v(1), v(2)], 10.0)],
            corners: vec![(v(0), 2.0), (v(3), 2.0)],
            boundary: Some(1),
            others: vec!["hole".to_owned()],
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn what_is_set_is_found_again_and_other_tags_stay() {
        let mut document = read_bytes(
            format!("{QUAD}t hole 1/0/0 0\nt corner 1/1/0 3 2\n").as_bytes(),
            Format::Obj,
        )
        .unwrap();
        let mut rules = rules("t crease 2/1/0 0 1 2.5\nt interpolateboundary 1/0/0 2\n").unwrap();
        document.set_subdivision_rules(&rules);
        rules.others.push("hole".to_owned());
        assert_eq!(document.subdivision_rules().unwrap(), rules);
    }

    #[test]
    fn bad_tags_are_named() {
        for (tags, problem) in [
            ("t crease 2/1/0 0 4 1\n", "there is no vertex 4"),
            ("t corner 1/1/0 -1 1\n", "there is no vertex -1"),
            ("t crease 1/1/0 0 1\n", "names no edges"),
            ("t crease 4/2/0 0 1 2 3 1 1\n", "2 numbers for 3 edges"),
            ("t corner 1/0/0 0\n", "0 numbers for 1 vertices"),
            ("t interpolateboundary 1/0/0 3\n", "0, 1 or 2"),
        ] {
            let error = rules(tags).unwrap_err().to_string();
            assert!(error.contains("tag 0") && error.contains(problem), "{error}");
        }
    }
}
