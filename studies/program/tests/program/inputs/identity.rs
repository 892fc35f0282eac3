//! Records of a study: what tells them apart, and doubts about them.

use std::path::Path;

use crate::program::{Table, program, refusal, succeeds};

/// Writes a study of these tables `[[records]]`, and returns the names of the records in its table and the warnings.
fn sweep(folder: &Path, study: &str, records: &[&str]) -> (Vec<String>, String) {
    let tables: String = records.iter().map(|table| format!("[[records]]\n{table}\n")).collect();
    std::fs::write(folder.join("study.toml"), format!("[study]\ndesign = \"grid\"\n{study}\n{tables}")).unwrap();
    let (_, warnings) = succeeds(&mut program(folder, &[&["sweep", "study.toml", "--csv", "s.csv", "--force"]]));
    let table = Table::read(&folder.join("s.csv"));
    ((0..table.rows.len()).map(|row| table.get(row, "record").to_string()).collect(), warnings)
}

fn write(folder: &Path, name: &str, samples: impl Iterator<Item = f64>) {
    let rows: String = samples.enumerate().map(|(i, a)| format!("{},{a},{}\n", 0.01 * i as f64, 0.5 * a)).collect();
    std::fs::write(folder.join(name), format!("t [s],a [m/s2],b [m/s2]\n{rows}")).unwrap();
}

fn pulse(amplitude: f64) -> impl Iterator<Item = f64> {
    (0..60).map(move |i| if i % 20 < 10 { amplitude } else { -amplitude })
}

#[test]
fn records_of_one_file_have_names_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "two.csv", pulse(0.5));
    write(folder.path(), "one.csv", pulse(0.4));
    let columns = ["acceleration_column = \"a\"", "acceleration_column = 3"]
        .map(|column| format!("horizontal = \"two.csv\"\n{column}"));
    let only = "horizontal = \"one.csv\"\nacceleration_column = \"a\"";
    let (names, warnings) = sweep(folder.path(), "", &[&columns[0], &columns[1], only]);
    assert_eq!(names, ["two.csv (column a)", "two.csv (column 3)", "one.csv"]);
    assert_eq!(warnings, "");
    // The same record twice is one record; other processing makes another.
    let filtered = format!("{only}\nbaseline = true");
    let (names, warnings) = sweep(folder.path(), "", &[only, only, &filtered]);
    assert!(warnings.contains("one.csv is named more than once: its rows are made and counted as often"), "{warnings}");
    assert_eq!(names[0], names[1]);
    assert_eq!(names[2], "one.csv (baseline removed)");
}

/// A table has the motions of its rows where the names of records do not tell them.
#[test]
fn titles_and_content_tell_the_motions() {
    let folder = tempfile::tempdir().unwrap();
    let peer = |name: &str, title: &str, amplitude: f64| {
        let values: String = pulse(amplitude).map(|a| format!("{a}\n")).collect();
        let head = "PEER NGA STRONG MOTION DATABASE RECORD";
        let text =
            format!("{head}\n{title}\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=  60, DT=   .01 SEC\n{values}");
        std::fs::write(folder.path().join(name), text).unwrap();
        format!("horizontal = \"{name}\"")
    };
    let station = "Quake-01, 1/17/1994, Station";
    let tables = [("a", "A, 090", 0.1), ("b", "A, 360", 0.2), ("c", "B, 090", 0.3), ("d", "C", 0.3), ("e", "C", 0.4)]
        .map(|(name, title, amplitude)| peer(&format!("{name}.at2"), &format!("{station} {title}"), amplitude));
    let tables: Vec<&str> = tables.iter().map(String::as_str).collect();
    sweep(folder.path(), "", &tables);
    let table = Table::read(&folder.path().join("s.csv"));
    let motions: Vec<&str> = (0..5).map(|row| table.get(row, "motion")).collect();
    let [a, b] = ["A", "B"].map(|name| format!("{station} {name}"));
    assert_eq!(motions, [a.as_str(), &a, &b, &b, "e.at2"]);
    sweep(folder.path(), "", &[tables[0], tables[2], tables[4]]);
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    assert!(!text.contains(",motion,"), "{text}");
}

#[test]
fn doubts_about_records_are_said_once() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "b.csv"] {
        write(folder.path(), name, pulse(0.4));
    }
    write(folder.path(), "large.csv", pulse(50.0));
    let tables = ["a.csv", "b.csv", "large.csv", "large.csv"]
        .map(|name| format!("horizontal = \"{name}\"\nacceleration_column = \"a\""));
    let tables: Vec<&str> = tables.iter().map(String::as_str).collect();
    let (_, warnings) = sweep(folder.path(), "scales = [1, 21]", &tables);
    let warnings: Vec<&str> = warnings.lines().filter(|line| line.contains("warning")).collect();
    assert_eq!(warnings.len(), 7, "{warnings:#?}");
    assert!(
        warnings[0].ends_with("large.csv: the peak is 5.000e1 m/s², more than in any earthquake"),
        "{}",
        warnings[0]
    );
    assert!(warnings[1].contains("a.csv and b.csv hold the same samples (crc32 "), "{}", warnings[1]);
    assert!(
        warnings[3].ends_with("a.csv is scaled by up to 21.0; expected at most 20, beyond which noise is amplified"),
        "{}",
        warnings[3]
    );
    // A search may come as far as its range.
    let least = "least = { im = \"PGA\", from = 1, to = 9, points = 3, resolution = 0.1 }";
    let (_, warnings) = sweep(folder.path(), least, &tables[..1]);
    assert!(warnings.contains("a.csv may be scaled by up to 22.5; expected at most 20"), "{warnings}");
    let (_, warnings) = sweep(folder.path(), "levels = { im = \"PGA\", values = [8] }", &tables[..1]);
    assert_eq!(warnings.lines().filter(|line| line.contains("warning")).count(), 0, "{warnings}");
    let (_, warnings) = sweep(folder.path(), "levels = { im = \"PGA\", values = [9] }", &tables[..1]);
    assert!(warnings.contains("a.csv is scaled by up to 22.5"), "{warnings}");
    // The levels of a hunt are known after its runs, of a resumed table and of a part, too.
    let (_, warnings) = sweep(folder.path(), "hunt = { im = \"PGA\", first = 3, runs = 4 }", &tables[..1]);
    let greatest = Table::read(&folder.path().join("s.csv")).column("scale").into_iter().fold(0.0, f64::max);
    assert!(greatest > 20.0, "{greatest}");
    let doubt = format!("warning: a.csv is scaled by up to {greatest:.1}; expected at most 20");
    assert_eq!(warnings.lines().filter(|line| line.contains(&doubt)).count(), 1, "{warnings}");
    for options in [&["--csv", "s.csv", "--resume"][..], &["--part", "1/1", "--out", "parts"]] {
        let (_, warnings) = succeeds(&mut program(folder.path(), &[&["sweep", "study.toml"], options]));
        assert!(warnings.contains(&doubt), "{options:?}: {warnings}");
    }
    let study = std::fs::read_to_string(folder.path().join("study.toml"))
        .unwrap()
        .replace("hunt = { im = \"PGA\", first = 3, runs = 4 }", "levels = { im = \"PGA\", values = [8, 7, 8] }");
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    let found = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv", "--force"]);
    assert!(found.contains("study.toml:3: values = 8; expected each value once"), "{found}");
}
