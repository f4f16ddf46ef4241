//! What every algorithm promises, tested by name for each line of one table: on any mesh, good or bad,
//! a valid result or an error; the same bits for any number of threads; an end when it is cancelled.

mod decimations;
mod inputs;
mod laplacians;
mod layouts;
mod outcome;
mod repairs;
mod spatial;
mod subdivisions;
mod table;

use std::{
    cell::Cell,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::atomic::{AtomicUsize, Ordering},
};

use dgp_mesh::Progress;

use self::{
    inputs::{Input, large, small},
    outcome::Outcome,
    table::{Algorithm, algorithms},
};

/// Runs an algorithm; a panic names it and its input.
fn run(algorithm: &Algorithm, input: &Input, progress: Progress<'_>) -> Option<Outcome> {
    let outcome = catch_unwind(AssertUnwindSafe(|| algorithm.run(input, progress)));
    outcome.unwrap_or_else(|_| panic!("{} panics on {}", algorithm.name, input.name))
}

#[test]
fn any_input_gives_a_valid_result_or_an_error() {
    let mut failures = Vec::new();
    for input in small() {
        for algorithm in algorithms() {
            let Some(outcome) = run(&algorithm, &input, Progress::NONE) else { continue };
            let name = format!("{} on {}", algorithm.name, input.name);
            if let Some(invalid) = outcome.invalid {
                failures.push(format!("{name}: {invalid}"));
            }
            if outcome.has_nan && input.is_finite() {
                failures.push(format!("{name}: NaN"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn results_are_the_same_bits_for_any_number_of_threads() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let pools = [1, 2, 8].map(pool);
    let mut failures = Vec::new();
    for input in large() {
        for algorithm in algorithms() {
            let digests: Vec<_> = pools
                .iter()
                .map(|pool| pool.install(|| run(&algorithm, &input, Progress::NONE)))
                .map(|outcome| outcome.map(|outcome| outcome.digest))
                .collect();
            if digests.iter().any(|digest| *digest != digests[0]) {
                failures.push(format!("{} on {}", algorithm.name, input.name));
            }
        }
    }
    assert!(failures.is_empty(), "other bits on other threads:\n{}", failures.join("\n"));
}

#[test]
fn cancelling_at_any_report_ends_in_that_error() {
    /// Of the many reports of one run, so many are tried, the first and the last among them.
    const TRIED: usize = 5;
    let mut failures = Vec::new();
    for input in large() {
        for algorithm in algorithms() {
            let reports = AtomicUsize::new(0);
            let count = |_| {
                reports.fetch_add(1, Ordering::Relaxed);
                ControlFlow::Continue(())
            };
            if run(&algorithm, &input, Progress::new(&count)).is_none() {
                continue;
            }
            let reports = reports.into_inner();
            let step = (reports / TRIED).max(1);
            for stop in (0..reports).step_by(step).chain(reports.checked_sub(1)) {
                let seen = AtomicUsize::new(0);
                let cancel = |_| match seen.fetch_add(1, Ordering::Relaxed) {
                    at if at >= stop => ControlFlow::Break(()),
                    _ => ControlFlow::Continue(()),
                };
                let outcome = run(&algorithm, &input, Progress::new(&cancel));
                if !outcome.is_some_and(|outcome| outcome.is_cancelled) {
                    failures.push(format!("{} on {} at {stop}", algorithm.name, input.name));
                }
            }
        }
    }
    assert!(failures.is_empty(), "not cancelled:\n{}", failures.join("\n"));
}

#[test]
fn progress_never_falls() {
    let mut failures = Vec::new();
    // One thread: with several, reports may overtake each other.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for input in large() {
        for algorithm in algorithms() {
            let last = std::sync::Mutex::new(0.0);
            let fell = std::sync::Mutex::new(Cell::new(None));
            let watch = |done: f64| {
                let mut last = last.lock().unwrap();
                if !(done >= *last - 1e-12 && done <= 1.0 + 1e-12) {
                    fell.lock().unwrap().set(Some((*last, done)));
                }
                *last = done;
                ControlFlow::Continue(())
            };
            pool.install(|| run(&algorithm, &input, Progress::new(&watch)));
            if let Some((before, after)) = fell.into_inner().unwrap().get() {
                failures
                    .push(format!("{} on {}: {before}, then {after}", algorithm.name, input.name));
            }
        }
    }
    assert!(failures.is_empty(), "progress:\n{}", failures.join("\n"));
}
