//! A run of a command: reading, timing, progress, writing, reporting.

use std::{
    io::{IsTerminal, Read, Write},
    ops::ControlFlow,
    path::Path,
    time::{Duration, Instant},
};

use dgp::{
    io::{Document, ReadOptions, WriteOptions},
    mesh::{Mesh, Progress, strict_mesh},
};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
};

/// A bar needs no more updates than this.
const BAR_STEPS: u64 = 1000;

/// What a command has read, written and spent so far.
#[derive(Debug)]
pub(crate) struct Session<'a> {
    command: &'static str,
    common: &'a Common,
    inputs: Vec<Value>,
    output: Value,
    writes_to_stdout: bool,
    read: Duration,
    run: Duration,
    write: Duration,
    warnings: Vec<String>,
}

impl<'a> Session<'a> {
    /// A run of the command of this name.
    pub(crate) fn new(command: &'static str, common: &'a Common) -> Self {
        Session {
            command,
            common,
            inputs: Vec::new(),
            output: Value::Null,
            writes_to_stdout: false,
            read: Duration::ZERO,
            run: Duration::ZERO,
            write: Duration::ZERO,
            warnings: Vec::new(),
        }
    }

    /// Reads a mesh or a point cloud.
    pub(crate) fn read(&mut self, input: &Input) -> Result<Document, Failure> {
        let start = Instant::now();
        let (document, report) = with_bar(self.common, "reading", |progress| {
            if is_pipe(&input.path) {
                read_pipe(&input.options(), progress)
            } else {
                Ok(dgp::io::read_with(&input.path, &input.options(), progress)?)
            }
        })?;
        self.read += start.elapsed();
        self.inputs.push(json!({
            "path": input.path.to_string_lossy(),
            "format": report.format.name(),
            "vertices": document.set.vertex_count(),
            "faces": document.set.face_count(),
        }));
        for warning in &report.warnings {
            self.warn(format!("{}: {warning}", input.path.display()));
        }
        Ok(document)
    }

    /// Reads a file that is no mesh of any format; `describe` says what the report tells of it.
    pub(crate) fn read_file<T>(
        &mut self,
        path: &Path,
        parse: impl FnOnce(&[u8]) -> Result<T, Failure>,
        describe: impl FnOnce(&T) -> Value,
    ) -> Result<T, Failure> {
        let start = Instant::now();
        let bytes = std::fs::read(path)
            .map_err(|source| Failure::Text { path: path.to_owned(), source })?;
        let parsed = parse(&bytes).map_err(|failure| failure.in_file(path))?;
        self.read += start.elapsed();
        self.inputs.push(describe(&parsed));
        Ok(parsed)
    }

