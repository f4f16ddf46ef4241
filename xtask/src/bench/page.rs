//! The dashboard: one page with everything in it.

use std::fmt::Write;

use serde_json::Value;

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem; color: #1c2530; background: #fcfcfb }
h1 { font-size: 1.7rem; margin-bottom: .2rem } h2 { font-size: 1.15rem; margin-top: 2.2rem }
table { border-collapse: collapse; width: 100% } th, td { padding: .25rem .6rem; text-align: right; white-space: nowrap }
th { font-weight: 600; border-bottom: 2px solid #c9d1d9; color: #57606a } td { border-bottom: 1px solid #eaedf0; font-variant-numeric: tabular-nums }
th:first-child, td:first-child, td.text, th.text { text-align: left } td.text { white-space: normal }
.ahead { color: #116b3a; font-weight: 600 } .behind { color: #b42318; font-weight: 600 } .even { color: #7a5b00; font-weight: 600 }
.bar { display: inline-block; height: .6rem; background: #2f81c5; border-radius: 2px; vertical-align: middle } .peer { background: #c2ccd6 }
.range, dt { color: #57606a } .range { font-size: .85em } dl { display: grid; grid-template-columns: max-content auto; gap: 0 1rem } dd { margin: 0 }
";

/// The page of these results.
pub(super) fn html(results: &Value) -> String {
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>dgp benchmarks</title>\
         <style>{STYLE}</style></head><body><h1>Benchmarks</h1>\
         <p>Medians of alternating runs, each in a process of its own. A ratio is the peer's figure over \
         ours, run by run: above 1 we are ahead. Ranges are the smallest and the largest of all runs.</p>"
    );
    machine(&mut page, &results["machine"]);
    let rows: Vec<&Value> = results["rows"].as_array().into_iter().flatten().collect();
    let mut cases: Vec<&Value> = Vec::new();
    for row in &rows {
        if !cases.contains(&&row["case"]) {
            cases.push(&row["case"]);
        }
    }
    for case in cases {
        let rows: Vec<&Value> = rows.iter().filter(|row| row["case"] == *case).copied().collect();
        section(&mut page, &rows);
    }
    crates(&mut page, &results["crates"]);
    golden(&mut page, &results["golden"]);
    page + "</body></html>\n"
}

fn machine(page: &mut String, machine: &Value) {
    *page += "<dl>";
    for (name, value) in machine.as_object().into_iter().flatten() {
        let value = value.as_str().map_or_else(|| value.to_string(), str::to_string);
        let _ = write!(page, "<dt>{}</dt><dd>{}</dd>", escaped(name), escaped(&value));
    }
    *page += "</dl>";
}

/// One case on all its inputs.
fn section(page: &mut String, rows: &[&Value]) {
    let (case, what, unit) =
        (text(&rows[0]["case"]), text(&rows[0]["what"]), text(&rows[0]["unit"]));
    let _ = write!(page, "<h2 id=\"{case}\">{case}: {what}</h2>");
    let distances = if rows.iter().any(|row| row["ours"]["quality"].is_object()) {
        "<th>faces</th><th>mean</th><th>rms</th><th>largest, 10⁻⁴ of the diagonal</th>"
    } else {
        ""
    };
    let _ = write!(
        page,
        "<table><tr><th>input</th><th class=\"text\">who</th><th>{unit}</th><th class=\"text\">range</th>\
         <th>processor ms</th><th>peak MB</th><th>ratio</th><th class=\"text\">range</th><th>processor ratio</th>\
         <th class=\"text\"></th>{distances}</tr>"
    );
    for row in rows {
        let peers: Vec<&Value> = row["peers"].as_array().into_iter().flatten().collect();
        let medians = peers
            .iter()
            .copied()
            .chain([&row["ours"]])
            .filter_map(|series| series["median"].as_f64());
        let largest = medians.fold(0.0, f64::max);
        line(page, text(&row["input"]), "dgp", &row["ours"], largest);
        for peer in peers {
            line(page, "", text(&peer["name"]), peer, largest);
        }
        for failure in row["failures"].as_array().into_iter().flatten() {
            let _ = write!(
                page,
                "<tr><td></td><td class=\"text\" colspan=\"9\">no figure: {}</td></tr>",
                escaped(text(failure))
            );
        }
    }
    *page += "</table>";
}

fn line(page: &mut String, input: &str, who: &str, series: &Value, largest: f64) {
    let Some(median) = series["median"].as_f64() else { return };
    let peak = series["peak_bytes"].as_f64().map_or_else(String::new, |bytes| figure(bytes / 1e6));
    let ratio = series["ratio"].as_f64().map_or_else(String::new, |ratio| {
        let class = if ratio > 1.05 {
            "ahead"
        } else if ratio < 0.95 {
            "behind"
        } else {
            "even"
        };
        format!("<span class=\"{class}\">{ratio:.2}×</span>")
    });
    let range = |low: &str, high: &str| match (series[low].as_f64(), series[high].as_f64()) {
        (Some(low), Some(high)) => format!("{} to {}", figure(low), figure(high)),
        _ => String::new(),
    };
    let optional = |name: &str| series[name].as_f64().map_or_else(String::new, figure);
    let bar = format!(
        "<span class=\"bar{}\" style=\"width:{:.0}px\"></span>",
        if who == "dgp" { "" } else { " peer" },
        160.0 * median / largest.max(f64::MIN_POSITIVE),
    );
    let _ = write!(
        page,
        "<tr><td>{}</td><td class=\"text\">{}</td><td>{}</td><td class=\"text range\">{}</td><td>{}</td>\
         <td>{peak}</td><td>{ratio}</td><td class=\"text range\">{}</td><td>{}</td><td class=\"text\">{bar}</td>{}</tr>",
        escaped(input),
        escaped(who),
        figure(median),
        range("min", "max"),
        optional("cpu"),
        range("ratio_min", "ratio_max"),
        optional("cpu_ratio"),
        distances(&series["quality"]),
    );
}

/// The cells of what a result is like; nothing where it was not measured.
fn distances(quality: &Value) -> String {
    let cell = |name: &str| {
        let value = quality[name].as_f64().unwrap_or_default();
        format!("<td>{:.3}</td>", 1e4 * value)
    };
    match quality["faces"].as_u64() {
        Some(faces) => {
            format!("<td>{faces}</td>{}{}{}", cell("mean"), cell("rms"), cell("largest"))
        }
        None => String::new(),
    }
}

fn crates(page: &mut String, crates: &Value) {
    let Some(rows) = crates.as_array() else { return };
    *page += "<h2>What a crate costs</h2><table><tr><th>crate</th><th>dependencies</th><th>seconds to build from nothing</th></tr>";
    for row in rows {
        let seconds = row["seconds"].as_f64().unwrap_or_default();
        let _ = write!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{seconds:.1}</td></tr>",
            text(&row["crate"]),
            row["dependencies"]
        );
    }
    *page += "</table>";
}

fn golden(page: &mut String, golden: &Value) {
    let Some(rows) = golden.as_array() else { return };
    *page += "<h2>Agreement with the peers</h2><p>From the last <code>cargo xtask golden</code>. The worst difference is \
              in units of the tolerance.</p><table><tr><th>quantity</th><th class=\"text\">peer</th><th>inputs</th>\
              <th>numbers</th><th>worst</th><th>conventions</th><th>differ</th><th class=\"text\">tolerance</th></tr>";
    for row in rows {
        let _ = write!(
            page,
            "<tr><td>{}</td><td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{:.4}</td><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>",
            text(&row["quantity"]),
            text(&row["peer"]),
            row["inputs"],
            row["numbers"],
            row["worst"].as_f64().unwrap_or_default(),
            row["conventions"],
            row["differ"],
            escaped(text(&row["tolerance"])),
        );
    }
    *page += "</table>";
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Three significant digits.
fn figure(value: f64) -> String {
    let digits = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_page_shows_ratios_failures_and_no_markup_from_outside() {
        let page = html(&json!({
            "machine": {"processor": "<fast>"},
            "rows": [{
                "case": "build", "what": "x", "input": "sphere", "unit": "ms",
                "ours": {"median": 2.0}, "failures": ["CGAL: a < b"],
                "peers": [{"name": "OpenMesh", "median": 5.0, "ratio": 2.5}],
            }],
            "crates": null, "golden": null,
        }));
        assert!(page.contains("<span class=\"ahead\">2.50×</span>"));
        assert!(page.contains("CGAL: a &lt; b") && page.contains("&lt;fast&gt;"));
        assert!(!page.contains("http"), "the page needs nothing from elsewhere");
    }
}
