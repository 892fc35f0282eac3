//! Content of `RockingBlock.fmu`, which depends on the sources alone.

#[path = "../build/date.rs"]
mod date;
#[path = "../build/positions.rs"]
mod positions;
#[path = "../build/sources.rs"]
mod sources;
#[path = "../build/xml.rs"]
mod xml;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use rocking_block::block::Corner;
use rocking_block::block::restraints::{LinkKind, RestraintEvent, tie::TieEvent};
use rocking_block::system::events::EventKind;
use rocking_block::unit::variables::{Causality, GUID, VARIABLES};
use sources::SOURCES;
use zip::{CompressionMethod, DateTime, ZipArchive};

const PACKAGE: &str = env!("CARGO_MANIFEST_DIR");

fn open(path: &Path) -> ZipArchive<File> {
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    ZipArchive::new(file).unwrap()
}

/// The FMU's files, by path.
fn files() -> BTreeMap<String, Vec<u8>> {
    let mut archive = open(Path::new(env!("ROCKING_BLOCK_FMU")));
    let mut files = BTreeMap::new();
    for position in 0..archive.len() {
        let mut entry = archive.by_index(position).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        assert!(!content.is_empty(), "{name} is empty");
        assert!(files.insert(name.clone(), content).is_none(), "{name} is there twice");
    }
    files
}

fn text(files: &BTreeMap<String, Vec<u8>>, path: &str) -> String {
    let content = files.get(path).unwrap_or_else(|| panic!("{path} is missing"));
    String::from_utf8(content.clone()).unwrap()
}

/// Returns path and content of the only binary.
fn binary(files: &BTreeMap<String, Vec<u8>>) -> (&str, &[u8]) {
    let mut binaries = files.iter().filter(|(path, _)| path.starts_with("binaries/"));
    let (path, content) = binaries.next().expect("a binary");
    assert_eq!(binaries.next(), None);
    (path, content)
}

fn contains(content: &[u8], part: &str) -> bool {
    content.windows(part.len()).any(|window| window == part.as_bytes())
}

#[test]
fn holds_only_the_files_of_the_standard() {
    let files = files();
    let (binary, _) = binary(&files);
    let found: Vec<_> = files.keys().filter(|path| !path.starts_with("documentation/licenses/")).collect();
    let expected = [
        binary,
        "documentation/index.html",
        "documentation/sbom.cdx.json",
        "model.png",
        "modelDescription.xml",
        "terminalsAndIcons/icon.png",
        "terminalsAndIcons/icon.svg",
        "terminalsAndIcons/terminalsAndIcons.xml",
    ];
    assert_eq!(found, expected);

    let (folder, file) = binary["binaries/".len()..].split_once('/').unwrap();
    assert_eq!(file.split('.').next(), Some("rocking_block"));
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        assert_eq!((folder, file), ("linux64", "rocking_block.so"));
    }
}

#[test]
fn holds_the_licence_of_every_crate_it_lists() {
    let files = files();
    let index = text(&files, "documentation/licenses/license.txt");
    // A crate's line: name version: licence, repository.
    let crates = index.lines().filter_map(|line| line.split_once(": ")?.0.rsplit_once('-'));
    let mut listed: BTreeSet<_> = crates
        .filter(|(name, version)| {
            !name.starts_with("rocking-") && version.starts_with(|first: char| first.is_ascii_digit())
        })
        .map(|(name, version)| format!("{name}-{version}"))
        .collect();
    assert!(listed.iter().any(|name| name.starts_with("serde-")), "{index}");
    listed.insert("rust-standard-library".to_owned());

    let licenses = files.keys().filter_map(|path| path.strip_prefix("documentation/licenses/"));
    let (folders, top): (Vec<_>, Vec<_>) = licenses.partition(|path| path.contains('/'));
    assert_eq!(top, ["LICENSE-APACHE", "LICENSE-MIT", "license.txt"]);
    let folders: BTreeSet<_> = folders.iter().map(|path| path.split('/').next().unwrap().to_owned()).collect();
    assert_eq!(folders, listed);
}

