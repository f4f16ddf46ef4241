//! The form of each file by itself.

use super::{File, Finding};

/// From here on a source file is listed.
pub(super) const LONG: usize = 400;
/// Beyond this it is a finding.
pub(super) const TOO_LONG: usize = 600;
/// The largest file in the tree, in bytes.
const LARGEST: u64 = 1 << 20;

/// Hosts that files for machines may name.
const HOSTS: [&str; 4] = ["github.com", "docs.rs", "doi.org", "json.schemastore.org"];

/// All findings in one file.
pub(super) fn check(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(size(file));
    findings.extend(unfinished(file));
    findings.extend(machine(file));
    if file.is_rust() {
        findings.extend(unwraps(file));
        findings.extend(length(file));
        findings.extend(header(file));
    }
    findings
}

fn size(file: &File) -> Option<Finding> {
    let message = || format!("{} bytes; make it in a test or under target/ instead", file.bytes);
    (file.bytes > LARGEST).then(|| Finding::new(&file.path, 1, message()))
}

/// Words that say that something is not done. They are put together here, so as not to find themselves.
const UNFINISHED: [&str; 5] = [
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("todo", "!"),
    concat!("unimplemented", "!"),
    concat!("#[ign", "ore"),
];

fn unfinished(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (line, text) in numbered(&file.text) {
        for word in UNFINISHED.iter().filter(|word| text.contains(*word)) {
            findings.push(Finding::new(
                &file.path,
                line,
                format!("`{word}`: finish it, or say what is missing in docs/"),
            ));
        }
    }
    findings
}

/// Paths and hosts that exist on one machine only.
fn machine(file: &File) -> Vec<Finding> {
    let paths = [
        concat!("/wo", "rk/"),
        concat!("/tmp", "/wt"),
        concat!("/ro", "ot/"),
        concat!("/ho", "me/"),
    ];
    let mut findings = Vec::new();
    for (line, text) in numbered(&file.text) {
        for path in paths.iter().filter(|path| text.contains(*path)) {
            findings.push(Finding::new(
                &file.path,
                line,
                format!("`{path}`: no path of one machine; make it relative"),
            ));
        }
        let for_machines =
            [".toml", ".lock", ".ci/run", ".yml"].iter().any(|end| file.path.ends_with(end));
        for host in hosts(text).filter(|host| for_machines && !HOSTS.contains(host)) {
            findings.push(Finding::new(
                &file.path,
                line,
                format!(
                    "host `{host}`: leave it out; registries come from the machine's configuration"
                ),
            ));
        }
    }
    findings
}

/// The hosts of the URLs in a line.
fn hosts(line: &str) -> impl Iterator<Item = &str> {
    line.split("://").skip(1).map(|rest| {
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || "-.:".contains(c)));
        &rest[..end.unwrap_or(rest.len())]
    })
}

/// `unwrap` in the sources of a crate, outside tests and comments.
fn unwraps(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    let in_source = file.path.starts_with("crates/") && file.path.contains("/src/");
    if !in_source || is_test_file(&file.path) {
        return findings;
    }
    let needle = concat!(".unw", "rap()");
    for (line, text) in outside_tests(&file.text) {
        if code(text).contains(needle) {
            let remedy =
                "`unwrap` outside tests: return an error, or `expect(\"why it cannot happen\")`";
            findings.push(Finding::new(&file.path, line, remedy));
        }
    }
    findings
}

fn is_test_file(path: &str) -> bool {
    path.ends_with("/tests.rs") || path.contains("/tests/") || path.ends_with("_tests.rs")
}

/// The line without its comment.
fn code(line: &str) -> &str {
    line.find("//").map_or(line, |at| &line[..at])
}

/// The lines that are not part of an item marked `#[cfg(test)]`.
fn outside_tests(text: &str) -> Vec<(usize, &str)> {
    let mut lines = Vec::new();
    let mut rest = numbered(text);
    while let Some((line, text)) = rest.next() {
        if text.trim() != "#[cfg(test)]" {
            lines.push((line, text));
            continue;
        }
        // Formatted code closes an item at the indentation it began with.
        let indentation = text.len() - text.trim_start().len();
        let Some((_, first)) = rest.find(|(_, text)| !text.trim_start().starts_with("#[")) else {
            break;
        };
        if first.trim_end().ends_with('{') {
            rest.find(|(_, text)| text.len() > indentation && text[indentation..].starts_with('}'));
        }
    }
    lines
}

