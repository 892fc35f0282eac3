//! Description, library, documentation and licences → the FMU, the same bytes from the same sources.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::description::{Description, Variable};
use crate::{library, read};

/// Packs the FMU and puts it in its place at once, so that no half of one is ever there.
pub fn pack(
    fmu: &Path,
    description: &Description,
    binary: &Path,
    licences: &BTreeMap<String, Vec<u8>>,
) -> Result<(), String> {
    let load = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let mut files = BTreeMap::new();
    files.insert("modelDescription.xml".to_string(), description.packed.clone().into_bytes());
    files.insert(library::place()?, load(binary)?);
    files.insert("model.png".to_string(), load(Path::new("documentation/model.png"))?);
    let page = read("documentation/index.html")?
        .replace("<!-- SIGNS -->", &read("documentation/signs.svg")?)
        .replace("<!-- VARIABLES -->", &table(description));
    files.insert("documentation/index.html".to_string(), page.into_bytes());
    for (name, text) in licences {
        files.insert(format!("documentation/licenses/{name}"), text.clone());
    }
    let temporary = fmu.with_extension(format!("fmu.{}", std::process::id()));
    let written = write(&temporary, &files)
        .and_then(|()| std::fs::rename(&temporary, fmu).map_err(|e| format!("{}: {e}", fmu.display())));
    if written.is_err() {
        // The error that is told is the first one.
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

fn write(path: &Path, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut archive = ZipWriter::new(std::fs::File::create(path).map_err(|e| failed(&e))?);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for (name, content) in files {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        archive.start_file(name.as_str(), options.unix_permissions(mode)).map_err(|e| failed(&e))?;
        archive.write_all(content).map_err(|e| failed(&e))?;
    }
    archive.finish().map_err(|e| failed(&e))?;
    Ok(())
}

/// The variables as a table of HTML.
fn table(description: &Description) -> String {
    let mut html = String::from(
        "<table>\n<thead><tr><th>Name</th><th>Unit or type</th><th>Start</th><th>Limits</th><th>Meaning</th></tr></thead>\n",
    );
    let mut causality = "";
    for v in &description.variables {
        if v.causality != causality {
            causality = v.causality;
            let title = match causality {
                "Input" => "Inputs",
                "Parameter" => "Parameters",
                "CalculatedParameter" => "Calculated parameters",
                _ => "Outputs",
            };
            let _ = writeln!(html, "<tbody><tr><th colspan=\"5\">{title}</th></tr></tbody>");
        }
        let _ = writeln!(
            html,
            "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            v.name,
            of_type(v),
            start(v),
            limits(v),
            v.description.replace('&', "&amp;").replace('<', "&lt;"),
        );
    }
    html + "</table>"
}

fn of_type(v: &Variable) -> String {
    v.unit.clone().or_else(|| v.declared_type.clone()).unwrap_or_else(|| v.kind.to_string())
}

fn start(v: &Variable) -> String {
    let Some(start) = v.start else { return String::new() };
    match (v.kind, v.items.iter().find(|item| f64::from(item.1) == start)) {
        ("Boolean", _) => (start != 0.0).to_string(),
        (_, Some((name, value))) => format!("{name} ({value})"),
        _ => start.to_string(),
    }
}

fn limits(v: &Variable) -> String {
    if v.kind == "Enumeration" {
        return v.items.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ");
    }
    let number = |x: f64| if x == 0.0 || (1e-4..1e6).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") };
    match (v.min, v.max) {
        (Some(min), Some(max)) => format!("{} … {}", number(min), number(max)),
        _ => String::new(),
    }
}
