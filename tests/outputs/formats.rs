//! Endings of names, which say a format.

use crate::{SEARCH, SIMULATE, SPECTRUM, folder, made, names, refused, rocking, text};

#[test]
fn an_ending_of_another_format_is_refused_with_what_to_do() {
    let folder = folder();
    let path = folder.path();
    let all = names(path);
    let tables = [
        ("run.xlsx", "spreadsheet"),
        ("run.XLS", "spreadsheet"),
        ("run.ods", "spreadsheet"),
        ("run.parquet", "to_parquet"),
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
            refused(&mut rocking(path, &[command, &["--csv", name]]), &[name, "CSV", words]);
        }
    }
    let pictures = [("run.pdf", ".svg"), ("run.jpg", ".png"), ("run.csv", "--csv"), ("run", "--plot-format")];
    for (name, words) in pictures {
        for command in [&SIMULATE[..], &SPECTRUM] {
            let plot = ["--csv", "table.csv", "--plot", name];
            refused(&mut rocking(path, &[command, &plot]), &[name, ".svg or .png", words]);
        }
    }
    for (name, format) in [("run.svg", "png"), ("run.png", "svg"), ("run.pdf", "svg")] {
        let plot = ["--plot", name, "--plot-format", format];
        refused(&mut rocking(path, &[&SIMULATE, &plot]), &[name]);
    }
    assert_eq!(names(path), all);
}

#[test]
fn any_other_name_will_do() {
    let folder = folder();
    let path = folder.path();
    made(&mut rocking(path, &[&SIMULATE, &["--csv", "run.csv"]]));
    let table = std::fs::read(path.join("run.csv")).unwrap();
    for name in ["run.CSV", "run.txt", "run", "eta_0.25"] {
        made(&mut rocking(path, &[&SIMULATE, &["--csv", name]]));
        assert!(std::fs::read(path.join(name)).unwrap() == table, "{name}");
    }
    for (name, format) in [("picture", "png"), ("picture.png", "png"), ("drawing", "svg"), ("drawing.SVG", "svg")] {
        made(&mut rocking(path, &[&SIMULATE, &["--plot", name, "--plot-format", format]]));
        let bytes = std::fs::read(path.join(name)).unwrap();
        match format {
            "png" => assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n"),
            _ => assert_eq!(roxmltree::Document::parse(&text(&bytes)).unwrap().root_element().tag_name().name(), "svg"),
        }
    }
}
