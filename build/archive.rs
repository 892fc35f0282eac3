//! Description, library, documentation, licences and bill of materials → the FMU, the same bytes from the same sources.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use crate::description::{Description, Variable};
use crate::read;

use super::library::Version;
use super::{container, library};

/// Packs the FMU of a version.
pub fn pack(
    version: Version,
    fmu: &Path,
    description: &Description,
    binary: &Path,
    papers: BTreeMap<String, Vec<u8>>,
) -> Result<(), String> {
    let load = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let mut files = papers;
    let packed = match version {
        Version::Fmi2 => &description.packed,
        Version::Fmi3 => &description.fmi3.packed,
    };
    files.insert("modelDescription.xml".to_string(), packed.clone().into_bytes());
    files.insert(library::place(version)?, load(binary)?);
    files.insert(version.icon().to_string(), load(Path::new("documentation/model.png"))?);
    let page = read("documentation/index.html")?
        .replace("<!-- version -->", &crate::variable("CARGO_PKG_VERSION")?)
        .replace("<!-- variables -->", &tables(description));
    files.insert("documentation/index.html".to_string(), page.into_bytes());
    for path in super::files(Path::new("documentation/licenses"))? {
        files.insert(path.to_string_lossy().replace('\\', "/"), load(&path)?);
    }
    container::write(fmu, &files)
}

/// The variables as tables of HTML, one for each causality.
fn tables(description: &Description) -> String {
    let mut html = String::new();
    for (causality, title) in [
        ("Input", "Inputs"),
        ("Parameter", "Parameters"),
        ("CalculatedParameter", "Calculated parameters"),
        ("Output", "Outputs"),
    ] {
        // What the FMU computes has neither start value nor limits.
        let set = matches!(causality, "Input" | "Parameter");
        let columns = if set { "<th>Start</th><th>Limits</th>" } else { "" };
        let _ = writeln!(
            html,
            "<h3>{title}</h3>\n<div class=\"wide\"><table class=\"variables\">\n\
             <thead><tr><th>Name</th><th>Unit</th>{columns}<th>Meaning</th></tr></thead>\n<tbody>"
        );
        for v in description.variables.iter().filter(|v| v.causality == causality) {
            let values = if set { format!("<td>{}</td><td>{}</td>", start(v), limits(v)) } else { String::new() };
            let items: String = v
                .items
                .iter()
                .map(|item| format!("<li>{} <b>{}</b>: {}</li>", item.value, item.name, escaped(&item.description)))
                .collect();
            let items = if items.is_empty() { items } else { format!("<ul>{items}</ul>") };
            let _ = writeln!(
                html,
                "<tr><td><code>{}</code></td><td>{}</td>{values}<td>{}{items}</td></tr>",
                v.name,
                of_type(v),
                escaped(&v.description)
            );
        }
        html += "</tbody>\n</table></div>\n";
    }
    html
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn of_type(v: &Variable) -> String {
    v.unit.clone().unwrap_or_else(|| v.kind.to_string())
}

fn start(v: &Variable) -> String {
    let Some(start) = v.start else { return String::new() };
    match (v.kind, v.items.iter().find(|item| f64::from(item.value) == start)) {
        ("Boolean", _) => (start != 0.0).to_string(),
        (_, Some(item)) => item.name.clone(),
        // Six digits of a number that is none of a person's.
        _ => format!("{start:.6}").trim_end_matches('0').trim_end_matches('.').to_string(),
    }
}

fn limits(v: &Variable) -> String {
    let number = |x: f64| if x == 0.0 || (1e-4..1e6).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") };
    match (v.min, v.max) {
        (Some(min), Some(max)) if v.items.is_empty() => format!("{} … {}", number(min), number(max)),
        _ => String::new(),
    }
}
