//! The page that shows what the demo did.

use std::fmt::Write;

use super::chain::{Chain, Stage};

const STYLE: &str = "
body { margin: 0 auto; max-width: 72rem; padding: 2rem 1.5rem 4rem; color: #1c2430;
  font: 16px/1.5 system-ui, sans-serif; background: #fbfbfa; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { margin: 3rem 0 .3rem; font-size: 1.3rem; }
p { margin: .2rem 0 .8rem; } .strip { width: 100%; border-radius: 6px; }
.stages { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1.2rem; }
figure { margin: 0; background: #fff; border: 1px solid #e2e4e8; border-radius: 6px; overflow: hidden; }
figure img { width: 100%; display: block; } figcaption { padding: .7rem 1rem 1rem; }
figcaption b { display: block; } table { border-collapse: collapse; font-size: .85rem; width: 100%; }
td { padding: .1rem .5rem .1rem 0; vertical-align: top; } td:first-child { color: #68707c; white-space: nowrap; }
a { color: #1f5fa8; } footer { margin-top: 3rem; color: #68707c; font-size: .9rem; }";

/// The page, which refers to pictures and meshes beside it.
pub(super) fn page(chains: &[Chain]) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>dgp demo</title>\
         <style>{STYLE}</style></head><body>\n<h1>dgp demo</h1>\n\
         <p>A scan, what is wrong with it, and what became of it. Orange is the back of a face.</p>\n"
    );
    for chain in chains {
        let _ = write!(
            html,
            "<h2>{}</h2>\n<p>{}</p>\n<img class=\"strip\" src=\"{}\" alt=\"all stages\">\n\
             <div class=\"stages\">\n",
            escaped(&chain.name),
            escaped(&chain.sentence),
            chain.overview,
        );
        chain.stages.iter().for_each(|stage| push_stage(&mut html, stage));
        html += "</div>\n";
    }
    let _ = write!(
        html,
        "<footer>Written by dgp {}. The same bits come out on any number of threads; only the times \
         differ.</footer>\n</body></html>\n",
        env!("CARGO_PKG_VERSION")
    );
    html
}

fn push_stage(html: &mut String, stage: &Stage) {
    let _ = write!(
        html,
        "<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\"></a><figcaption><b>{1}</b>\
         <p>{2}</p><table>",
        stage.picture,
        escaped(&stage.title),
        escaped(&stage.sentence),
    );
    for (name, value) in &stage.facts {
        let _ = write!(html, "<tr><td>{}</td><td>{}</td></tr>", escaped(name), escaped(value));
    }
    html.push_str("</table>");
    for file in &stage.files {
        let _ = write!(html, "<a href=\"{file}\">{file}</a> ");
    }
    html.push_str("</figcaption></figure>\n");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
