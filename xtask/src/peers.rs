//! The reference drivers: OpenMesh and CGAL behind one protocol, compiled when their sources change.
//!
//! Debian builds OpenMesh's library with its assertions on, which makes it up to five times slower.
//! Speed is therefore claimed against a build of Debian's own source with -O3 -march=native -DNDEBUG;
//! where that cannot be had, the package's library serves and every row says "package build".

use std::{
    fmt, fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use serde_json::Value;

use crate::shell::{self, Outcome};

/// How every C++ file is compiled.
const FLAGS: [&str; 5] = ["-std=c++17", "-O3", "-DNDEBUG", "-march=native", "-w"];

/// How long a driver may take: OpenMesh circles forever around some vertices that are no manifold.
const PATIENCE: Duration = Duration::from_secs(60);

/// What the drivers need beside Rust, by the names of Debian's packages.
const PACKAGES: &str = "apt-get install -y --no-install-recommends g++ libopenmesh-dev libcgal-dev \
                        libcgal-demo libeigen3-dev";

/// What the driver of CHOLMOD needs.
const CHOLMOD_PACKAGES: &str = "apt-get install -y --no-install-recommends libsuitesparse-dev \
                                libmetis-dev libopenblas-dev";

/// What the driver of OpenSubdiv needs.
const OPENSUBDIV_PACKAGES: &str = "apt-get install -y --no-install-recommends libosd-dev";

/// Which OpenMesh to link.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Whichever is there: results do not depend on it.
    Any,
    /// The optimized build, for speed.
    Optimized,
}

/// A program that follows the protocol of `xtask/reference/protocol.hpp`.
#[derive(Clone, Debug)]
pub(crate) struct Driver {
    /// The name in tables.
    pub(crate) name: String,
    program: PathBuf,
    first: Vec<String>,
    /// Whether it gets one thread instead of all there are.
    one_thread: bool,
    patience: Duration,
}

/// The compiled drivers.
pub(crate) struct Peers {
    pub(crate) openmesh: Driver,
    pub(crate) cgal: Driver,
    /// Absent where its packages are.
    pub(crate) cholmod: Option<Driver>,
    /// Absent where its package is.
    pub(crate) opensubdiv: Option<Driver>,
    /// Only for speed; absent where Python or its packages are.
    pub(crate) scipy: Option<Driver>,
}

impl Peers {
    /// Compiles both drivers unless they are up to date; an error says what to install.
    pub(crate) fn build(wanted: Wanted) -> Outcome<Peers> {
        let missing: Vec<&str> = [
            ("g++", shell::exists("g++")),
            ("libopenmesh-dev", Path::new("/usr/include/OpenMesh/Core/System/config.h").exists()),
            ("libcgal-dev", Path::new("/usr/include/CGAL/Surface_mesh.h").exists()),
            ("libeigen3-dev", Path::new("/usr/include/eigen3/Eigen/Sparse").exists()),
        ]
        .into_iter()
        .filter_map(|(name, there)| (!there).then_some(name))
        .collect();
        if !missing.is_empty() {
            let missing = missing.join(", ");
            return Err(
                format!("the reference drivers need {missing}; get them by\n  {PACKAGES}").into()
            );
        }
        let folder = shell::target("reference")?;
        let openmesh = match (wanted, optimized_openmesh(&folder)) {
            (_, Ok(library)) => library,
            (Wanted::Any, Err(_)) => Library::package(),
            (Wanted::Optimized, Err(_)) => match build_openmesh(&folder) {
                Ok(()) => optimized_openmesh(&folder)?,
                Err(error) => {
                    eprintln!(
                        "OpenMesh from Debian's source: {error}\nfalling back to the package's library"
                    );
                    Library::package()
                }
            },
        };
        let program = compile("openmesh", &folder, &openmesh.arguments)?;
        let arguments = ["-I/usr/include/eigen3", "-lgmp", "-lmpfr"].map(String::from);
        let cgal = compile("cgal", &folder, &arguments)?;
        let cholmod = match cholmod(&folder) {
            Ok(program) => Some(Driver::new("CHOLMOD", program)),
            Err(error) => {
                eprintln!("without CHOLMOD: {error}\nget it by\n  {CHOLMOD_PACKAGES}");
                None
            }
        };
        let opensubdiv = match opensubdiv(&folder) {
            Ok(program) => Some(Driver::new("OpenSubdiv", program)),
            Err(error) => {
                eprintln!("without OpenSubdiv: {error}\nget it by\n  {OPENSUBDIV_PACKAGES}");
                None
            }
        };
        // Where speed does not matter nothing is installed for it.
        let scipy = (wanted == Wanted::Optimized).then(|| scipy(&folder)).and_then(|driver| {
            driver.inspect_err(|error| eprintln!("without SciPy: {error}")).ok()
        });
        Ok(Peers {
            openmesh: Driver::new(openmesh.name, program),
            cgal: Driver::new("CGAL", cgal),
            cholmod,
            opensubdiv,
            scipy,
        })
    }
}

