//! Job arrays as they are run: several parts at once, `rocking parts`, `rocking merge`, and the examples of docs/studies/cluster.md.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{files, program, refusal, refused, rocking, stdout, succeeds, text};
use crate::studies::parts::{HUNT, RECORDED, make_part, make_parts};
use crate::studies::sweep::{GRID, SAMPLES, folder};

/// Returns the JSON of `rocking parts` and whether its status is 0.
fn state(folder: &Path, parts: &str) -> (Value, bool) {
    let output = rocking(folder, &["parts", parts, "--json"]);
    (serde_json::from_slice(&output.stdout).unwrap(), output.status.success())
}

/// In one part, in unequal parts, and in more parts than rows.
#[test]
fn merged_parts_are_the_table_of_one_run() {
    for study in [GRID, SAMPLES, HUNT, RECORDED] {
        let folder = folder(study);
        let path = folder.path();
        let read = |name: &str| fs::read(path.join(name)).unwrap();
        stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
        for count in [1, 2, 5, 33] {
            let out = format!("of_{count}");
            make_parts(path, count, &out);
            let printed = stdout(path, &["merge", &out, "--csv", "merged.csv", "--force"]);
            assert!(printed.starts_with(&format!("parts         {count}\nrows          ")), "{printed}");
            assert!(read("merged.csv") == read("whole.csv"), "{count} parts");
        }
        assert!(stdout(path, &["merge", "of_5", "--csv", "-"]).into_bytes() == read("whole.csv"));
    }
}

/// Parts in Parquet give both formats, with the types of their columns.
#[cfg(feature = "parquet")]
#[test]
fn merged_parts_in_parquet_are_the_table_of_one_run() {
    for study in [GRID, SAMPLES, HUNT, RECORDED] {
        let folder = folder(study);
        let path = folder.path();
        let read = |name: &str| fs::read(path.join(name)).unwrap();
        stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
        stdout(path, &["sweep", "study.toml", "--csv", "whole.parquet"]);
        for count in [1, 2, 5, 33] {
            let (parts, out) = (format!("1-{count}/{count}"), format!("of_{count}"));
            stdout(path, &["sweep", "study.toml", "--part", &parts, "--out", &out, "--part-format", "parquet"]);
            for whole in ["whole.csv", "whole.parquet"] {
                let (option, merged) = (format!("--{}", &whole[6..]), whole.replace("whole", "merged"));
                stdout(path, &["merge", &out, &option, &merged, "--force"]);
                assert!(read(&merged) == read(whole), "{count} parts, {whole}");
            }
        }
    }
    let folder = folder(SAMPLES);
    make_parts(folder.path(), 2, "parts");
    let csv = "parts/part-00001-of-00002.csv: is CSV, which does not tell numbers, whole numbers and words apart";
    refused(folder.path(), &["merge", "parts", "--parquet", "t.parquet"], &[csv]);
    assert!(!folder.path().join("t.parquet").exists());
}

/// Names of records and motions that are numbers stay as they are. Two components of a station give the table a column of motions.
#[test]
fn names_that_are_numbers_are_merged_as_they_are() {
    let components = ["090", "360"].map(|name| format!("\n[[records]]\nhorizontal = \"{name}.at2\"\n")).concat();
    let study = RECORDED.replace("h.csv", "007").replace("samples = 20", "samples = 2") + &components;
    let folder = folder(&study);
    let path = folder.path();
    fs::rename(path.join("h.csv"), path.join("007")).unwrap();
    for (name, amplitude) in [("090", 0.2), ("360", 0.3)] {
        let values: String =
            (0..60).map(|i| format!("{}\n", if i % 20 < 10 { amplitude } else { -amplitude })).collect();
        let head = format!("PEER NGA STRONG MOTION DATABASE RECORD\nQuake-01, 1/17/1994, Station A, {name}\n");
        let head = head + "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=  60, DT=   .01 SEC\n";
        fs::write(path.join(format!("{name}.at2")), head + &values).unwrap();
    }
    stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
    make_parts(path, 3, "parts");
    stdout(path, &["merge", "parts", "--csv", "merged.csv"]);
    let whole = fs::read_to_string(path.join("whole.csv")).unwrap();
    assert!(whole.contains(",motion,") && whole.matches(",007").count() > 6, "{whole}");
    assert!(fs::read_to_string(path.join("merged.csv")).unwrap() == whole);
}

