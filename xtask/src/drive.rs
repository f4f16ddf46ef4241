//! One operation of ours in a process of its own, by the protocol of the reference drivers, so that
//! time and memory of peers and of us are measured alike.

mod decimation;
mod holes;
mod remeshing;
mod spatial;
pub(crate) mod subdivision;

use std::{
    fs,
    hint::black_box,
    path::{Path, PathBuf},
    time::Instant,
};

use dgp_io::{Document, Encoding, WriteOptions};
use dgp_laplace::{
    laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
    smooth::{UniformOptions, uniform},
    spectral::Eigenbasis,
};
use dgp_mesh::{
    DVec3, IndexedFaceSet, Mesh, Progress, RepairOptions, VertexId, VertexSet,
    graph::{Until, dijkstra},
    measure::{NormalWeight, edge_lengths, vertex_normals},
    repair,
};
use dgp_sparse::{Cholesky, CholeskyOptions, EigenOptions};
use dgp_view::{Model, RenderOptions, Scene, render};
use serde_json::{Map, Value, json};

use crate::{raw, shell::Outcome};

/// What was asked for on the command line.
struct Call {
    operation: String,
    input: PathBuf,
    repeat: usize,
    out: PathBuf,
    scheme: String,
    levels: usize,
    /// A second mesh, to compare with.
    other: PathBuf,
}

impl Call {
    fn parse(arguments: &[String]) -> Outcome<Call> {
        let [operation, input, options @ ..] = arguments else {
            return Err("usage: drive OPERATION INPUT [--repeat N] [--out FILE] [--scheme NAME] [--levels N] [--other FILE]".into());
        };
        let mut call = Call {
            operation: operation.clone(),
            input: input.into(),
            repeat: 1,
            out: PathBuf::new(),
            scheme: String::new(),
            levels: 1,
            other: PathBuf::new(),
        };
        for pair in options.chunks(2) {
            match pair {
                [name, value] if name == "--repeat" => call.repeat = value.parse()?,
                [name, value] if name == "--out" => call.out = value.into(),
                [name, value] if name == "--other" => call.other = value.into(),
                [name, value] if name == "--scheme" => call.scheme.clone_from(value),
                [name, value] if name == "--levels" => call.levels = value.parse()?,
                _ => return Err(format!("unknown option {}", pair[0]).into()),
            }
        }
        Ok(call)
    }
}

/// Runs the operation and prints one JSON object.
pub(crate) fn run(arguments: &[String]) -> Outcome<()> {
    let call = Call::parse(arguments)?;
    let mut report = Map::new();
    perform(&call, &mut report)?;
    report.insert("peak_bytes".into(), json!(status("VmHWM:")));
    println!("{}", Value::Object(report));
    Ok(())
}

fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    match call.operation.as_str() {
        "build" => {
            let set = raw::read(&call.input)?;
            time(report, call.repeat, || built(&set))
        }
        "memory" => memory(report, &call.input),
        "rings" => {
            let mesh = built(&raw::read(&call.input)?)?;
            let sum =
                |v: VertexId| mesh.vertex_neighbors(v).map(|w| mesh.position(w)).sum::<DVec3>();
            time(report, call.repeat, || Ok(mesh.map_vertices(sum)))
        }
        "normals" => {
            let mesh = built(&raw::read(&call.input)?)?;
            time(report, call.repeat, || Ok(vertex_normals(&mesh, NormalWeight::Area)))
        }
        "laplacian" => {
            let mesh = built(&raw::read(&call.input)?)?;
            time(report, call.repeat, || Ok(cotangent_laplacian(&mesh)?))
        }
        "cholesky" => cholesky(call, report),
        operation if operation.starts_with("eigenpairs-") => eigenpairs(call, report),
        "dijkstra" => {
            let mesh = built(&raw::read(&call.input)?)?;
            let start = [VertexId::new(0)];
            time(report, call.repeat, || {
                let lengths = edge_lengths(&mesh);
                Ok(dijkstra(&mesh, &lengths, &start, Until::AllReached, Progress::NONE)?)
            })
        }
        "repair" => {
            let set = raw::read(&call.input)?;
            let options = RepairOptions::default();
            time(report, call.repeat, || Ok(repair(&set, &options, Progress::NONE)?))
        }
        "smooth" => {
            let mesh = built(&raw::read(&call.input)?)?;
            let options = UniformOptions { iterations: 10, ..UniformOptions::default() };
            time_from(
                report,
                call.repeat,
                || mesh.clone(),
                |mut mesh| {
                    let smoothed = uniform(&mut mesh, &VertexSet::new(), &options, Progress::NONE)?;
                    Ok((mesh, smoothed))
                },
            )
        }
        "render" => {
            let mesh = built(&raw::read(&call.input)?)?;
            let scene = Scene::new(Model::new(&mesh));
            let options =
                RenderOptions { width: 1200, height: 900, samples: 2, ..RenderOptions::default() };
            time(report, call.repeat, || Ok(render(&scene, &options, Progress::NONE)?))
        }
        "decimate" | "progressive" => decimation::perform(call, report),
        "remesh" | "remeshed" => remeshing::perform(call, report),
        "subdivide" | "plan-refine" | "plan" | "refine" | "stencils" => {
            subdivision::perform(call, report)
        }
        operation if holes::OPERATIONS.contains(&operation) => holes::perform(call, report),
        operation if spatial::OPERATIONS.contains(&operation) => spatial::perform(call, report),
        "read" => time(report, call.repeat, || built(&dgp_io::read(&call.input)?.set)),
        "parse" => time(report, call.repeat, || Ok(dgp_io::read(&call.input)?)),
        "write-ascii" | "write-binary" => write(call, report),
        operation => Err(format!("no operation `{operation}`").into()),
    }
}

