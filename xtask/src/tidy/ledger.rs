//! docs/catalogue.toml: what is claimed to be there must be there.

use std::fs;

use super::{File, Finding};
use crate::shell::{self, Outcome};

const PATH: &str = "docs/catalogue.toml";

/// The subjects of the catalogue and how many rows each has.
const SUBJECTS: [(&str, usize); 16] = [
    ("MESH", 17),
    ("PLANAR", 10),
    ("SPARSE", 6),
    ("LAP", 11),
    ("SUB", 8),
    ("REM", 8),
    ("PAR", 10),
    ("REG", 6),
    ("DEF", 8),
    ("REC", 12),
    ("FIT", 5),
    ("ANA", 5),
    ("PRN", 7),
    ("IO", 3),
    ("VIEW", 2),
    ("CLI", 1),
];

/// The rows of the ledger, in order.
pub(crate) struct Ledger {
    pub(crate) rows: Vec<Row>,
}

/// What the ledger says of one row of the catalogue.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    pub(crate) id: String,
    pub(crate) title: String,
    pub(crate) krate: String,
    pub(crate) state: String,
    pub(crate) functions: Vec<String>,
    pub(crate) tests: Vec<String>,
    pub(crate) golden: Vec<String>,
    pub(crate) bench: Vec<String>,
    pub(crate) doc: String,
    pub(crate) note: String,
    line: usize,
}

impl Ledger {
    /// Reads docs/catalogue.toml.
    pub(crate) fn read() -> Outcome<Ledger> {
        Ledger::parse(&fs::read_to_string(shell::root().join(PATH))?)
    }

    fn parse(text: &str) -> Outcome<Ledger> {
        let table: toml::Table = text.parse().map_err(|error| format!("{PATH}: {error}"))?;
        let rows =
            table.get("row").and_then(toml::Value::as_array).ok_or("no [[row]] in the ledger")?;
        let row = |value: &toml::Value| {
            let string = |key: &str| {
                value.get(key).and_then(toml::Value::as_str).unwrap_or_default().to_string()
            };
            let strings = |key: &str| -> Vec<String> {
                let list = value.get(key).and_then(toml::Value::as_array);
                let strings = list.into_iter().flatten().filter_map(toml::Value::as_str);
                strings.map(str::to_string).collect()
            };
            let id = string("id");
            let needle = format!("id = \"{id}\"");
            Row {
                line: text.lines().position(|line| line.trim() == needle).map_or(1, |i| i + 1),
                title: string("title"),
                krate: string("crate"),
                state: string("state"),
                functions: strings("functions"),
                tests: strings("tests"),
                golden: strings("golden"),
                bench: strings("bench"),
                doc: string("doc"),
                note: string("note"),
                id,
            }
        };
        Ok(Ledger { rows: rows.iter().map(row).collect() })
    }

    /// Every id once, and every claim backed by `files`.
    pub(super) fn check(&self, files: &[File]) -> Vec<Finding> {
        let mut findings = Vec::new();
        for (subject, count) in SUBJECTS {
            for id in (1..=count).map(|number| format!("{subject}-{number}")) {
                let times = self.rows.iter().filter(|row| row.id == id).count();
                if times != 1 {
                    findings.push(Finding::new(
                        PATH,
                        1,
                        format!("{id} is there {times} times; it must be once"),
                    ));
                }
            }
        }
        for row in &self.rows {
            let messages = row.check(files);
            findings.extend(
                messages
                    .into_iter()
                    .map(|message| Finding::new(PATH, row.line, format!("{}: {message}", row.id))),
            );
        }
        findings
    }
}