impl fmt::Display for Peers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let optional = [&self.cholmod, &self.opensubdiv, &self.scipy].into_iter().flatten();
        for driver in [&self.openmesh, &self.cgal].into_iter().chain(optional) {
            writeln!(f, "{}: {}", driver.name, driver.program.display())?;
        }
        Ok(())
    }
}

impl Driver {
    /// Our own driver: xtask itself.
    pub(crate) fn ours() -> Outcome<Driver> {
        let program = std::env::current_exe()?;
        Ok(Driver { first: vec!["drive".into()], ..Driver::new("dgp", program) })
    }

    fn new(name: &str, program: PathBuf) -> Driver {
        let name = name.into();
        Driver { name, program, first: Vec::new(), one_thread: false, patience: PATIENCE }
    }

    /// The same driver with one thread.
    pub(crate) fn on_one_thread(self) -> Driver {
        Driver { one_thread: true, ..self }
    }

    /// The same driver, given so much time.
    pub(crate) fn within(self, patience: Duration) -> Driver {
        Driver { patience, ..self }
    }

    /// The same driver by another name in tables.
    pub(crate) fn named(&self, name: String) -> Driver {
        Driver { name, ..self.clone() }
    }

    /// Runs one operation in a process of its own; an error holds what it wrote to standard error.
    pub(crate) fn call(&self, operation: &str, input: &Path, options: &[&str]) -> Outcome<Value> {
        let mut command = Command::new(&self.program);
        command.args(&self.first).arg(operation).arg(input).args(options);
        if self.one_thread {
            for pool in ["RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"] {
                command.env(pool, "1");
            }
        }
        let text = shell::output_within(&mut command, self.patience)?;
        serde_json::from_str(&text)
            .map_err(|error| format!("{} printed no JSON: {error}: {text}", self.name).into())
    }
}

/// The driver of SciPy, in an environment of its own with the packages that its list pins.
fn scipy(folder: &Path) -> Outcome<Driver> {
    let sources = shell::root().join("xtask/reference");
    let list = sources.join("eigsh.requirements.txt");
    let (environment, stamp) = (folder.join("scipy"), folder.join("scipy.stamp"));
    let wanted = fs::read_to_string(&list)?;
    if !fs::read_to_string(&stamp).is_ok_and(|text| text == wanted) {
        eprintln!("installing the packages of the reference driver eigsh");
        let path = environment.to_string_lossy().into_owned();
        shell::output(&mut shell::command("python3", &["-m", "venv", &path]))?;
        let mut pip = Command::new(environment.join("bin/pip"));
        shell::output(pip.args(["install", "--quiet", "--requirement"]).arg(&list))?;
        fs::write(&stamp, wanted)?;
    }
    let script = sources.join("eigsh.py").to_string_lossy().into_owned();
    let driver = Driver::new("SciPy", environment.join("bin/python"));
    Ok(Driver { first: vec![script], ..driver })
}