/// As the peers do: from the half-edge mesh to the file.
fn write(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let mesh = built(&raw::read(&call.input)?)?;
    let binary = call.operation == "write-binary";
    let encoding = if binary { Encoding::LittleEndian } else { Encoding::Text };
    let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
    time(report, call.repeat, || {
        let document = Document { set: mesh.to_indexed(), ..Document::default() };
        Ok(dgp_io::write(&call.out, &document, &options, Progress::NONE)?)
    })
}

/// Order, factor and solve L + M for the graph of the mesh, M a thousandth of the identity.
fn cholesky(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let mesh = built(&raw::read(&call.input)?)?;
    let n = mesh.vertex_count();
    let matrix = uniform_laplacian(&mesh)?.plus_diagonal(&vec![1e-3; n])?;
    let rhs: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let options = CholeskyOptions::default();
    let (mut entries, mut worst) = (0, 0.0_f64);
    time(report, call.repeat, || {
        let factor = Cholesky::new(&matrix, &options, dgp_sparse::Progress::NONE)?;
        let x = factor.solve(&rhs)?;
        entries = factor.symbolic().factor_entries();
        let product = matrix.product(&x);
        worst = product.iter().zip(&rhs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Ok((factor, x))
    })?;
    report.insert("factor_entries".into(), json!(entries));
    report.insert("residual".into(), json!(worst));
    Ok(())
}

/// As many eigenpairs of the cotangent Laplacian as the operation says: `eigenpairs-100`.
fn eigenpairs(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let count = call.operation.trim_start_matches("eigenpairs-").parse()?;
    let mesh = built(&raw::read(&call.input)?)?;
    let (laplacian, masses) = (cotangent_laplacian(&mesh)?, vertex_masses(&mesh));
    let options = EigenOptions::default();
    let mut worst = 0.0_f64;
    time(report, call.repeat, || {
        let basis = Eigenbasis::new(&laplacian, &masses, count, &options, Progress::NONE)?;
        worst = basis.residuals().iter().copied().fold(0.0, f64::max);
        Ok(basis)
    })?;
    report.insert("residual".into(), json!(worst));
    Ok(())
}

fn built(set: &IndexedFaceSet) -> Outcome<Mesh> {
    Ok(Mesh::new(set)?)
}

/// Runs `run` so often and notes wall and processor milliseconds of each run. What it returns is
/// dropped outside the timed part.
fn time<T>(
    report: &mut Map<String, Value>,
    repeat: usize,
    mut run: impl FnMut() -> Outcome<T>,
) -> Outcome<()> {
    time_from(report, repeat, || (), |()| run())
}

/// The same for what changes its input, which `start` makes anew outside the timed part.
fn time_from<S, T>(
    report: &mut Map<String, Value>,
    repeat: usize,
    start: impl Fn() -> S,
    mut run: impl FnMut(S) -> Outcome<T>,
) -> Outcome<()> {
    let (mut wall, mut processor) = (Vec::new(), Vec::new());
    for _ in 0..repeat {
        let state = start();
        let (clock, cpu) = (Instant::now(), processor_ms());
        let result = black_box(run(state)?);
        wall.push(clock.elapsed().as_secs_f64() * 1e3);
        processor.push(processor_ms() - cpu);
        drop(result);
    }
    report.insert("ms".into(), json!(wall));
    report.insert("cpu_ms".into(), json!(processor));
    Ok(())
}

/// What the process holds after building beyond what it held before, and the most it held between.
fn memory(report: &mut Map<String, Value>, input: &Path) -> Outcome<()> {
    let set = raw::read(input)?;
    // The threads and their stacks, about a megabyte, are not the mesh's.
    dgp_mesh::parallel::join(|| (), || ());
    // Forgets the most so far.
    fs::write("/proc/self/clear_refs", "5")?;
    let before = status("VmRSS:");
    let mesh = black_box(built(&set)?);
    report.insert("mesh_bytes".into(), json!(status("VmRSS:") - before));
    report.insert("build_peak_bytes".into(), json!(status("VmHWM:") - before));
    drop(mesh);
    Ok(())
}

/// A figure of this process in bytes; 0 where the system does not tell.
fn status(name: &str) -> f64 {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(name));
    let kilobytes = line.and_then(|rest| rest.trim().split(' ').next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) * 1024.0
}

/// Time that processors spent on the threads of this process.
fn processor_ms() -> f64 {
    let Ok(threads) = fs::read_dir("/proc/self/task") else { return 0.0 };
    let times = threads.filter_map(|thread| {
        let text = fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    });
    times.sum::<f64>() / 1e6
}