impl Row {
    fn check(&self, files: &[File]) -> Vec<String> {
        let mut messages = Vec::new();
        let known = SUBJECTS.iter().any(|(subject, count)| {
            let number = self.id.strip_prefix(subject).and_then(|rest| rest.strip_prefix('-'));
            number.and_then(|n| n.parse().ok()).is_some_and(|n: usize| (1..=*count).contains(&n))
        });
        if !known {
            messages.push("the catalogue has no such row; remove it".into());
        }
        match self.state.as_str() {
            "open" => return messages,
            "partial" if self.note.is_empty() => {
                messages.push("partial, but `note` does not say what is missing".into());
            }
            "done" | "partial" => {}
            state => messages.push(format!("state `{state}`: write open, partial or done")),
        }
        for (name, empty) in [
            // The command is no library: what is reachable there are its commands.
            ("functions", self.functions.is_empty() && self.krate != "dgp-cli"),
            ("tests", self.tests.is_empty()),
            ("doc", self.doc.is_empty()),
        ] {
            if empty {
                messages.push(format!("claimed {}, but `{name}` is empty", self.state));
            }
        }
        for path in &self.functions {
            messages.extend(item(path, files).err());
        }
        for test in &self.tests {
            messages.extend(self::test(test, files).err());
        }
        if !self.doc.is_empty() {
            messages.extend(self.page(files));
        }
        messages.extend(self.measured(files));
        messages
    }

    /// The page exists and speaks of each function.
    fn page(&self, files: &[File]) -> Vec<String> {
        let paths = [self.doc.clone(), format!("docs/{}", self.doc)];
        let Some(page) = files.iter().find(|file| paths.contains(&file.path)) else {
            return vec![format!("page `{}` does not exist", self.doc)];
        };
        let names = self.functions.iter().filter_map(|path| path.rsplit("::").next());
        let absent = names.filter(|name| !has_word(&page.text, name));
        absent.map(|name| format!("{} does not mention `{name}`", page.path)).collect()
    }

    /// Quantities and benchmarks have names that the commands know.
    fn measured(&self, files: &[File]) -> Vec<String> {
        let named = |folder: &str, name: &str| {
            let quoted = format!("\"{name}\"");
            files.iter().any(|file| file.path.starts_with(folder) && file.text.contains(&quoted))
        };
        let criterion = |id: &str| {
            let group = id.split('/').next().unwrap_or(id);
            let benches = files.iter().filter(|file| file.path.contains("/benches/"));
            let mut texts = benches.map(|file| &file.text);
            texts.any(|text| {
                text.contains(&format!("\"{group}\"")) || text.contains(&format!("\"{group}/"))
            })
        };
        let golden = self.golden.iter().filter(|name| !named("xtask/src/golden", name));
        let golden = golden.map(|name| format!("`cargo xtask golden` has no quantity `{name}`"));
        let bench = self.bench.iter().filter(|id| !named("xtask/src/bench", id) && !criterion(id));
        golden.chain(bench.map(|id| format!("no benchmark `{id}`"))).collect()
    }
}

/// Checks that `path`, crate first, can be written in a user's program: each module on the way is public
/// or its item exported, and the item itself is public and defined in the sources of that crate.
fn item(path: &str, files: &[File]) -> Result<(), String> {
    let mut segments = path.split("::");
    let krate = segments.next().unwrap_or_default().replace('_', "-");
    let source = format!("crates/{krate}/src/");
    let sources: Vec<&File> = files.iter().filter(|file| file.path.starts_with(&source)).collect();
    let root =
        sources.iter().find(|file| ["lib.rs", "main.rs"].contains(&&file.path[source.len()..]));
    let Some(root) = root else { return Err(format!("`{path}`: no crate {krate}")) };
    let segments: Vec<&str> = segments.collect();
    let Some((last, before)) = segments.split_last() else {
        return Err(format!("`{path}` names no item"));
    };

    let defined = |name: &str| sources.iter().any(|file| defines(&file.text, name));
    if !defined(last) {
        return Err(format!("`{path}`: {krate} has no public item `{last}`"));
    }
    let (mut at, mut folder) = (*root, source.clone());
    for (i, segment) in before.iter().enumerate() {
        if segment.starts_with(char::is_uppercase) {
            // A method: its type must be reachable here and have an implementation that defines it.
            let owner =
                |file: &&&File| implements(&file.text, segment) && defines(&file.text, last);
            let reachable = defines(&at.text, segment) || exports(&at.text, segment);
            return match (i + 1 == before.len(), reachable, sources.iter().find(owner)) {
                (true, true, Some(_)) => Ok(()),
                (_, false, _) => Err(format!("`{path}`: `{segment}` is not public there")),
                _ => Err(format!("`{path}`: no public `{last}` in an `impl {segment}`")),
            };
        }
        if !has_line(&at.text, &[&format!("pub mod {segment};"), &format!("pub mod {segment} {{")])
        {
            return Err(format!("`{path}`: module `{segment}` is not public"));
        }
        let candidates = [format!("{folder}{segment}.rs"), format!("{folder}{segment}/mod.rs")];
        if let Some(file) = sources.iter().find(|file| candidates.contains(&file.path)) {
            at = file;
            folder = format!("{folder}{segment}/");
        }
    }
    if defines(&at.text, last) || exports(&at.text, last) {
        return Ok(());
    }
    Err(format!("`{path}`: `{last}` is not exported from there"))
}