    /// Runs the algorithm, timed, with a progress bar.
    pub(crate) fn run<T, E: Into<Failure>>(
        &mut self,
        what: &'static str,
        work: impl FnOnce(Progress<'_>) -> Result<T, E>,
    ) -> Result<T, Failure> {
        let start = Instant::now();
        let result = with_bar(self.common, what, |progress| work(progress).map_err(Into::into));
        self.run += start.elapsed();
        result
    }

    /// Makes a mesh of what was read, or says why that is impossible and what to do.
    pub(crate) fn mesh(&mut self, input: &Input, document: &Document) -> Result<Mesh, Failure> {
        self.run("building", |progress| strict_mesh(&document.set, progress))
            .map_err(|failure| failure.in_file(&input.path))
    }

    /// Writes a mesh or a point cloud.
    pub(crate) fn write(&mut self, output: &Output, document: &Document) -> Result<(), Failure> {
        self.write_as(&output.path, &output.options(), document)
    }

    /// Writes one mesh of many. What its format cannot hold is only kept for the report.
    pub(crate) fn write_stage(&mut self, path: &Path, document: &Document) -> Result<(), Failure> {
        let start = Instant::now();
        let options = WriteOptions::default();
        let report = with_bar(self.common, "writing", |progress| {
            Ok(dgp::io::write(path, document, &options, progress)?)
        })?;
        self.write += start.elapsed();
        let losses = report.losses.iter();
        self.warnings.extend(losses.map(|loss| format!("{}: {loss}", path.display())));
        Ok(())
    }

    fn write_as(
        &mut self,
        path: &Path,
        options: &WriteOptions,
        document: &Document,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let report = with_bar(self.common, "writing", |progress| {
            if !is_pipe(path) {
                return Ok(dgp::io::write(path, document, options, progress)?);
            }
            let format = options.format.ok_or_else(|| {
                Failure::Usage("writing to standard output needs --output-format".to_owned())
            })?;
            let (bytes, report) = dgp::io::write_bytes(document, format, options, progress)?;
            print_bytes(&bytes)?;
            Ok(report)
        })?;
        self.write += start.elapsed();
        self.writes_to_stdout |= is_pipe(path);
        self.output = json!({
            "path": path.to_string_lossy(),
            "format": report.format.name(),
            "bytes": report.bytes,
            "vertices": document.set.vertex_count(),
            "faces": document.set.face_count(),
        });
        for loss in &report.losses {
            self.warn(format!("{}: {} cannot hold {loss}", path.display(), report.format));
        }
        Ok(())
    }

    /// Writes bytes that are no mesh, such as a picture, as the output of the command.
    pub(crate) fn write_bytes(
        &mut self,
        path: &Path,
        bytes: &[u8],
        described: Value,
    ) -> Result<(), Failure> {
        if is_pipe(path) {
            print_bytes(bytes)?;
            self.writes_to_stdout = true;
        } else {
            self.store(path, bytes)?;
        }
        self.output = described;
        Ok(())
    }

    /// Writes one file of many.
    pub(crate) fn store(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        let start = Instant::now();
        dgp::io::write_whole(path, bytes)?;
        self.write += start.elapsed();
        Ok(())
    }

    /// Prints a line that the user should know of, and keeps it for the report.
    pub(crate) fn warn(&mut self, line: String) {
        if !self.common.quiet {
            eprintln!("dgp: warning: {line}");
        }
        self.warnings.push(line);
    }

    /// The time spent, in words.
    pub(crate) fn spent(&self) -> String {
        let [read, run, write] = [self.read, self.run, self.write].map(|t| t.as_secs_f64());
        format!("read {read:.2} s, run {run:.2} s, write {write:.2} s")
    }

    /// The seconds spent reading, computing and writing.
    pub(crate) fn seconds(&self) -> Value {
        let [read, run, write] = [self.read, self.run, self.write].map(|t| t.as_secs_f64());
        json!({"read": read, "run": run, "write": write})
    }

    /// Prints the summary and writes the JSON report.
    pub(crate) fn finish(self, summary: &str, report: &Value) -> Result<(), Failure> {
        let json_to_stdout = self.common.json.as_deref().is_some_and(is_pipe);
        if json_to_stdout && self.writes_to_stdout {
            let message = "the mesh and the report cannot both go to standard output";
            return Err(Failure::Usage(message.to_owned()));
        }
        if !self.common.quiet && !json_to_stdout && !summary.is_empty() {
            if self.writes_to_stdout {
                eprintln!("{}", summary.trim_end());
            } else {
                print_bytes(format!("{}\n", summary.trim_end()).as_bytes())?;
            }
        }
        let Some(path) = &self.common.json else { return Ok(()) };
        let mut value = json!({
            "command": self.command,
            "version": env!("CARGO_PKG_VERSION"),
            "input": self.inputs.first().cloned().unwrap_or(Value::Null),
            "output": self.output,
            "seconds": self.seconds(),
            "warnings": self.warnings,
            "report": report,
        });
        if self.inputs.len() > 1 {
            value["inputs"] = self.inputs.into();
        }
        let text = format!("{value:#}\n");
        if is_pipe(path) {
            return print_bytes(text.as_bytes());
        }
        Ok(dgp::io::write_whole(path, text.as_bytes())?)
    }
}

/// Whether a path stands for standard input or output.
pub(crate) fn is_pipe(path: &Path) -> bool {
    path == "-"
}

fn read_pipe(
    options: &ReadOptions,
    progress: Progress<'_>,
) -> Result<(Document, dgp::io::ReadReport), Failure> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().read_to_end(&mut bytes);
    read.map_err(|source| Failure::Pipe { what: "standard input", source })?;
    let format = options.format.or_else(|| dgp::io::Format::sniff(&bytes)).ok_or_else(|| {
        Failure::Usage("standard input is of no known format; name it with --format".to_owned())
    })?;
    Ok(dgp::io::read_bytes_with(&bytes, format, progress)?)
}

/// Prints to standard output. A reader that has seen enough, as `head` does, is no failure.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Pipe { what: "standard output", source })
        }
        _ => Ok(()),
    }
}

/// Runs `work` under a progress bar, if there is a terminal to show it.
fn with_bar<T>(
    common: &Common,
    what: &'static str,
    work: impl FnOnce(Progress<'_>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    if common.quiet || !std::io::stderr().is_terminal() {
        return work(Progress::NONE);
    }
    let style = ProgressStyle::with_template("{msg:>12} [{bar:40}] {percent:>3}% {eta}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
    let bar = ProgressBar::new(BAR_STEPS).with_style(style).with_message(what);
    let report = |done: f64| {
        bar.set_position((done * BAR_STEPS as f64) as u64);
        ControlFlow::Continue(())
    };
    let result = work(Progress::new(&report));
    bar.finish_and_clear();
    result
}
