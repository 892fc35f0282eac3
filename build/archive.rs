//! Description, binaries, documentation, licences and bill of materials → the FMU; same sources, same bytes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::description::{Description, Variable};
use crate::fmi3::Fmi3Variable;
use crate::{UNITS, read};

use super::library::{Fmu, Version};
use super::{container, date, library, licences};

/// The attribute of modelDescription.xml before which the date is inserted.
const NEXT_TO_DATE: &str = "variableNamingConvention=";

/// The layered standard of FMUs in WebAssembly: the folder of its manifest, and the manifest. The draft gives itself no version.
const MANIFEST: (&str, &str) = (
    "extra/org.modelica.fmi-ls-wasm",
    r#"<?xml version="1.0" encoding="UTF-8"?>
<fmi-ls:fmiLayeredStandardManifest
  xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
  fmi-ls:fmi-ls-name="org.modelica.fmi-ls-wasm"
  fmi-ls:fmi-ls-version="0.1.0"
  fmi-ls:fmi-ls-description="FMI Layered Standard for WebAssembly"/>
"#,
);

/// Packs an FMU.
pub fn pack(
    fmu: Fmu,
    path: &Path,
    description: &Description,
    binaries: BTreeMap<String, Vec<u8>>,
    papers: BTreeMap<String, Vec<u8>>,
) -> Result<(), String> {
    let load = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let Fmu { version, unit, .. } = fmu;
    let mut files = papers;
    let packed = match version {
        Version::Fmi2 => &description.packed,
        Version::Fmi3 => &description.fmi3.packed,
        Version::Wasm => &of_components(&description.fmi3.packed)?,
    };
    // The GUID is not computed from the date: another commit of the same sources has the same interface.
    let dated = format!("generationDateAndTime=\"{}\" {NEXT_TO_DATE}", date::generation()?);
    files.insert("modelDescription.xml".to_string(), packed.replacen(NEXT_TO_DATE, &dated, 1).into_bytes());
    files.extend(binaries);
    files.insert("terminalsAndIcons/terminalsAndIcons.xml".to_string(), description.terminals.clone().into_bytes());
    match version {
        Version::Fmi2 => {
            files.insert("model.png".to_string(), load(Path::new("build/fmu/model.png"))?);
        }
        Version::Fmi3 => {}
        // The first name is the draft's, the second that of FMI 3.0 (fmi3LayeredStandardManifest.xsd).
        Version::Wasm => files.extend(
            ["manifest.xml", "fmi-ls-manifest.xml"]
                .map(|name| (format!("{}/{name}", MANIFEST.0), MANIFEST.1.as_bytes().to_vec())),
        ),
    }
    for format in ["png", "svg"] {
        let picture = load(&Path::new("build/fmu/model").with_extension(format))?;
        files.insert(format!("terminalsAndIcons/icon.{format}"), picture);
    }
    let page = of_version(&read(&format!("build/fmu/{}", UNITS[unit].page))?, version)?
        .replace("<!-- version -->", &crate::variable("CARGO_PKG_VERSION")?)
        .replace("<!-- variables -->", &tables(description, version));
    files.insert("documentation/index.html".to_string(), page.into_bytes());
    let linked = licences::c_library()?.map(|library| library.name);
    let foreign = licences::C_LIBRARIES.into_iter().map(|library| library.name).filter(|&name| Some(name) != linked);
    let kept = |path: &PathBuf| !foreign.clone().any(|name| path.components().any(|part| part.as_os_str() == name));
    for path in super::files(Path::new("build/fmu/licenses"))?.into_iter().filter(kept) {
        let packed =
            Path::new("documentation").join(path.strip_prefix("build/fmu").map_err(|error| error.to_string())?);
        files.insert(packed.to_string_lossy().replace('\\', "/"), load(&path)?);
    }
    container::write(path, &files)
}

/// Returns the description with a model identifier for each component: Co-Simulation keeps that of the other FMUs.
fn of_components(packed: &str) -> Result<String, String> {
    let [(co_simulation, _), (model_exchange, _)] = library::COMPONENTS;
    let element = |identifier: &str| format!("<ModelExchange modelIdentifier=\"{identifier}\"");
    let (before, after) = packed
        .split_once(&element(co_simulation))
        .ok_or_else(|| format!("modelDescription.xml of FMI 3.0 has no {}", element(co_simulation)))?;
    Ok(format!("{before}{}{after}", element(model_exchange)))
}

