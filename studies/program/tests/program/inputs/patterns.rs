//! File patterns in study files.

use std::path::Path;

use crate::program::{Table, refusal, stdout};

/// Writes records with these PGAs (m/s²), and their folders.
fn records(folder: &Path, files: &[(&str, f64)]) {
    for (name, pga) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, format!("t [s],a [m/s2]\n0,0\n0.1,{pga}\n0.2,0\n")).unwrap();
    }
}

fn study(folder: &Path, records: &str) -> String {
    let path = folder.join("study.toml");
    std::fs::write(&path, format!("[study]\ndesign = \"grid\"\n[[records]]\n{records}\n")).unwrap();
    path.to_str().unwrap().to_string()
}

/// Names and PGAs in each row.
fn rows(path: &Path) -> Vec<[String; 4]> {
    let table = Table::read(path);
    let columns = ["record", "PGA", "vertical", "PGA.vertical"];
    (0..table.rows.len()).map(|row| columns.map(|column| table.get(row, column).to_string())).collect()
}

/// Matches are sorted by name, and do not depend on the working folder.
#[test]
fn each_match_is_a_motion() {
    let folder = tempfile::tempdir().unwrap();
    // The name of the folder contains characters of patterns.
    let home = folder.path().join("a[b]*");
    let files = [("r/2-H.csv", 0.2), ("r/10-H.csv", 0.1), ("r/1-H.csv", 0.3), ("r/1-V.csv", 0.4), ("r/H.csv", 9.0)];
    records(&home, &files);
    std::fs::create_dir(home.join("r/0-H.csv")).unwrap();
    let file = study(&home, "horizontal = \"r/*-H.csv\"");
    stdout(folder.path(), &["sweep", &file, "--csv", "s.csv"]);
    let found = rows(&folder.path().join("s.csv"));
    let expected = [("r/1-H.csv", "0.3"), ("r/10-H.csv", "0.1"), ("r/2-H.csv", "0.2")];
    assert_eq!(found.len(), expected.len());
    for (row, (name, pga)) in found.iter().zip(expected) {
        assert_eq!(row, &[name, pga, "", ""]);
    }
    // A new match changes the study.
    records(&home, &[("r/3-H.csv", 0.5)]);
    let message = refusal(folder.path(), &["sweep", &file, "--csv", "s.csv", "--resume"]);
    assert!(message.contains("the table is that of another study"), "{message}");
}

#[test]
fn vertical_matches_are_paired_in_sorted_order() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path(), &[("b-H.csv", 0.1), ("a-H.csv", 0.2), ("a-V.csv", 0.3), ("b-V.csv", 0.4)]);
    study(folder.path(), "horizontal = \"?-H.csv\"\nvertical = \"?-V.csv\"");
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let expected = [["a-H.csv", "0.2", "a-V.csv", "0.3"], ["b-H.csv", "0.1", "b-V.csv", "0.4"]];
    assert_eq!(rows(&folder.path().join("s.csv")), expected);
    records(folder.path(), &[("c-V.csv", 0.1)]);
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "t.csv"]);
    let expected = "found 3 vertical and 2 horizontal files; expected equal numbers, paired in sorted order";
    assert_eq!(message, format!("study.toml:5: {expected}"));
}

#[test]
fn a_pattern_without_a_match_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path(), &[("a.csv", 0.1), ("b[1].csv", 0.2)]);
    let sweep = ["sweep", "study.toml", "--csv", "s.csv"];
    study(folder.path(), "horizontal = \"a.csv\"\n[[records]]\nhorizontal = \"*.AT2\"");
    let expected = "study.toml:6: horizontal = \"*.AT2\"; expected a pattern that matches a file";
    assert_eq!(refusal(folder.path(), &sweep), expected);
    study(folder.path(), "horizontal = \"a[.csv\"");
    let message = refusal(folder.path(), &sweep);
    assert!(message.starts_with("study.toml:4: horizontal = \"a[.csv\"; expected a pattern"), "{message}");
    // The name of an existing file is no pattern.
    study(folder.path(), "horizontal = \"b[1].csv\"");
    stdout(folder.path(), &sweep);
    assert_eq!(rows(&folder.path().join("s.csv")), [["b[1].csv", "0.2", "", ""]]);
}

/// Every unreadable record is named at once, over all tables.
#[test]
fn all_unreadable_records_are_named_in_one_error() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path(), &[("a.csv", 0.1)]);
    for name in ["b.csv", "c.csv", "d.txt"] {
        std::fs::write(folder.path().join(name), "no record\n").unwrap();
    }
    study(folder.path(), "horizontal = \"*.csv\"\n[[records]]\nhorizontal = \"d.txt\"");
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    for name in ["study.toml:4: ", "b.csv, line 1: found", "; line 6: ", "d.txt, line 1: found"] {
        assert!(message.contains(name), "{name} is not in {message}");
    }
    assert_eq!(message.matches("c.csv, line 1: found").count(), 1, "{message}");
    assert!(!message.contains("a.csv"), "{message}");
}

#[test]
fn excluded_matches_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path(), &[("r/a.csv", 0.1), ("r/b.csv", 0.2), ("r/bad.csv", 9.0), ("r/c-V.csv", 0.3)]);
    std::fs::write(folder.path().join("r/bad.csv"), "no record\n").unwrap();
    study(folder.path(), "horizontal = \"r/*.csv\"\nexclude = [\"r/bad.csv\", \"*/*-V.csv\"]");
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let expected = [["r/a.csv", "0.1", "", ""], ["r/b.csv", "0.2", "", ""]];
    assert_eq!(rows(&folder.path().join("s.csv")), expected);
    let refused = [
        ("[\"*.csv\"]", "\"*.csv\""),
        ("[1]", "1"),
        ("\"r/a.csv\"", "\"r/a.csv\""),
        ("[\"r/?.csv\"]", "[\"r/?.csv\"]"),
    ];
    for (exclude, found) in refused {
        study(folder.path(), &format!("horizontal = \"r/a.csv\"\nexclude = {exclude}"));
        let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "t.csv"]);
        assert!(message.starts_with(&format!("study.toml:5: exclude = {found}; expected ")), "{message}");
    }
}