/// CycloneDX 1.6: the linked crates, with the checksums of Cargo.lock, and no content that differs between builds.
#[test]
fn bill_of_materials_lists_the_crates_of_the_licences_with_their_checksums() {
    let files = files();
    let bill: serde_json::Value = serde_json::from_str(&text(&files, "documentation/sbom.cdx.json")).unwrap();
    assert_eq!((&bill["bomFormat"], &bill["specVersion"]), (&"CycloneDX".into(), &"1.6".into()));
    assert!(bill["serialNumber"].is_null() && bill["metadata"]["timestamp"].is_null(), "{bill}");
    let word = |value: &serde_json::Value| value.as_str().unwrap_or_else(|| panic!("{value} in {bill}")).to_owned();

    let lock = fs::read_to_string(Path::new(PACKAGE).join("Cargo.lock")).unwrap();
    let mut named = BTreeSet::new();
    let mut references = BTreeSet::from([word(&bill["metadata"]["component"]["bom-ref"])]);
    for component in bill["components"].as_array().unwrap() {
        let (name, version) = (word(&component["name"]), word(&component["version"]));
        assert!(!word(&component["licenses"][0]["expression"]).contains('/'), "{name}");
        assert!(references.insert(word(&component["bom-ref"])), "{name} {version} is there twice");
        if name == "rust-standard-library" {
            named.insert(name);
            continue;
        }
        let locked = format!("name = \"{name}\"\nversion = \"{version}\"\n");
        let entry = &lock[lock.find(&locked).unwrap_or_else(|| panic!("Cargo.lock has no {name} {version}"))..];
        let entry = entry.split("[[package]]").next().unwrap();
        // The project's own crates have its licences and no checksum.
        if !entry.contains("source = ") {
            assert!(name.starts_with("rocking-") && component["hashes"].is_null(), "{component}");
            continue;
        }
        assert!(entry.contains(&format!("checksum = \"{}\"", word(&component["hashes"][0]["content"]))), "{entry}");
        named.insert(format!("{name}-{version}"));
    }
    let licences = files.keys().filter_map(|path| path.strip_prefix("documentation/licenses/")?.split_once('/'));
    assert_eq!(named, licences.map(|(folder, _)| folder.to_owned()).collect());

    for dependency in bill["dependencies"].as_array().unwrap() {
        assert!(references.contains(&word(&dependency["ref"])), "{dependency}");
        for needed in dependency["dependsOn"].as_array().unwrap() {
            assert!(references.contains(&word(needed)), "{dependency}");
        }
    }
}

/// The date of the sources, not that of the build: packed again after the same commit, the FMU is the same.
#[test]
fn description_has_the_date_of_the_sources() {
    for (seconds, expected) in [
        (0, "1970-01-01T00:00:00Z"),
        (951_826_154, "2000-02-29T12:09:14Z"),
        (1_709_251_199, "2024-02-29T23:59:59Z"),
        (4_107_542_400, "2100-03-01T00:00:00Z"),
        (-1, "1969-12-31T23:59:59Z"),
    ] {
        assert_eq!(date::utc(seconds), expected);
    }
    let packed = text(&files(), "modelDescription.xml");
    let packed = roxmltree::Document::parse(&packed).unwrap();
    let date = packed.root_element().attribute("generationDateAndTime").unwrap();
    // A commit of sources that were built before it does not pack again.
    assert!(date.len() == 20 && *date <= *date::generation().unwrap(), "{date}");
}

/// The packed description is the source with its GUID, with positions instead of names, and with Integers instead of enumerations.
#[test]
fn description_is_the_source_without_enumerations() {
    let files = files();
    let packed = text(&files, "modelDescription.xml");
    let source = fs::read_to_string(Path::new(PACKAGE).join("modelDescription.xml")).unwrap();
    let source = positions::write(&source).unwrap();
    let [packed, source] = [packed.as_str(), source.as_str()].map(|text| roxmltree::Document::parse(text).unwrap());
    assert_eq!(packed.root_element().attribute("guid"), Some(GUID));
    assert!(!packed.descendants().any(|node| node.has_tag_name("Enumeration")), "some importers leave these out");

    let variables = |document: &roxmltree::Document| -> Vec<(Vec<String>, Vec<String>)> {
        let attributes = |node: roxmltree::Node| {
            let mut texts = vec![node.tag_name().name().to_owned()];
            texts.extend(node.attributes().map(|attribute| format!("{} = {}", attribute.name(), attribute.value())));
            texts
        };
        let nodes = document.descendants().filter(|node| node.has_tag_name("ScalarVariable"));
        nodes.map(|node| (attributes(node), attributes(node.first_element_child().unwrap()))).collect()
    };
    let (packed, source) = (variables(&packed), variables(&source));
    assert_eq!(packed.len(), VARIABLES.len());
    let mut choices = 0;
    for ((packed, source), metadata) in packed.iter().zip(&source).zip(&VARIABLES) {
        assert_eq!(packed.0[1], format!("name = {}", metadata.name));
        assert_eq!(packed.0[2], format!("valueReference = {}", metadata.reference()));
        if source.1[0] != "Enumeration" {
            assert_eq!(packed, source);
            continue;
        }
        choices += 1;
        assert_eq!(packed.1[0], "Integer");
        let [first, .., last] = metadata.items else { panic!("{} has no choices", metadata.name) };
        assert_eq!(packed.1[1..3], [format!("min = {}", first.0), format!("max = {}", last.0)]);
        assert_eq!(packed.1.get(3), metadata.start.map(|start| format!("start = {start}")).as_ref());
        let description = packed.0.iter().find(|text| text.starts_with("description")).unwrap();
        for (value, name) in metadata.items {
            assert!(description.contains(&format!("{value} {name}")), "{description}");
        }
    }
    assert_eq!(choices, 6);
}