/// The driver of CHOLMOD.
fn cholmod(folder: &Path) -> Outcome<PathBuf> {
    let include = "/usr/include/suitesparse";
    if !Path::new(include).join("cholmod.h").exists() {
        return Err("libsuitesparse-dev is not there".into());
    }
    let arguments =
        ["-I", include, "-lcholmod", "-lmetis", "-lopenblas"].map(String::from).to_vec();
    compile("cholmod", folder, &arguments)
}

/// The driver of OpenSubdiv.
fn opensubdiv(folder: &Path) -> Outcome<PathBuf> {
    if !Path::new("/usr/include/opensubdiv/far/primvarRefiner.h").exists() {
        return Err("libosd-dev is not there".into());
    }
    compile("opensubdiv", folder, &["-losdCPU", "-fopenmp"].map(String::from))
}

/// What to link for OpenMesh.
struct Library {
    name: &'static str,
    arguments: Vec<String>,
}

impl Library {
    fn package() -> Self {
        Library {
            name: "OpenMesh (package build)",
            arguments: ["-lOpenMeshTools", "-lOpenMeshCore"].map(String::from).into(),
        }
    }
}

/// Compiles `xtask/reference/NAME.cpp`, unless neither sources nor arguments changed.
fn compile(name: &str, folder: &Path, arguments: &[String]) -> Outcome<PathBuf> {
    let sources = shell::root().join("xtask/reference");
    let source = sources.join(format!("{name}.cpp"));
    let mut hasher = DefaultHasher::new();
    fs::read(&source)?.hash(&mut hasher);
    for header in ["protocol.hpp", "holes.hpp", "mending.hpp", "spatial.hpp"] {
        fs::read(sources.join(header))?.hash(&mut hasher);
    }
    (FLAGS, arguments).hash(&mut hasher);
    let (stamp, stamp_file) = (hasher.finish().to_string(), folder.join(format!("{name}.stamp")));
    let program = folder.join(format!("{name}-driver"));
    if program.exists() && fs::read_to_string(&stamp_file).is_ok_and(|text| text == stamp) {
        return Ok(program);
    }
    eprintln!("compiling the reference driver {name}");
    let mut command = shell::command("g++", &FLAGS);
    command.arg(&source).args(arguments).arg("-o").arg(&program);
    shell::run(&mut command)?;
    fs::write(stamp_file, stamp)?;
    Ok(program)
}

/// The objects of the optimized build, if they were made.
fn optimized_openmesh(folder: &Path) -> Outcome<Library> {
    let folder = folder.join("openmesh");
    let include = fs::read_to_string(folder.join("complete"))?;
    let mut arguments = vec!["-I".into(), include];
    // Objects, not an archive: its readers and writers register themselves, and a linker drops
    // objects of an archive that nothing names.
    let mut objects: Vec<String> = fs::read_dir(&folder)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "o"))
        .map(|path| path.to_string_lossy().into_owned())
        .collect();
    objects.sort();
    arguments.append(&mut objects);
    Ok(Library { name: "OpenMesh", arguments })
}