fn length(file: &File) -> Option<Finding> {
    let lines = file.text.lines().count();
    let message =
        || format!("{lines} lines, more than {TOO_LONG}; make it a folder with one part a file");
    (lines > TOO_LONG).then(|| Finding::new(&file.path, lines, message()))
}

/// Each file says what it is; one that names a source has the whole form.
fn header(file: &File) -> Vec<Finding> {
    let is_header = |text: &str| text.starts_with("//!");
    let header: Vec<(usize, &str)> = numbered(&file.text)
        .take_while(|(_, text)| is_header(text) || text.starts_with("#!"))
        .collect();
    if !header.iter().any(|(_, text)| is_header(text)) {
        return vec![Finding::new(
            &file.path,
            1,
            "begin with `//!` and one sentence that says what it holds",
        )];
    }
    let field = |name: &str| header.iter().find(|(_, text)| text.contains(name));
    // A format or a table may name its source in a sentence; an algorithm names it in its list.
    let Some((line, _)) = field("- Reference:") else { return Vec::new() };
    let missing = ["- Input:", "- Cost:"].into_iter().filter(|name| field(name).is_none());
    missing
        .map(|name| {
            let message = format!("the header names its source but lacks `//! {name}`");
            Finding::new(&file.path, *line, message)
        })
        .collect()
}

fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(i, text)| (i + 1, text))
}

#[cfg(test)]
mod tests {
    use super::super::file;
    use super::*;

    const HEAD: &str = "//! A file.\n";

    fn lines(path: &str, text: &str) -> Vec<usize> {
        check(&file(path, text)).into_iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn unfinished_work_is_found_in_any_file() {
        for word in UNFINISHED {
            assert_eq!(lines("docs/a.md", &format!("fine\n{word} later")), [2], "{word}");
        }
    }

    #[test]
    fn unwrap_is_found_outside_tests_and_comments_only() {
        let text = format!(
            "{HEAD}/// `x.unwrap()`\nfn a() {{ x.unwrap() }}\n#[cfg(test)]\nmod tests {{\n    x.unwrap()\n}}\nfn b() {{\n    y.unwrap();\n}}\n"
        );
        assert_eq!(lines("crates/a/src/a.rs", &text), [3, 9]);
        assert_eq!(lines("xtask/src/a.rs", &text), [0; 0]);
        assert_eq!(lines("crates/a/src/a/tests.rs", &text), [0; 0]);
    }

    #[test]
    fn a_test_only_declaration_hides_nothing_after_it() {
        let text = format!("{HEAD}#[cfg(test)]\nmod tests;\nfn a() {{ x.unwrap() }}\n");
        assert_eq!(lines("crates/a/src/a.rs", &text), [4]);
    }

    #[test]
    fn each_source_file_has_a_header() {
        assert_eq!(lines("a.rs", "fn main() {}\n"), [1]);
        assert_eq!(lines("a.rs", HEAD), [0; 0]);
    }

    #[test]
    fn headers_that_name_a_source_have_the_whole_form() {
        assert_eq!(lines("a.rs", "//! A.\n//!\n//! - Reference: Euler 1758.\n").len(), 2);
        let whole =
            "//! A.\n//!\n//! - Input: any.\n//! - Cost: O(n).\n//! - Reference: Euler 1758.\n";
        assert_eq!(lines("a.rs", whole), [0; 0]);
    }

    #[test]
    fn long_files_and_large_files_are_found() {
        assert_eq!(lines("a.rs", &(HEAD.to_string() + &"\n".repeat(TOO_LONG))), [TOO_LONG + 1]);
        assert_eq!(lines("a.rs", &(HEAD.to_string() + &"\n".repeat(LONG))), [0; 0]);
        let large = File { path: "a.bin".into(), text: String::new(), bytes: LARGEST + 1 };
        assert_eq!(check(&large).len(), 1);
    }

    #[test]
    fn paths_and_hosts_of_one_machine_are_found() {
        assert_eq!(lines("a.md", concat!("see /ro", "ot/x")), [1]);
        assert_eq!(lines("Cargo.lock", "source = \"registry+https://mirror.local/x\""), [1]);
        assert_eq!(
            lines("Cargo.lock", "source = \"registry+https://github.com/rust-lang/x\""),
            [0; 0]
        );
    }
}
