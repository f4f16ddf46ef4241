//! What no compiler checks: layers, the ledger, and the form of files.
//!
//! Each finding names file and line and says what to do about it.

mod layers;
mod ledger;
mod text;

use std::{fmt, fs, path::Path};

use serde_json::Value;

use crate::{
    index,
    shell::{self, Outcome},
};

pub(crate) use ledger::{Ledger, Row};

/// Something that has to be changed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Finding {
    file: String,
    line: usize,
    /// What is wrong and what to do.
    message: String,
}

impl Finding {
    fn new(file: &str, line: usize, message: impl Into<String>) -> Self {
        Finding { file: file.into(), line, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.message)
    }
}

/// A file of the tree, with its path from the root; `text` is empty where it is no text.
#[derive(Clone, Debug)]
pub(crate) struct File {
    pub(crate) path: String,
    pub(crate) text: String,
    bytes: u64,
}

impl File {
    fn is_rust(&self) -> bool {
        Path::new(&self.path).extension().is_some_and(|e| e == "rs")
    }
}

/// Runs all checks, prints the findings, and fails if there are any.
pub(crate) fn run() -> Outcome<()> {
    let files = files()?;
    let metadata = metadata()?;
    let mut findings = layers::check(&metadata);
    findings.extend(files.iter().flat_map(text::check));
    let ledger = Ledger::read()?;
    findings.extend(ledger.check(&files));
    findings.extend(readme(&files, &layers::published(&metadata)));
    if !index::is_current()? {
        let remedy = "is not what docs/catalogue.toml says; run `cargo xtask index`";
        findings.push(Finding::new(index::PAGE, 1, remedy));
    }
    findings.sort();
    for finding in &findings {
        println!("{finding}");
    }
    for file in files.iter().filter(|file| file.is_rust()) {
        let lines = file.text.lines().count();
        if lines > text::LONG && lines <= text::TOO_LONG {
            println!(
                "note: {} has {lines} lines; past {} it must become a folder",
                file.path,
                text::TOO_LONG
            );
        }
    }
    match findings.len() {
        0 => Ok(()),
        count => Err(format!("{count} findings").into()),
    }
}

/// The names of the published library crates, in order.
pub(crate) fn libraries() -> Outcome<Vec<String>> {
    Ok(layers::libraries(&metadata()?))
}

/// The names of all published crates, in order.
pub(crate) fn published() -> Outcome<Vec<String>> {
    Ok(layers::published(&metadata()?))
}

fn metadata() -> Outcome<Value> {
    let mut command = shell::cargo(&["metadata", "--format-version", "1", "--no-deps"]);
    Ok(serde_json::from_str(&shell::output(&mut command)?)?)
}

/// All files that are committed or would be.
fn files() -> Outcome<Vec<File>> {
    let list = ["ls-files", "--cached", "--others", "--exclude-standard"];
    let list = shell::output(&mut shell::command("git", &list))?;
    let mut files = Vec::new();
    for path in list.lines() {
        let full = shell::root().join(path);
        let Ok(bytes) = fs::read(&full) else { continue };
        let text = String::from_utf8(bytes.clone()).unwrap_or_default();
        files.push(File { path: path.into(), text, bytes: bytes.len() as u64 });
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

/// The README's table names every published crate.
fn readme(files: &[File], published: &[String]) -> Vec<Finding> {
    let Some(readme) = files.iter().find(|file| file.path == "README.md") else {
        return vec![Finding::new("README.md", 1, "is missing")];
    };
    let rows: Vec<&str> = readme.text.lines().filter(|line| line.starts_with('|')).collect();
    let listed = |name: &String| rows.iter().any(|row| row.contains(&format!("`{name}`")));
    let missing = published.iter().filter(|name| !listed(name));
    missing
        .map(|name| Finding::new("README.md", 1, format!("add `{name}` to the table of crates")))
        .collect()
}

#[cfg(test)]
pub(crate) fn file(path: &str, text: &str) -> File {
    File { path: path.into(), text: text.into(), bytes: text.len() as u64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readme_lists_every_crate_in_its_table() {
        let files = [file("README.md", "`dgp-io` in text\n| `dgp-mesh` | core |\n")];
        let findings = readme(&files, &["dgp-mesh".into(), "dgp-io".into()]);
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert!(findings[0].message.contains("dgp-io"));
        assert_eq!(readme(&[], &[]).len(), 1);
    }
}