/// A task may make several parts; the study is read once, and each file has the bytes of its own task.
#[test]
fn several_parts_have_the_bytes_of_each() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_parts(path, 7, "single");
    let printed = make_part(path, "1-3,5/7", "several");
    assert!(
        printed.starts_with("parts         1-3,5 of 7\nrows          ") && printed.contains(", 0 resumed\n"),
        "{printed}"
    );
    assert!(printed.ends_with("written       several\n"), "{printed}");
    let printed = make_part(path, "2-7/7", "several");
    assert!(printed.starts_with("parts         2-7 of 7, 3 complete before\n"), "{printed}");
    let names = files(&path.join("single"));
    assert_eq!((names.len(), &names), (7, &files(&path.join("several"))));
    for name in names {
        assert!(
            fs::read(path.join("single").join(&name)).unwrap() == fs::read(path.join("several").join(name)).unwrap()
        );
    }
}

/// The numbers that an array has to make again, and the status of a folder that is not complete.
#[test]
fn the_state_of_a_folder_names_the_parts_to_make() {
    let folder = folder(RECORDED);
    let path = folder.path();
    let (all, part) = ("1-40/40", |number: usize| path.join(format!("parts/part-{number:05}-of-00040.csv")));
    make_part(path, all, "parts");
    let (json, is_complete) = state(path, "parts");
    assert!(is_complete, "{json}");
    assert_eq!(
        ["complete", "parts", "rows", "rows_of_study"].map(|key| json[key].as_u64()),
        [Some(40), Some(40), Some(120), Some(120)]
    );
    assert_eq!(
        stdout(path, &["parts", "parts"]),
        "parts         40 of 40 complete\nrows          120 of 120, 100.0 %\n"
    );
    [3, 17, 38, 39, 40].iter().for_each(|number| fs::remove_file(part(*number)).unwrap());
    let bytes = fs::read(part(5)).unwrap();
    fs::write(part(5), &bytes[..bytes.len() - 1]).unwrap();
    fs::write(path.join("study.toml"), RECORDED.replace("seed = 3", "seed = 4")).unwrap();
    fs::remove_file(part(20)).unwrap();
    make_part(path, "20/40", "parts");
    let output = rocking(path, &["parts", "parts"]);
    let (printed, error) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(error, "rocking: parts: of 40 parts, 5 missing, 2 damaged or of another study\n");
    for line in [
        "parts         33 of 40 complete",
        "missing       5: 3,17,38-40",
        "faulty        parts/part-00005-of-00040.csv: is damaged: its bytes do not have their checksum; make it anew",
        "faulty        parts/part-00020-of-00040.csv: is a part of another study; found `seed = 4`, expected `seed = 3`",
        "to make       --array=3,5,17,20,38-40",
    ] {
        assert!(printed.contains(line), "{line} is missing in {printed}");
    }
    let (json, is_complete) = state(path, "parts");
    assert!(
        !is_complete && json["array"] == "3,5,17,20,38-40" && json["missing"].as_array().unwrap().len() == 5,
        "{json}"
    );
    // What is to make is what the option takes; a part of another study is replaced by force only.
    fs::write(path.join("study.toml"), RECORDED).unwrap();
    fs::remove_file(part(20)).unwrap();
    make_part(path, "3,5,17,20,38-40/40", "parts");
    assert!(state(path, "parts").1);
}