/// A file with one variable for each letter of `xyz`, and these groups and outputs.
fn with_names(groups: &str, outputs: &str) -> Result<String, String> {
    let variable = |name: char| format!("<ScalarVariable name=\"{name}\"/>");
    let variables: String = "xyz".chars().map(variable).collect();
    positions::write(&format!(
        "<a><ModelVariables>{variables}</ModelVariables><Fmi3><ModelVariables><Float64 name=\"time\"/></ModelVariables></Fmi3>\
         <ModelStructure><Groups>{groups}</Groups><Outputs>{outputs}</Outputs></ModelStructure></a>"
    ))
}

#[test]
fn dependencies_by_name_become_positions_in_order() {
    let groups = r#"<Group name="late" members="z y"/><Group name="all" members="@late x"/>"#;
    let outputs = r#"<Unknown name="z" dependencies="@all" ofFmi3="time"/><Unknown name="y" dependencies=""/>"#;
    let text = with_names(groups, outputs).unwrap();
    let expected = r#"<ModelStructure><Outputs><Unknown index="3" dependencies="1 2 3" ofFmi3="4" dependenciesKind="dependent dependent dependent"/><Unknown index="2" dependencies=""/></Outputs>"#;
    assert!(text.contains(expected), "{text}");
    assert!(
        text.contains(r#"<ScalarVariable name="y" valueReference="2"/>"#)
            && text.contains(r#"name="time" valueReference="4""#)
    );
}

#[test]
fn wrong_names_of_dependencies_are_refused_with_their_place() {
    for (groups, outputs, expected) in [
        ("", r#"<Unknown name="z" dependencies="x w"/>"#, "dependencies of unknown z: w is no variable"),
        ("", r#"<Unknown name="z" dependencies="" ofFmi3="@w"/>"#, "ofFmi3 of unknown z: w is no group above"),
        ("", r#"<Unknown name="w" dependencies=""/>"#, "w is no variable"),
        (r#"<Group name="g" members="x w"/>"#, "", "group g: w is no variable"),
        (r#"<Group name="g" members="@g"/>"#, "", "group g: g is no group above"),
        (r#"<Group name="g" members="x"/><Group name="g" members="y"/>"#, "", "group g stands twice"),
        (
            r#"<Group name="g" members="x y"/>"#,
            r#"<Unknown name="z" dependencies="@g x"/>"#,
            "dependencies of unknown z: x names a variable that is listed already",
        ),
    ] {
        assert_eq!(with_names(groups, outputs).unwrap_err(), expected);
    }
}

#[test]
fn binary_holds_the_guid_and_no_path_of_this_machine() {
    let files = files();
    let (_, binary) = binary(&files);
    assert!(contains(binary, GUID), "the binary was built from another description");
    // Folders of registries are named after their hosts.
    assert!(!contains(binary, "registry/src"), "the binary holds a path of a registry");
    let mut paths = vec![PACKAGE.to_owned()];
    paths.extend(["HOME", "USERPROFILE", "CARGO_HOME"].into_iter().filter_map(|name| std::env::var(name).ok()));
    for path in paths.iter().filter(|path| path.len() > 1) {
        assert!(!contains(binary, &format!("{path}/")), "the binary holds {path}");
    }
}

#[test]
fn page_shows_every_variable_and_loads_nothing() {
    let page = text(&files(), "documentation/index.html");
    for variable in &VARIABLES {
        assert!(page.contains(&format!("<td><code>{}</code></td>", variable.name)), "{}", variable.name);
    }
    // A reference within the page, such as to the arrowhead of the drawing, loads nothing.
    let page = page.replace("url(#", "");
    for forbidden in
        ["<script", "<link", "src=", "@import", "url(", "<!-- variables", "<!-- version", "<!-- FMI", "fmi3"]
    {
        assert!(!page.contains(forbidden), "the page holds {forbidden}");
    }
}

/// The text of the page above its tables names every group of parameters and every event, and the types are those of the version.
#[test]
fn page_explains_parameters_and_events() {
    let page = text(&files(), "documentation/index.html");
    let (explained, tables) = page.split_once("<h2 id=\"variables\">").unwrap();
    for variable in VARIABLES.iter().filter(|variable| variable.causality == Causality::Parameter) {
        let group = variable.name.split_once('.').map_or(variable.name, |(group, _)| group);
        assert!(explained.contains(&format!("<code>{group}")), "the page does not explain {group}");
    }
    let links = [TieEvent::Taut, TieEvent::Slack, TieEvent::Yield, TieEvent::Unload, TieEvent::Break];
    for event in &links {
        match event {
            TieEvent::Taut | TieEvent::Slack | TieEvent::Yield | TieEvent::Unload | TieEvent::Break => (),
        }
    }
    let links = links.map(|event| EventKind::Restraint(RestraintEvent::Tie(LinkKind::Tie, 0, event)));
    let corner = Corner::Left;
    let events = [
        EventKind::LiftOff(corner),
        EventKind::Landing(corner),
        EventKind::Slip,
        EventKind::Grip,
        EventKind::Overturning,
    ];
    for event in events.into_iter().chain(links) {
        match event {
            EventKind::LiftOff(_) | EventKind::Landing(_) | EventKind::Slip | EventKind::Grip => (),
            EventKind::Restraint(_) | EventKind::Overturning => (),
        }
        let rows = explained.lines().filter_map(|line| line.strip_prefix("<tr><td>")?.split_once("</td>"));
        let is_row = |cell: &str| cell.to_lowercase().split(", ").any(|word| word == event.word());
        assert!(rows.map(|(cell, _)| cell).any(is_row), "the page has no event {}", event.word());
    }
    for claim in ["do not slide", "is not tied"] {
        assert!(!explained.contains(claim), "the page says {claim:?}");
    }
    assert!(!tables.contains("Enumeration") && tables.contains("<code>foundation</code></td><td>Integer</td>"));
}

/// The packed description has neither the comments of its source nor what they leave, and names the tool with its version.
#[test]
fn description_is_tidy() {
    let (files, root) = (files(), env!("CARGO_PKG_VERSION"));
    let description = text(&files, "modelDescription.xml");
    for rest in ["<!--", "ofFmi3", "\n\n", "\n \n"] {
        assert!(!description.contains(rest), "the description holds {rest:?}");
    }
    assert!(description.lines().all(|line| !line.trim().is_empty()));
    assert!(description.contains(&format!("generationTool=\"rocking-block {root}\"")));
    let terminals = text(&files, "terminalsAndIcons/terminalsAndIcons.xml");
    for link in ["tie_1", "tie_2", "damper_1", "damper_2"] {
        assert!(terminals.contains(&format!("<Terminal name=\"{link}\"")), "no terminal {link}");
    }
}

/// Any difference between two builds of the same sources would show here first.
#[test]
fn entries_are_sorted_and_undated() {
    let mut archive = open(Path::new(env!("ROCKING_BLOCK_FMU")));
    let mut names = Vec::new();
    for position in 0..archive.len() {
        let entry = archive.by_index(position).unwrap();
        let name = entry.name().unwrap().into_owned();
        assert_eq!(entry.last_modified(), Some(DateTime::default()), "{name}");
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        assert_eq!(entry.unix_mode().map(|mode| mode & 0o777), Some(mode), "{name}");
        assert_eq!(entry.compression(), CompressionMethod::Deflated, "{name}");
        names.push(name);
    }
    assert!(names.is_sorted(), "{names:?}");
}