/// Fetches Debian's source of OpenMesh with a configuration of apt of our own, and compiles its core.
fn build_openmesh(folder: &Path) -> Outcome<()> {
    eprintln!("building OpenMesh from Debian's source with {}", FLAGS.join(" "));
    let apt = folder.join("apt");
    for part in ["sources", "lists/partial", "cache/archives/partial"] {
        fs::create_dir_all(apt.join(part))?;
    }
    source_lists(&apt.join("sources"))?;
    let options = [
        "Dir::Etc::sourcelist=/dev/null".to_string(),
        format!("Dir::Etc::sourceparts={}", apt.join("sources").display()),
        format!("Dir::State::lists={}", apt.join("lists").display()),
        format!("Dir::Cache={}", apt.join("cache").display()),
        "APT::Sandbox::User=root".to_string(),
    ];
    let apt_get = |arguments: &[&str]| {
        let mut command = shell::command("apt-get", &["-qq"]);
        command.args(options.iter().flat_map(|option| ["-o", option]));
        command.args(arguments).current_dir(&apt);
        shell::output(&mut command)
    };
    apt_get(&["update"])?;
    apt_get(&["source", "--download-only", "openmesh"])?;
    let archive = found(&apt, |name| name.starts_with("openmesh_") && name.contains(".orig.tar"))?;
    let archive = archive.to_string_lossy();
    shell::output(shell::command("tar", &["-xf", &archive]).current_dir(&apt))?;
    let unpacked = found(&apt, |name| {
        name.to_lowercase().starts_with("openmesh")
            && !name.contains(".tar")
            && !name.contains(".dsc")
    })?;
    let source = unpacked.join("src");

    let objects = folder.join("openmesh");
    fs::create_dir_all(&objects)?;
    let mut core = crate::data::files(&source.join("OpenMesh/Core"), &["cc"])?;
    // The one source that decimation needs of the rest.
    core.push(source.join("OpenMesh/Tools/Decimater/Observer.cc"));
    let half = core.len().div_ceil(2);
    std::thread::scope(|scope| {
        let workers: Vec<_> = core
            .chunks(half)
            .map(|files| {
                let (source, objects) = (&source, &objects);
                scope.spawn(move || -> Result<(), String> {
                    for file in files {
                        let name = file.file_stem().expect("a source has a name").to_string_lossy();
                        let mut command = shell::command("g++", &FLAGS);
                        command.arg("-I").arg(source).arg("-c").arg(file);
                        command.arg("-o").arg(objects.join(format!("{name}.o")));
                        shell::output(&mut command).map_err(|error| error.to_string())?;
                    }
                    Ok(())
                })
            })
            .collect();
        workers.into_iter().try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })?;
    fs::write(objects.join("complete"), source.to_string_lossy().as_bytes())?;
    Ok(())
}

/// Copies the machine's Debian sources with source packages in place of binary ones.
fn source_lists(to: &Path) -> Outcome<()> {
    let mut files = vec![PathBuf::from("/etc/apt/sources.list")];
    let parts = Path::new("/etc/apt/sources.list.d");
    if parts.is_dir() {
        files.extend(crate::data::files(parts, &["list", "sources"])?);
    }
    let mut copied = 0;
    for file in files {
        let Ok(text) = fs::read_to_string(&file) else { continue };
        let sources = as_source_list(&text);
        if !sources.is_empty() {
            fs::write(to.join(file.file_name().expect("a file has a name")), sources)?;
            copied += 1;
        }
    }
    if copied == 0 { Err("apt has no Debian sources".into()) } else { Ok(()) }
}

/// The Debian entries of a list of apt, in either of its forms, for source packages.
fn as_source_list(text: &str) -> String {
    let one_line = text.lines().any(|line| line.starts_with("deb "));
    let blocks: Vec<&str> =
        if one_line { text.lines().collect() } else { text.split("\n\n").collect() };
    let debian = blocks.into_iter().filter(|block| block.contains("debian"));
    let source = debian.map(|block| match block.strip_prefix("deb ") {
        Some(rest) => format!("deb-src {rest}\n"),
        None if one_line => String::new(),
        None => block.replace("Types: deb\n", "Types: deb-src\n") + "\n\n",
    });
    source.collect()
}

/// The first entry of `folder`, by name, that `fits`.
fn found(folder: &Path, fits: impl Fn(&str) -> bool) -> Outcome<PathBuf> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.file_name().is_some_and(|name| fits(&name.to_string_lossy())))
        .collect();
    paths.sort();
    paths.into_iter().next().ok_or_else(|| format!("nothing fits in {}", folder.display()).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_apt_ask_for_sources_of_debian_only() {
        let block =
            "Types: deb\nURIs: http://a/debian\nSuites: x\n\nTypes: deb\nURIs: http://b/other\n";
        let sources = as_source_list(block);
        assert!(sources.contains("Types: deb-src\nURIs: http://a/debian"), "{sources}");
        assert!(!sources.contains("other"), "{sources}");
        let lines = "# comment on debian\ndeb http://a/debian x main\ndeb http://b/other x main\n";
        assert_eq!(as_source_list(lines), "deb-src http://a/debian x main\n");
    }
}