/// Returns the page for a version of FMI. Text between `<!-- FMI 2.0 -->` or `<!-- FMI 3.0 -->` and `<!-- end -->` belongs to one
/// of them, and the standard's functions have that version's names.
fn of_version(page: &str, version: Version) -> Result<String, String> {
    let (kept_mark, dropped_mark) = match version {
        Version::Fmi2 => ("<!-- FMI 2.0 -->", "<!-- FMI 3.0 -->"),
        Version::Fmi3 | Version::Wasm => ("<!-- FMI 3.0 -->", "<!-- FMI 2.0 -->"),
    };
    let mut parts = page.split(dropped_mark);
    let mut kept = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let (_, rest) = part.split_once("<!-- end -->").ok_or("a page in build/fmu: a part has no end")?;
        kept += rest;
    }
    let kept = kept.replace(kept_mark, "").replace("<!-- end -->", "");
    Ok(match version {
        Version::Fmi2 => kept,
        Version::Fmi3 | Version::Wasm => kept.replace("fmi2", "fmi3"),
    })
}

/// Returns the variables as HTML tables, one per causality.
fn tables(description: &Description, version: Version) -> String {
    let mut html = String::new();
    for (causality, of_fmi3, title) in [
        ("Input", &[][..], "Inputs"),
        ("Parameter", &["parameter", "structuralParameter"], "Parameters"),
        ("CalculatedParameter", &[], "Calculated parameters"),
        ("Output", &[], "Outputs"),
        ("", &["independent", "local"], "Time and event indicators"),
    ] {
        let variables = match version {
            Version::Fmi2 => &[][..],
            Version::Fmi3 | Version::Wasm => &description.fmi3.variables,
        };
        let of_fmi3_alone = variables
            .iter()
            .filter(|variable| of_fmi3.contains(&variable.causality.as_str()))
            .map(row_of_fmi3_variable);
        let rows: Vec<Row> = description
            .variables
            .iter()
            .filter(|v| v.causality == causality)
            .map(|v| row(v, version))
            .chain(of_fmi3_alone)
            .collect();
        if rows.is_empty() {
            continue;
        }
        // Computed variables have neither start values nor limits.
        let set = matches!(causality, "Input" | "Parameter");
        let columns = if set { "<th>Start</th><th>Limits</th>" } else { "" };
        let _ = writeln!(
            html,
            "<h3>{title}</h3>\n<div class=\"wide\"><table class=\"variables\">\n\
             <thead><tr><th>Name</th><th>Unit</th>{columns}<th>Meaning</th></tr></thead>\n<tbody>"
        );
        for Row { name, of_type, start, limits, meaning } in rows {
            let values = if set { format!("<td>{start}</td><td>{limits}</td>") } else { String::new() };
            let _ = writeln!(html, "<tr><td><code>{name}</code></td><td>{of_type}</td>{values}<td>{meaning}</td></tr>");
        }
        html += "</tbody>\n</table></div>\n";
    }
    html
}

/// A row of a table.
struct Row {
    name: String,
    of_type: String,
    start: String,
    limits: String,
    meaning: String,
}

fn row(v: &Variable, version: Version) -> Row {
    let items: String = v
        .items
        .iter()
        .map(|item| format!("<li>{} <b>{}</b>: {}</li>", item.value, item.name, escaped(&item.description)))
        .collect();
    let items = if items.is_empty() { items } else { format!("<ul>{items}</ul>") };
    let limits = if v.items.is_empty() { limits([v.min, v.max]) } else { String::new() };
    let of_type = match (&v.unit, version) {
        (Some(unit), _) => unit.as_str(),
        // Enumerations are Integers there.
        (None, Version::Fmi2) if v.kind == "Enumeration" => "Integer",
        (None, _) => v.kind,
    };
    Row {
        name: v.name.clone(),
        of_type: of_type.into(),
        start: start(v),
        limits,
        meaning: escaped(&v.description) + &items,
    }
}

fn row_of_fmi3_variable(variable: &Fmi3Variable) -> Row {
    let start = variable.start.map(number).unwrap_or_default();
    let of_type = variable.unit.clone().unwrap_or_default();
    Row {
        name: variable.name.clone(),
        of_type,
        start,
        limits: limits(variable.limits),
        meaning: escaped(&variable.description),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn start(v: &Variable) -> String {
    let Some(start) = v.start else { return String::new() };
    match (v.kind, v.items.iter().find(|item| f64::from(item.value) == start)) {
        ("Boolean", _) => (start != 0.0).to_string(),
        (_, Some(item)) => item.name.clone(),
        // Computed numbers get six digits.
        _ => format!("{start:.6}").trim_end_matches('0').trim_end_matches('.').to_string(),
    }
}

fn limits([min, max]: [Option<f64>; 2]) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("{} … {}", number(min), number(max)),
        (Some(_) | None, _) => String::new(),
    }
}

fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e6).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}