#[test]
fn parts_that_are_no_table_of_one_run_are_refused_by_name() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_parts(path, 4, "parts");
    let merge = ["merge", "parts", "--csv", "merged.csv"];
    let third = path.join("parts/part-00003-of-00004.csv");
    let bytes = fs::read(&third).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    for (content, reason) in [
        (&flipped[..], "part-00003-of-00004.csv: is damaged: its bytes do not have their checksum; make it anew"),
        (&bytes[..bytes.len() / 2], "part-00003-of-00004.csv: is damaged: found no checksum in its end"),
    ] {
        fs::write(&third, content).unwrap();
        refused(path, &merge, &[reason]);
    }
    fs::remove_file(&third).unwrap();
    assert_eq!(refusal(path, &merge), "parts: lacks 1 of 4 parts: 3; make these");
    fs::write(path.join("study.toml"), RECORDED.replace("seed = 3", "seed = 4")).unwrap();
    make_part(path, "3/4", "parts");
    refused(path, &merge, &["part-00003-of-00004.csv: is a part of another study; found `seed = 4`"]);
    fs::write(&third, &bytes).unwrap();
    assert!(!path.join("merged.csv").exists());
    let part = ["merge", "parts", "--csv", "parts/part-00003-of-00004.csv", "--force"];
    refused(path, &part, &["--csv parts/part-00003-of-00004.csv would replace the part parts/part-00003-of-00004.csv"]);
    stdout(path, &merge);
    refused(path, &merge, &["merged.csv: exists already; expected --force to replace it, or another name"]);
    refused(
        path,
        &["merge", "merged.csv", "--csv", "x.csv"],
        &["merged.csv: found other files; expected the parts of one study"],
    );
    // A folder of a key has a column that one run has not.
    fs::create_dir_all(path.join("keyed/region=north")).unwrap();
    for name in files(&path.join("parts")) {
        fs::copy(path.join("parts").join(&name), path.join("keyed/region=north").join(name)).unwrap();
    }
    refused(
        path,
        &["merge", "keyed", "--csv", "x.csv"],
        &["keyed: found other files; expected the parts of one study"],
    );
    stdout(path, &["merge", "keyed/region=north", "--csv", "x.csv"]);
    refused(path, &["parts", "."], &[".: found other files"]);
}

/// The scripts of docs/studies/cluster.md for all tasks of their arrays, and the commands after them, as they stand.
#[cfg(unix)]
#[test]
fn the_documented_job_arrays_run_as_they_stand() {
    let page = include_str!("../../../../../docs/studies/cluster.md");
    let scripts: Vec<&str> = page.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    let (begin, end) = (page.find("## Job arrays").unwrap(), page.find("## Executors in Python").unwrap());
    let commands: Vec<&str> = page[begin..end].lines().filter_map(|line| line.strip_prefix("    rocking ")).collect();
    assert!(scripts.len() == 3 && commands.len() >= 3, "{scripts:?} {commands:?}");
    let bin = Path::new(env!("CARGO_BIN_EXE_rocking")).parent().unwrap();
    let search = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let study = RECORDED.replace("samples = 20", "samples = 100");
    for (script, scheduler) in scripts.iter().zip(["SLURM", "PBS", "SLURM"]) {
        let folder = folder(&study);
        let path = folder.path();
        stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
        let last: usize = script.split("1-").nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap();
        for task in 1..=last {
            let mut shell = std::process::Command::new("sh");
            shell.args(["-ec", script]).current_dir(path).env("PATH", &search).env("PBS_O_WORKDIR", path);
            let index = if scheduler == "PBS" { "PBS_ARRAY_INDEX" } else { "SLURM_ARRAY_TASK_ID" };
            succeeds(shell.env(index, task.to_string()));
        }
        for command in &commands {
            let words: Vec<&str> = command.split_whitespace().collect();
            succeeds(&mut program(path, &[&words]));
        }
        assert!(fs::read(path.join("runs.csv")).unwrap() == fs::read(path.join("whole.csv")).unwrap(), "{script}");
    }
}