/// Whether `text` defines a public item or method of this name.
fn defines(text: &str, name: &str) -> bool {
    const KINDS: [&str; 11] = [
        "fn",
        "const fn",
        "unsafe fn",
        "struct",
        "enum",
        "trait",
        "type",
        "const",
        "static",
        "union",
        "macro",
    ];
    text.lines().map(str::trim_start).any(|line| {
        let Some(rest) = line.strip_prefix("pub ") else { return false };
        KINDS.iter().any(|kind| {
            let after = rest.strip_prefix(kind).and_then(|rest| rest.strip_prefix(' '));
            after
                .and_then(|rest| rest.strip_prefix(name))
                .is_some_and(|rest| !rest.starts_with(is_word))
        })
    })
}

/// Whether `text` exports this name by `pub use`, by itself or with all of a module.
fn exports(text: &str, name: &str) -> bool {
    text.split("pub use ").skip(1).any(|rest| {
        let statement = rest.split(';').next().unwrap_or_default();
        has_word(statement, name) || statement.ends_with("::*")
    })
}

fn implements(text: &str, name: &str) -> bool {
    text.lines().any(|line| line.starts_with("impl") && has_word(line, name))
}

fn test(path: &str, files: &[File]) -> Result<(), String> {
    let (file, name) = path.rsplit_once("::").ok_or(format!("test `{path}`: write file::name"))?;
    let found = files.iter().find(|candidate| candidate.path == file);
    let text = &found.ok_or(format!("test `{path}`: no file `{file}`"))?.text;
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let function = format!("fn {name}(");
    let at = lines.iter().position(|line| {
        line.starts_with(&function) || line.starts_with(&format!("pub {function}"))
    });
    let at = at.ok_or(format!("test `{path}`: no function `{name}` in that file"))?;
    // Attributes and comments stand between the mark and the function.
    let above = lines[..at]
        .iter()
        .rev()
        .take_while(|line| line.starts_with("#[") || line.starts_with("//"));
    if above.clone().any(|line| *line == "#[test]") {
        return Ok(());
    }
    Err(format!("test `{path}`: `{name}` is not marked #[test]"))
}

fn has_line(text: &str, lines: &[&str]) -> bool {
    text.lines().any(|line| lines.iter().any(|wanted| line.trim().starts_with(wanted)))
}

