//! Two FMUs of the same sources → one with the binaries of both; one FMU → one with some of its binaries.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::Files;

const SBOM: &str = "documentation/sbom.cdx.json";
const LICENCES: &str = "documentation/licenses/";
const INDEX: &str = "documentation/licenses/license.txt";

/// Adds the binaries of `other`. All other files must be equal, except the licences of crates that only one of the binaries
/// contains (such as crates for one kind of processor), and the bill of materials, which lists the standard library of each
/// compiler.
pub fn add(files: &mut Files, other: Files) -> Result<(), String> {
    let own = |path: &str| is_binary(path) || is_of_crate(path);
    if let Some(missing) = files.keys().find(|path| !own(path) && !other.contains_key(*path)) {
        return Err(format!("{missing} is in only one of the FMUs"));
    }
    for (path, content) in other {
        match files.get_mut(&path) {
            None if own(&path) => {
                files.insert(path, content);
            }
            None => return Err(format!("{path} is in only one of the FMUs")),
            Some(_) if is_binary(&path) => return Err(format!("both FMUs hold {path}")),
            Some(known) if path == SBOM => *known = united(known, &content).map_err(|e| format!("{path}: {e}"))?,
            Some(known) if path == INDEX => *known = listed(known, &content).map_err(|e| format!("{path}: {e}"))?,
            Some(known) if *known != content => return Err(format!("{path} differs; expected the same sources")),
            Some(_) => {}
        }
    }
    Ok(())
}

/// Removes the binaries outside these folders of `binaries`. Each folder must exist.
pub fn keep(files: &mut Files, platforms: &[&str]) -> Result<(), String> {
    let folder = |platform: &str| format!("binaries/{platform}/");
    if let Some(missing) =
        platforms.iter().find(|platform| !files.keys().any(|path| path.starts_with(&folder(platform))))
    {
        return Err(format!("no {}", folder(missing)));
    }
    files.retain(|path, _| !is_binary(path) || platforms.iter().any(|platform| path.starts_with(&folder(platform))));
    Ok(())
}

fn is_binary(path: &str) -> bool {
    path.starts_with("binaries/")
}

/// Returns true for the licence of a crate, false for the project's licences and the list.
fn is_of_crate(path: &str) -> bool {
    path.strip_prefix(LICENCES).is_some_and(|rest| rest.contains('/'))
}

/// Merges two lists of licences, sorted, below their common heading.
fn listed(one: &[u8], other: &[u8]) -> Result<Vec<u8>, String> {
    if one == other {
        return Ok(one.to_vec());
    }
    let parts = |bytes| {
        let text = std::str::from_utf8(bytes).map_err(|e| e.to_string())?;
        text.split_once("\n\n").ok_or_else(|| "expected a list below an empty line".to_string())
    };
    let ((head, one), (other_head, other)) = (parts(one)?, parts(other)?);
    if head != other_head {
        return Err("differs above its list".into());
    }
    let lines: BTreeSet<&str> = one.lines().chain(other.lines()).collect();
    let list: String = lines.into_iter().map(|line| format!("{line}\n")).collect();
    Ok(format!("{head}\n\n{list}").into_bytes())
}

/// Merges the components and dependencies of two bills.
fn united(one: &[u8], other: &[u8]) -> Result<Vec<u8>, String> {
    if one == other {
        return Ok(one.to_vec());
    }
    let parse = |bytes| serde_json::from_slice::<Value>(bytes).map_err(|e| e.to_string());
    let (mut bill, other) = (parse(one)?, parse(other)?);
    for (list, key) in [("components", "bom-ref"), ("dependencies", "ref")] {
        let entries = bill[list].as_array_mut().ok_or_else(|| format!("{list} is missing"))?;
        for entry in other[list].as_array().ok_or_else(|| format!("{list} is missing"))? {
            match entries.iter_mut().find(|known| known[key] == entry[key]) {
                None => entries.push(entry.clone()),
                Some(known) => unite_dependencies(known, entry),
            }
        }
        entries.sort_by_key(|entry| entry[key].as_str().map(str::to_owned));
    }
    serde_json::to_string_pretty(&bill).map(|text| (text + "\n").into_bytes()).map_err(|e| e.to_string())
}

