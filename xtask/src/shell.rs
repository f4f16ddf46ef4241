//! Running other programs, and where things are.

use std::{
    error::Error,
    io::Read,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

/// What every command of xtask returns: its errors are read by people only.
pub(crate) type Outcome<T> = Result<T, Box<dyn Error>>;

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().expect("xtask lies in the workspace").to_path_buf()
}

/// A folder under target/, made if it is not there.
pub(crate) fn target(name: &str) -> Outcome<PathBuf> {
    let folder = root().join("target").join(name);
    std::fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// A command that runs in the root of the workspace and reads nothing.
pub(crate) fn command(program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root()).stdin(Stdio::null());
    command
}

/// A `cargo` of the toolchain that runs xtask.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    command(&std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()), arguments)
}

/// Runs `command` with its output shown; an error unless it succeeds.
pub(crate) fn run(command: &mut Command) -> Outcome<()> {
    let status =
        command.status().map_err(|error| format!("cannot run {}: {error}", line(command)))?;
    if status.success() { Ok(()) } else { Err(format!("{status}: {}", line(command)).into()) }
}

/// What `command` writes to standard output; an error with its standard error unless it succeeds.
pub(crate) fn output(command: &mut Command) -> Outcome<String> {
    let output =
        command.output().map_err(|error| format!("cannot run {}: {error}", line(command)))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    Err(format!("{}: {}\n{}", output.status, line(command), message.trim()).into())
}

/// The same, but an error also where the program takes longer than `limit`; it is then ended.
pub(crate) fn output_within(command: &mut Command, limit: Duration) -> Outcome<String> {
    let line = line(command);
    let piped = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().map_err(|error| format!("cannot run {line}: {error}"))?;
    let (mut out, mut err) = (child.stdout.take(), child.stderr.take());
    // Both pipes are emptied while it runs, so that it never waits for us.
    let outputs = std::thread::scope(|scope| -> Outcome<[String; 2]> {
        let out = scope.spawn(|| text(out.as_mut()));
        let err = scope.spawn(|| text(err.as_mut()));
        let start = Instant::now();
        while child.try_wait()?.is_none() {
            if start.elapsed() > limit {
                child.kill()?;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok([out, err].map(|reader| reader.join().unwrap_or_default()))
    })?;
    let status = child.wait()?;
    let [out, err] = outputs;
    if status.success() { Ok(out) } else { Err(format!("{status}: {line}\n{}", err.trim()).into()) }
}

fn text(pipe: Option<&mut impl Read>) -> String {
    let mut bytes = Vec::new();
    if let Some(pipe) = pipe {
        // What was read before a failure is still worth showing.
        let _ = pipe.read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Whether a program of this name can be started.
pub(crate) fn exists(program: &str) -> bool {
    command(program, &["--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}
