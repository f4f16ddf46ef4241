//! Who may depend on whom.
//!
//! ```text
//! 4   dgp-cli
//! 3   dgp
//! 2   one subject each; no arrow among them
//! 1   dgp-mesh     dgp-sparse; no arrow between them
//! ```
//!
//! Crates that are not published stand beside and may use all; nobody may use them. Dependencies of
//! tests are free.

use serde_json::Value;

use super::Finding;

/// A crate of the workspace, and the crates of the workspace it needs.
struct Package {
    name: String,
    manifest: String,
    published: bool,
    library: bool,
    needs: Vec<String>,
}

/// Findings from the output of `cargo metadata`.
pub(super) fn check(metadata: &Value) -> Vec<Finding> {
    let packages = packages(metadata);
    let mut findings = Vec::new();
    for package in packages.iter().filter(|package| package.published) {
        for needed in &package.needs {
            let beside = packages.iter().any(|other| other.name == *needed && !other.published);
            let (from, to) = (row(&package.name), row(needed));
            if beside || to >= from {
                let message = format!(
                    "{} (row {from}) must not depend on {needed} (row {to}{}); take the values as an \
                     argument, or move what both need to row 1",
                    package.name,
                    if beside { ", not published" } else { "" },
                );
                findings.push(Finding::new(&package.manifest, 1, message));
            }
        }
    }
    findings
}

/// Crates that go to users, in order.
pub(super) fn published(metadata: &Value) -> Vec<String> {
    names(metadata, |package| package.published)
}

/// Published crates that are libraries, in order.
pub(super) fn libraries(metadata: &Value) -> Vec<String> {
    names(metadata, |package| package.published && package.library)
}

fn names(metadata: &Value, fits: impl Fn(&Package) -> bool) -> Vec<String> {
    let fitting = packages(metadata).into_iter().filter(fits);
    let mut names: Vec<String> = fitting.map(|package| package.name).collect();
    names.sort();
    names
}

fn row(name: &str) -> u8 {
    match name {
        "dgp-mesh" | "dgp-sparse" => 1,
        "dgp" => 3,
        "dgp-cli" => 4,
        _ => 2,
    }
}

fn packages(metadata: &Value) -> Vec<Package> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    let root = text(&metadata["workspace_root"]);
    let package = |value: &Value| Package {
        name: text(&value["name"]),
        manifest: text(&value["manifest_path"]).replace(&format!("{root}/"), ""),
        // `publish = false` is an empty list of registries.
        published: value["publish"].is_null(),
        library: list(&value["targets"]).iter().any(|target| target["kind"][0] == "lib"),
        needs: list(&value["dependencies"])
            .iter()
            .filter(|needed| !needed["path"].is_null() && needed["kind"] != "dev")
            .map(|needed| text(&needed["name"]))
            .collect(),
    };
    list(&metadata["packages"]).iter().map(package).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn metadata(needs: &[(&str, &str, Option<&str>)]) -> Value {
        let names = ["dgp-mesh", "dgp-sparse", "dgp-io", "dgp-view", "dgp", "xtask"];
        let package = |name: &str| {
            let dependencies: Vec<Value> = needs
                .iter()
                .filter(|(from, ..)| *from == name)
                .map(|(_, to, kind)| json!({"name": to, "path": "/x", "kind": kind}))
                .collect();
            let publish = (name == "xtask").then(Vec::<Value>::new);
            json!({"name": name, "publish": publish, "manifest_path": format!("/r/crates/{name}/Cargo.toml"),
                   "targets": [{"kind": ["lib"]}], "dependencies": dependencies})
        };
        json!({"workspace_root": "/r", "packages": names.map(package)})
    }

    #[test]
    fn arrows_point_down() {
        let good = metadata(&[
            ("dgp-io", "dgp-mesh", None),
            ("dgp", "dgp-io", None),
            ("dgp-io", "dgp-view", Some("dev")),
            ("xtask", "dgp", None),
        ]);
        assert_eq!(check(&good), []);
    }

    #[test]
    fn arrows_up_across_and_aside_are_found() {
        for (from, to) in [
            ("dgp-mesh", "dgp-sparse"),
            ("dgp-io", "dgp-view"),
            ("dgp-mesh", "dgp"),
            ("dgp", "xtask"),
        ] {
            let findings = check(&metadata(&[(from, to, None)]));
            assert_eq!(findings.len(), 1, "{from} → {to}");
            assert_eq!(findings[0].file, format!("crates/{from}/Cargo.toml"));
        }
    }

    #[test]
    fn crates_that_are_not_published_are_not_listed() {
        assert!(!published(&metadata(&[])).contains(&"xtask".to_string()));
        assert_eq!(libraries(&metadata(&[])).len(), 5);
    }
}
