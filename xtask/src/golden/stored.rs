//! The peers' answers on small inputs, kept under tests/golden/ so that `cargo test` compares with them
//! where no peer is installed.

use std::{fs, path::PathBuf};

use dgp_mesh::{DVec3, FaceList, IndexedFaceSet};
use serde_json::{Map, Value, json};

use super::{Facts, Input};
use crate::{
    raw,
    shell::{self, Outcome},
};

fn folder() -> PathBuf {
    shell::root().join("tests/golden")
}

/// Writes input and answers, one file per input.
pub(super) fn write(input: &Input, answers: &[(&str, Facts)]) -> Outcome<()> {
    let positions: Vec<[f64; 3]> =
        input.set.positions().values().iter().map(DVec3::to_array).collect();
    let peers: Map<String, Value> =
        answers.iter().map(|(peer, facts)| ((*peer).into(), facts.to_json())).collect();
    let file = json!({
        "input": {"positions": positions, "faces": raw::faces(&input.set)},
        "peers": peers,
    });
    fs::create_dir_all(folder())?;
    fs::write(folder().join(format!("{}.json", input.name)), format!("{file}\n"))?;
    Ok(())
}

/// An input and what each peer said of it.
type Stored = (Input, Vec<(String, Facts)>);

/// What [`write()`] wrote.
#[cfg_attr(not(test), expect(dead_code, reason = "stored answers are read by tests only"))]
pub(super) fn read() -> Outcome<Vec<Stored>> {
    let mut all = Vec::new();
    for path in crate::data::files(&folder(), &["json"])? {
        let file: Value = serde_json::from_str(&fs::read_to_string(&path)?)?;
        let positions: Vec<[f64; 3]> = serde_json::from_value(file["input"]["positions"].clone())?;
        let positions: Vec<DVec3> = positions.into_iter().map(DVec3::from_array).collect();
        let faces: Vec<Vec<usize>> = serde_json::from_value(file["input"]["faces"].clone())?;
        let set = IndexedFaceSet::new(positions, FaceList::from_indices(&faces))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut answers = Vec::new();
        for (peer, facts) in file["peers"].as_object().ok_or("no peers in the file")? {
            answers.push((peer.clone(), Facts::from_json(facts)?));
        }
        all.push((Input { name, set }, answers));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::super::{Verdict, compare, facts, inputs};
    use super::*;

    #[test]
    fn our_results_agree_with_the_stored_answers_of_the_peers() {
        let mut count = 0;
        for (input, answers) in read().unwrap() {
            let mut ours = facts::ours(&input.set);
            if answers.iter().any(|(_, theirs)| theirs.columns.contains_key("distances")) {
                facts::distances(&input.set, &mut ours).unwrap();
            }
            for (peer, theirs) in answers {
                for comparison in compare(&input.set, &ours, &theirs, &peer) {
                    let differs = matches!(comparison.verdict, Verdict::Differs(_));
                    assert!(!differs, "{} {peer}: {comparison:?}", input.name);
                    count += 1;
                }
            }
        }
        assert!(count > 300, "only {count} comparisons; run `cargo xtask golden --regenerate`");
    }

    #[test]
    fn every_small_input_is_stored() {
        let stored: Vec<String> =
            read().unwrap().into_iter().map(|(input, _)| input.name).collect();
        for input in inputs::small().unwrap() {
            assert!(
                stored.contains(&input.name),
                "{}: run `cargo xtask golden --regenerate`",
                input.name
            );
        }
    }
}
