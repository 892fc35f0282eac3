//! File extensions and formats.

use crate::outputs::{SEARCH, SIMULATE, SPECTRUM, folder};
use crate::program::{fails_with, files, program, succeeds, text};

#[test]
fn extensions_of_other_formats_are_refused_with_advice() {
    let folder = folder();
    let path = folder.path();
    let all = files(path);
    let tables = [
        ("run.xlsx", "spreadsheet"),
        ("run.XLS", "spreadsheet"),
        ("run.ods", "spreadsheet"),
        ("run.feather", "pandas"),
        ("run.h5", "pandas"),
        ("run.mat", "pandas"),
        ("run.json", "--json"),
        ("run.tsv", "commas"),
        ("run.csv.gz", "gzip"),
        ("run.png", "picture"),
        ("run.pdf", "picture"),
    ];
    for (name, words) in tables {
        for command in [&SIMULATE[..], &SPECTRUM, &SEARCH, &["sweep", "study.toml"]] {
            fails_with(
                &mut program(path, &[command, &["--csv", name]]),
                &[name, "expected a table as .csv or .parquet", words],
            );
        }
    }
    let pictures = [("run.pdf", ".svg"), ("run.jpg", ".png"), ("run.csv", "--csv"), ("run", "--plot-format")];
    for (name, words) in pictures {
        for command in [&SIMULATE[..], &SPECTRUM] {
            let plot = ["--csv", "table.csv", "--plot", name];
            fails_with(&mut program(path, &[command, &plot]), &[name, ".svg or .png", words]);
        }
    }
    for (name, format, words) in
        [("run.svg", "png", "one format"), ("run.png", "svg", "one format"), ("run.pdf", "svg", ".svg or .png")]
    {
        let plot = ["--plot", name, "--plot-format", format];
        fails_with(&mut program(path, &[&SIMULATE, &plot]), &[name, words]);
    }
    assert_eq!(files(path), all);
}

#[test]
fn all_other_names_are_accepted() {
    let folder = folder();
    let path = folder.path();
    succeeds(&mut program(path, &[&SIMULATE, &["--csv", "run.csv"]]));
    let table = std::fs::read(path.join("run.csv")).unwrap();
    for name in ["run.CSV", "run.txt", "run", "eta_0.25"] {
        succeeds(&mut program(path, &[&SIMULATE, &["--csv", name]]));
        assert!(std::fs::read(path.join(name)).unwrap() == table, "{name}");
    }
    for (name, format) in [("picture", "png"), ("picture.png", "png"), ("drawing", "svg"), ("drawing.SVG", "svg")] {
        succeeds(&mut program(path, &[&SIMULATE, &["--plot", name, "--plot-format", format]]));
        let bytes = std::fs::read(path.join(name)).unwrap();
        match format {
            "png" => assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n"),
            _ => assert_eq!(roxmltree::Document::parse(&text(&bytes)).unwrap().root_element().tag_name().name(), "svg"),
        }
    }
}
