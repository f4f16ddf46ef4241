//! The table of all comparisons.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{Comparison, Facts, Verdict, compare::QUANTITIES};
use crate::shell::Outcome;

/// All comparisons so far.
#[derive(Default)]
pub(super) struct Table {
    rows: Vec<(String, String, Comparison)>,
}

/// What one peer says of one quantity over all inputs.
#[derive(Default)]
struct Summary {
    inputs: usize,
    compared: usize,
    left_out: usize,
    worst: f64,
    conventions: usize,
    differ: usize,
}

impl Table {
    pub(super) fn add(&mut self, input: &str, peer: &str, comparisons: Vec<Comparison>) {
        self.rows.extend(comparisons.into_iter().map(|c| (input.to_string(), peer.to_string(), c)));
    }

    /// Notes that a peer gave no answer: OpenMesh crashes or runs forever on some faces that we refuse.
    pub(super) fn silent(&mut self, input: &str, peer: &str, ours: &Facts, error: &str) {
        let verdict = match peer {
            "OpenMesh" if ours.refusal.is_some() => Verdict::Convention("no answer"),
            _ => Verdict::Differs(format!("no answer: {error}")),
        };
        self.add(input, peer, vec![Comparison::without_number("accepted", verdict)]);
    }

    fn summaries(&self) -> BTreeMap<(usize, &str), Summary> {
        let mut summaries: BTreeMap<(usize, &str), Summary> = BTreeMap::new();
        for (_, peer, comparison) in &self.rows {
            let order = QUANTITIES.iter().position(|(name, _)| *name == comparison.quantity);
            let summary = summaries.entry((order.unwrap_or(QUANTITIES.len()), peer)).or_default();
            summary.inputs += 1;
            summary.compared += comparison.compared;
            summary.left_out += comparison.left_out;
            match comparison.verdict {
                Verdict::Same => summary.worst = summary.worst.max(comparison.worst),
                Verdict::Convention(_) => summary.conventions += 1,
                Verdict::Differs(_) => summary.differ += 1,
            }
        }
        summaries
    }

    pub(super) fn print(&self) {
        println!(
            "{:22} {:9} {:>6} {:>9} {:>8} {:>9} {:>10} {:>6}  tolerance",
            "quantity", "peer", "inputs", "numbers", "left out", "worst", "convention", "differ"
        );
        for ((order, peer), summary) in self.summaries() {
            let (name, tolerance) = QUANTITIES.get(order).copied().unwrap_or(("?", "?"));
            println!(
                "{name:22} {peer:9} {:6} {:9} {:8} {:9.4} {:10} {:6}  {tolerance}",
                summary.inputs,
                summary.compared,
                summary.left_out,
                summary.worst,
                summary.conventions,
                summary.differ,
            );
        }
        println!("worst: largest difference in units of the tolerance, among those that agree");
        for line in self.differences() {
            println!("{line}");
        }
    }

    fn differences(&self) -> Vec<String> {
        let line =
            |(input, peer, comparison): &(String, String, Comparison)| match &comparison.verdict {
                Verdict::Same => None,
                Verdict::Convention(name) => {
                    Some(format!("convention `{name}`: {input}, {peer}, {}", comparison.quantity))
                }
                Verdict::Differs(how) => {
                    Some(format!("DIFFERENT: {input}, {peer}, {}: {how}", comparison.quantity))
                }
            };
        self.rows.iter().filter_map(line).collect()
    }

    /// An error if anything differs that no convention explains.
    pub(super) fn verdict(&self) -> Outcome<()> {
        let differ =
            self.rows.iter().filter(|(_, _, c)| matches!(c.verdict, Verdict::Differs(_))).count();
        match (differ, self.rows.len()) {
            (0, 0) => Err("nothing was compared".into()),
            (0, count) => {
                println!("{count} comparisons agree");
                Ok(())
            }
            (differ, count) => Err(format!("{differ} of {count} comparisons differ").into()),
        }
    }

    pub(super) fn to_json(&self) -> Value {
        let rows = self.summaries().into_iter().map(|((order, peer), summary)| {
            let (name, tolerance) = QUANTITIES.get(order).copied().unwrap_or(("?", "?"));
            json!({
                "quantity": name, "peer": peer, "tolerance": tolerance, "inputs": summary.inputs,
                "numbers": summary.compared, "left_out": summary.left_out, "worst": summary.worst,
                "conventions": summary.conventions, "differ": summary.differ,
            })
        });
        Value::Array(rows.collect())
    }
}