/// Whether `word` stands in `text` with no letter, digit or underscore beside it.
fn has_word(text: &str, word: &str) -> bool {
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let after = &rest[at + word.len()..];
        if !rest[..at].ends_with(is_word) && !after.starts_with(is_word) {
            return true;
        }
        rest = after;
    }
    false
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::super::file;
    use super::*;

    fn tree() -> Vec<File> {
        vec![
            file(
                "crates/dgp-mesh/src/lib.rs",
                "mod taubin;\npub mod shapes;\nmod hidden;\npub use taubin::{taubin, Taubin};\n",
            ),
            file(
                "crates/dgp-mesh/src/taubin.rs",
                "pub struct Taubin;\nimpl Taubin {\n    pub const fn new() {}\n}\npub fn taubin() {}\n",
            ),
            file("crates/dgp-mesh/src/shapes/mod.rs", "mod ball;\npub use ball::*;\n"),
            file(
                "crates/dgp-mesh/src/shapes/ball.rs",
                "pub fn icosphere() {}\npub(crate) fn inner() {}\n",
            ),
            file("crates/dgp-mesh/src/hidden.rs", "pub fn secret() {}\n"),
            file("tests/a.rs", "#[test]\n// Why.\nfn spheres_are_round() {}\nfn no_test() {}\n"),
            file("docs/book/shapes.md", "Call `icosphere(3)` or [`taubin`]. Icospheres.\n"),
            file("xtask/src/golden/quantities.rs", "\"area\""),
            file("crates/dgp-mesh/benches/mesh.rs", "\"build/sphere\""),
        ]
    }

    fn row() -> Row {
        Row {
            id: "MESH-16".into(),
            state: "done".into(),
            functions: vec!["dgp_mesh::shapes::icosphere".into(), "dgp_mesh::taubin".into()],
            tests: vec!["tests/a.rs::spheres_are_round".into()],
            golden: vec!["area".into()],
            bench: vec!["build/sphere/70k".into()],
            doc: "book/shapes.md".into(),
            ..Row::default()
        }
    }

    fn messages(row: &Row) -> Vec<String> {
        row.check(&tree())
    }

    #[test]
    fn a_claim_that_is_backed_passes() {
        assert_eq!(messages(&row()), [""; 0]);
    }

    #[test]
    fn items_must_be_public_and_reachable() {
        for path in ["dgp_mesh::shapes::icosphere", "dgp_mesh::taubin", "dgp_mesh::Taubin::new"] {
            assert_eq!(item(path, &tree()), Ok(()), "{path}");
        }
        for path in [
            "dgp_mesh::shapes::cube",
            "dgp_mesh::shapes::inner",
            "dgp_mesh::icosphere",
            "dgp_mesh::hidden::secret",
            "dgp_mesh::secret",
            "dgp_mesh::Taubin::taub",
            "dgp_mesh::Ball::new",
            "dgp_io::read",
        ] {
            assert!(item(path, &tree()).is_err(), "{path}");
        }
    }

    #[test]
    fn tests_must_exist_and_be_tests() {
        for path in ["tests/a.rs::no_test", "tests/a.rs::absent", "tests/b.rs::x", "x"] {
            assert!(test(path, &tree()).is_err(), "{path}");
        }
    }

    #[test]
    fn pages_must_exist_and_mention_each_function() {
        assert_eq!(messages(&Row { doc: "book/absent.md".into(), ..row() }).len(), 1);
        let functions = vec!["dgp_mesh::Taubin".into()];
        assert_eq!(
            messages(&Row { functions, ..row() }),
            ["docs/book/shapes.md does not mention `Taubin`"]
        );
    }

    #[test]
    fn measurements_must_exist() {
        assert_eq!(messages(&Row { golden: vec!["weight".into()], ..row() }).len(), 1);
        assert_eq!(messages(&Row { bench: vec!["other/x".into()], ..row() }).len(), 1);
    }

    #[test]
    fn claims_without_evidence_are_found() {
        let bare = Row { id: "MESH-1".into(), state: "done".into(), ..Row::default() };
        assert_eq!(messages(&bare).len(), 3);
        assert_eq!(messages(&Row { state: "partial".into(), ..row() }).len(), 1);
        assert_eq!(messages(&Row { state: "almost".into(), ..row() }).len(), 1);
        assert_eq!(messages(&Row { id: "MESH-99".into(), ..row() }).len(), 1);
        assert_eq!(
            messages(&Row { state: "open".into(), ..Row { id: "IO-1".into(), ..bare } }),
            [""; 0]
        );
    }

    #[test]
    fn every_row_of_the_catalogue_is_there_once() {
        let ledger = Ledger::parse("[[row]]\nid = \"MESH-1\"\nstate = \"open\"\n").unwrap();
        let rows: usize = SUBJECTS.iter().map(|(_, count)| count).sum();
        assert_eq!(ledger.check(&[]).len(), rows - 1);
        assert_eq!(ledger.rows[0].line, 2);
    }
}
