//! docs/book/catalogue.md: the ledger as a table for readers.

use std::{fmt::Write, fs};

use crate::{
    shell::{self, Outcome},
    tidy::{Ledger, Row},
};

/// The page this writes.
pub(crate) const PAGE: &str = "docs/book/catalogue.md";

/// Writes the page.
pub(crate) fn write() -> Outcome<()> {
    let path = shell::root().join(PAGE);
    fs::create_dir_all(path.parent().expect("the page lies in a folder"))?;
    fs::write(path, page(&Ledger::read()?))?;
    Ok(())
}

/// Whether the page is what [`write()`] would write.
pub(crate) fn is_current() -> Outcome<bool> {
    let written = fs::read_to_string(shell::root().join(PAGE)).unwrap_or_default();
    Ok(written == page(&Ledger::read()?))
}

fn page(ledger: &Ledger) -> String {
    let count = |state: &str| ledger.rows.iter().filter(|row| row.state == state).count();
    let mut page = format!(
        "<!-- Written by `cargo xtask index` from docs/catalogue.toml. -->\n\
         # The catalogue\n\n\
         Every algorithm of the syllabus: {} rows done, {} partial, {} open. `cargo xtask tidy` checks that\n\
         each function, test and page named here exists.\n",
        count("done"),
        count("partial"),
        count("open"),
    );
    let mut subject = String::new();
    for row in &ledger.rows {
        let (name, _) = row.id.rsplit_once('-').unwrap_or((&row.id, ""));
        if subject != name {
            subject = name.to_string();
            let _ = write!(page, "\n## {name} · `{}`\n\n", row.krate);
            page += "| row | what | state | functions | tests | measured | page |\n|---|---|---|---|---|---|---|\n";
        }
        page += &line(row);
    }
    page
}

fn line(row: &Row) -> String {
    let code = |items: &[String]| {
        items.iter().map(|item| format!("`{item}`")).collect::<Vec<_>>().join(" ")
    };
    let state = match row.note.as_str() {
        "" => row.state.clone(),
        note => format!("{}: {note}", row.state),
    };
    let measured: Vec<String> = row.golden.iter().chain(&row.bench).cloned().collect();
    let doc = row.doc.trim_start_matches("docs/").trim_start_matches("book/");
    let doc = if doc.is_empty() { String::new() } else { format!("[{doc}]({doc})") };
    let cells = [
        row.id.clone(),
        row.title.clone(),
        state,
        code(&row.functions),
        code(&row.tests),
        code(&measured),
        doc,
    ];
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}