fn unite_dependencies(known: &mut Value, other: &Value) {
    // Not `known["dependsOn"]`, which would insert a null if it is missing.
    let known = known.get_mut("dependsOn").and_then(Value::as_array_mut);
    if let (Some(known), Some(other)) = (known, other["dependsOn"].as_array()) {
        known.extend(other.iter().cloned());
        known.sort_by_key(|reference| reference.as_str().map(str::to_owned));
        known.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fmu(files: &[(&str, &str)]) -> Files {
        files.iter().map(|(path, content)| (path.to_string(), content.as_bytes().to_vec())).collect()
    }

    #[test]
    fn binaries_of_both_are_merged() {
        let mut files = fmu(&[("binaries/linux64/a.so", "elf"), ("modelDescription.xml", "x")]);
        add(&mut files, fmu(&[("binaries/win64/a.dll", "pe"), ("modelDescription.xml", "x")])).unwrap();
        let expected =
            [("binaries/linux64/a.so", "elf"), ("binaries/win64/a.dll", "pe"), ("modelDescription.xml", "x")];
        assert_eq!(files, fmu(&expected));
    }

    #[test]
    fn other_differences_are_refused_by_name() {
        let linux = fmu(&[("binaries/linux64/a.so", "elf"), ("modelDescription.xml", "x")]);
        for (other, expected) in [
            (fmu(&[("modelDescription.xml", "y")]), "modelDescription.xml differs"),
            (fmu(&[("binaries/win64/a.dll", "pe")]), "modelDescription.xml is in only one"),
            (fmu(&[("modelDescription.xml", "x"), ("model.png", "p")]), "model.png is in only one"),
            (linux.clone(), "both FMUs hold binaries/linux64/a.so"),
        ] {
            let error = add(&mut linux.clone(), other).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    /// Only one of the binaries contains the crate for one kind of processor.
    #[test]
    fn licences_of_both_are_kept() {
        let unit = |binary: &str, index: &str, crates: &[&str]| {
            let mut files = fmu(&[(binary, "elf"), (INDEX, index)]);
            files.extend(fmu(&crates.iter().map(|path| (*path, "text")).collect::<Vec<_>>()));
            files
        };
        let [all, x86] = ["documentation/licenses/libm-1/MIT", "documentation/licenses/safe_arch-1/MIT"];
        let mut files = unit("binaries/a/x.so", "These:\n\nlibm-1: MIT\nwide-1: MIT\n", &[all]);
        add(&mut files, unit("binaries/b/x.so", "These:\n\nlibm-1: MIT\nsafe_arch-1: MIT\n", &[all, x86])).unwrap();
        assert_eq!(files[INDEX], b"These:\n\nlibm-1: MIT\nsafe_arch-1: MIT\nwide-1: MIT\n");
        assert!(files.contains_key(all) && files.contains_key(x86));
        // In either order.
        let mut files = unit("binaries/a/x.so", "These:\n\nsafe_arch-1: MIT\n", &[all, x86]);
        add(&mut files, unit("binaries/b/x.so", "These:\n\nlibm-1: MIT\n", &[all])).unwrap();
        assert!(files.contains_key(x86));
        let error = add(&mut files, unit("binaries/c/x.so", "Others:\n\nlibm-1: MIT\n", &[all])).unwrap_err();
        assert!(error.contains("differs above its list"), "{error}");
    }

    #[test]
    fn binaries_of_other_platforms_are_left_out() {
        let mut files = fmu(&[("binaries/a-linux/a.so", "1"), ("binaries/b-linux/a.so", "2"), ("model.png", "p")]);
        let error = keep(&mut files, &["a-linux", "c-linux"]).unwrap_err();
        assert_eq!(error, "no binaries/c-linux/");
        keep(&mut files, &["a-linux"]).unwrap();
        assert_eq!(files, fmu(&[("binaries/a-linux/a.so", "1"), ("model.png", "p")]));
    }

    #[test]
    fn bills_of_two_compilers_name_both_standard_libraries() {
        let bill = |std: &str| {
            format!(
                r#"{{"components": [{{"bom-ref": "a"}}, {{"bom-ref": "{std}"}}],
                "dependencies": [{{"ref": "a", "dependsOn": ["{std}"]}}, {{"ref": "{std}", "dependsOn": []}}]}}"#
            )
        };
        let both = united(bill("std@1").as_bytes(), bill("std@2").as_bytes()).unwrap();
        let both: Value = serde_json::from_slice(&both).unwrap();
        let expected = serde_json::json!([{ "bom-ref": "a" }, { "bom-ref": "std@1" }, { "bom-ref": "std@2" }]);
        assert_eq!(both["components"], expected);
        assert_eq!(both["dependencies"][0]["dependsOn"], serde_json::json!(["std@1", "std@2"]));
    }
}
