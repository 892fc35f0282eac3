//! Studies in parts: `rocking sweep --part`, folders of parts, and the forecast of a study's cost.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use rocking_studies::output::seal::SealingWriter;

use crate::program::{Table, files, program, refusal, refused, rocking, stdout};
use crate::studies::sweep::{GRID, SAMPLES, folder};

/// Four curves of seven runs, each run's level from those before.
pub const HUNT: &str = r#"
[study]
design = "grid"
hunt = { im = "PGV", first = 0.1, runs = 7 }

[parameters]
alpha = [0.1, 0.2]
p = [2, 3]

[[records]]
horizontal = "h.csv"
unit = "m/s2"
dt = 0.02
"#;

/// Enough rows for a fit.
pub const RECORDED: &str = r#"
[study]
design = "latin-hypercube"
samples = 20
seed = 3
scales = [0.2, 0.4, 0.6]

[parameters]
alpha = { from = 0.1, to = 0.3 }
p = { from = 1, to = 4 }

[[records]]
horizontal = "h.csv"
unit = "m/s2"
dt = 0.02

[[records]]
horizontal = "v.csv"
unit = "m/s2"
dt = 0.02
"#;

pub fn make_part(folder: &Path, part: &str, out: &str) -> String {
    stdout(folder, &["sweep", "study.toml", "--part", part, "--out", out, "--part-format", "csv"])
}

pub fn make_parts(folder: &Path, count: usize, out: &str) {
    (1..=count).for_each(|number| drop(make_part(folder, &format!("{number}/{count}"), out)));
}

/// The rows of a table, each with its line, and nothing else.
fn rows(path: &Path) -> Vec<(u64, String)> {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| (line.split(',').next().unwrap().parse().unwrap(), line.to_string())).collect()
}

/// 24, 8, 28 and 120 rows, in one part, in unequal parts, and in more parts than rows.
#[test]
fn the_rows_of_all_parts_are_those_of_the_whole() {
    for study in [GRID, SAMPLES, HUNT, RECORDED] {
        let folder = folder(study);
        let path = folder.path();
        stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
        let whole = rows(&path.join("whole.csv"));
        for count in [1, 2, 5, 33] {
            let out = format!("of_{count}");
            make_parts(path, count, &out);
            let names = files(&path.join(&out));
            assert_eq!((names.len(), names[0].as_str()), (count, &*format!("part-00001-of-{count:05}.csv")));
            let mut found: Vec<_> = names.iter().flat_map(|name| rows(&path.join(&out).join(name))).collect();
            found.sort();
            assert!(found == whole, "{count} parts");
        }
    }
}

/// Neighbouring rows share a block or a record: no part has all rows of one scale.
#[test]
fn parts_hold_rows_from_the_whole_study() {
    let folder = folder(RECORDED);
    make_parts(folder.path(), 3, "parts");
    for name in files(&folder.path().join("parts")) {
        let table = Table::read(&folder.path().join("parts").join(&name));
        for scale in [0.2, 0.4, 0.6] {
            let found = table.column("scale").iter().filter(|found| **found == scale).count();
            assert!((5..=25).contains(&found), "{name}: {found} of 40 rows with scale {scale}");
        }
    }
}

#[test]
fn complete_parts_are_left_alone_and_broken_ones_are_made_anew() {
    let folder = folder(SAMPLES);
    let path = folder.path();
    let printed = make_part(path, "2/2", "parts");
    assert!(printed.starts_with("part          2 of 2\nrows          4, 0 resumed\n"), "{printed}");
    let file = path.join("parts/part-00002-of-00002.csv");
    let bytes = fs::read(&file).unwrap();
    let time = || fs::metadata(&file).unwrap().modified().unwrap();
    let before = time();
    let printed = make_part(path, "2/2", "parts");
    assert!(printed.starts_with("part          2 of 2, complete before\nrows          4, 4 resumed\n"), "{printed}");
    assert_eq!(time(), before);
    for length in [0, 20, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&file, &bytes[..length]).unwrap();
        make_part(path, "2/2", "parts");
        assert!(fs::read(&file).unwrap() == bytes, "cut at byte {length}");
    }
    for other in [&b"\xff\xfe\x00"[..], &[0; 5000], b"row,x\n0,1\n"] {
        fs::write(&file, other).unwrap();
        make_part(path, "2/2", "parts");
        assert!(fs::read(&file).unwrap() == bytes, "{other:?}");
    }
    assert_eq!(files(&path.join("parts")), ["part-00002-of-00002.csv"]);
    fs::write(path.join("study.toml"), SAMPLES.replace("seed = 5", "seed = 6")).unwrap();
    let arguments = ["sweep", "study.toml", "--part", "2/2", "--out", "parts", "--part-format", "csv"];
    assert_eq!(
        refusal(path, &arguments),
        "parts/part-00002-of-00002.csv: is a part of another study; found `seed = 5`, expected `seed = 6`"
    );
    assert!(fs::read(&file).unwrap() == bytes);
    stdout(path, &[&arguments[..], &["--force"]].concat());
    assert!(fs::read(&file).unwrap() != bytes);
}

#[test]
fn two_tasks_on_the_same_part_leave_one_whole_file() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_part(path, "1/2", "alone");
    let arguments = ["sweep", "study.toml", "--part", "1/2", "--out", "parts", "--part-format", "csv"];
    let task = || program(path, &[&arguments]).stdout(Stdio::null()).spawn().unwrap();
    let tasks: Vec<_> = (0..4).map(|_| task()).collect();
    tasks.into_iter().for_each(|mut task| assert!(task.wait().unwrap().success()));
    assert_eq!(files(&path.join("parts")), ["part-00001-of-00002.csv"]);
    let read = |folder: &str| fs::read(path.join(folder).join("part-00001-of-00002.csv")).unwrap();
    assert!(read("alone") == read("parts"));
}

/// Readers name a part with a single other bit, and its task makes it anew.
#[test]
fn a_flipped_bit_is_named_and_mended() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_parts(path, 2, "parts");
    let file = path.join("parts/part-00002-of-00002.csv");
    let bytes = fs::read(&file).unwrap();
    for bit in (0..8 * bytes.len()).step_by(8 * bytes.len() / 40 + 3) {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        fs::write(&file, &flipped).unwrap();
        let refusal = refusal(path, &["fragility", "parts", "--im", "PGV", "--limit", "0.2"]);
        assert!(refusal.starts_with("parts/part-00002-of-00002.csv: is damaged: "), "bit {bit}: {refusal}");
        assert!(refusal.ends_with("; make it anew: delete it, and run part 2 of 2 again"), "bit {bit}: {refusal}");
        let printed = make_part(path, "2/2", "parts");
        assert!(!printed.contains("complete before"), "bit {bit}: {printed}");
        assert!(fs::read(&file).unwrap() == bytes, "bit {bit}");
    }
}

/// The rows of a part are those of its plan, also where its checksum is right.
#[test]
fn a_part_with_other_rows_than_its_plan_is_named() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_parts(path, 2, "parts");
    let file = path.join("parts/part-00002-of-00002.csv");
    let text = fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let count = lines.len();
    // The last line but one is in place of that before, and the last has the checksum.
    let doubled = [&lines[..count - 3], &[lines[count - 2]; 2]].concat().join("\n") + "\n";
    let mut writer = SealingWriter::new(Vec::new());
    writer.write_all(doubled.as_bytes()).unwrap();
    fs::write(&file, writer.finish_text().unwrap()).unwrap();
    let refusal = refusal(path, &["fragility", "parts", "--im", "PGV", "--limit", "0.2"]);
    let number = |line: &str| line.split(',').next().unwrap().to_string();
    let expected = format!("found row {} in place of row {}", number(lines[count - 2]), number(lines[count - 3]));
    assert!(refusal.contains(&expected), "{refusal}");
}

/// Parts of one set are in a folder: another is refused before its rows are made.
#[test]
fn a_part_of_another_set_is_refused_before_it_runs() {
    let folder = folder(&RECORDED.replace("samples = 20", "samples = 2000000"));
    let path = folder.path();
    fs::create_dir(path.join("parts")).unwrap();
    fs::write(path.join("parts/part-00002-of-00003.csv"), "").unwrap();
    let arguments = ["sweep", "study.toml", "--part", "1/4", "--out", "parts"];
    assert_eq!(
        refusal(path, &arguments),
        "parts: has parts of another set, such as part-00002-of-00003.csv; expected some of 4 parts, or another folder"
    );
    let thirds = ["sweep", "study.toml", "--part", "1/3", "--out", "parts", "--part-format", "parquet"];
    refused(
        path,
        &thirds,
        &["such as part-00002-of-00003.csv; expected some of 3 parts in parquet, or another folder"],
    );
    assert_eq!(files(&path.join("parts")), ["part-00002-of-00003.csv"]);
}

/// A part checks its own combinations, and a dry run all: that of a large study takes minutes.
#[test]
fn a_part_checks_its_own_combinations() {
    let study = "[study]\ndesign = \"grid\"\n[parameters]\np = [1, 2, 3, 4]\neccentricity = [0, 5]\nfoundation = \"rigid\"\n\
                 pulse = { shape = \"one-sine\", amplitude = 6, period = 1 }\n";
    let folder = folder(study);
    let path = folder.path();
    refused(path, &["sweep", "study.toml", "--dry-run"], &["eccentricity"]);
    let part = |number: usize| {
        let part = format!("{number}/8");
        let arguments = ["sweep", "study.toml", "--part", &part, "--out", "parts", "--part-format", "csv"];
        rocking(path, &arguments).status.success()
    };
    assert_eq!((1..=8).filter(|number| part(*number)).count(), 4);
}

/// A task that is killed while it computes leaves nothing that a reader would take, and no part.
#[test]
fn a_task_that_is_killed_leaves_no_part() {
    let folder = folder(&RECORDED.replace("samples = 20", "samples = 200000"));
    let path = folder.path();
    let arguments = ["sweep", "study.toml", "--part", "1/2", "--out", "parts", "--part-format", "csv"];
    let mut task = program(path, &[&arguments]).stdout(Stdio::null()).spawn().unwrap();
    // The folder is there once the study has been read.
    while !path.join("parts").exists() && task.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    std::thread::sleep(std::time::Duration::from_millis(100));
    task.kill().unwrap();
    assert!(!task.wait().unwrap().success());
    assert!(files(&path.join("parts")).iter().all(|name| name.starts_with('.')));
    fs::write(path.join("study.toml"), RECORDED).unwrap();
    make_part(path, "1/2", "parts");
    let visible = |name: &String| !name.starts_with('.');
    assert_eq!(files(&path.join("parts")).into_iter().filter(visible).collect::<Vec<_>>(), ["part-00001-of-00002.csv"]);
}

/// A part that does not fit is absent, and one line says why.
#[cfg(unix)]
#[test]
fn a_part_that_cannot_be_written_is_absent() {
    let folder = folder(RECORDED);
    let path = folder.path();
    make_part(path, "1/2", "parts");
    let mut command = std::process::Command::new("sh");
    let arguments = "sweep study.toml --part 2/2 --out parts --part-format csv";
    command.args(["-c", &format!("ulimit -f 2; exec {} {arguments}", env!("CARGO_BIN_EXE_rocking"))]).current_dir(path);
    crate::program::fails_with(&mut command, &["parts/part-00002-of-00002.csv: cannot be written: File too large"]);
    assert_eq!(files(&path.join("parts")), ["part-00001-of-00002.csv"]);
}

#[test]
fn a_folder_of_parts_gives_the_fit_of_the_table() {
    let folder = folder(RECORDED);
    let path = folder.path();
    stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
    make_parts(path, 4, "parts");
    let fit = |table: &str, options: &[&str]| {
        let arguments = ["fragility", table, "--im", "PGV", "--limit", "0.2", "--bootstrap", "20", "--json"];
        let printed = rocking(path, &[&arguments[..], options].concat());
        assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
        let mut json: serde_json::Value = serde_json::from_slice(&printed.stdout).unwrap();
        json.as_object_mut().unwrap().remove("table").unwrap();
        json
    };
    assert_eq!(fit("parts", &[]), fit("whole.csv", &[]));
    assert_eq!(fit("parts/*.csv", &[]), fit("whole.csv", &[]));
    // Other files have no numbers: their rows are in the order of the names.
    fs::create_dir_all(path.join("other/of=it")).unwrap();
    let whole = fs::read_to_string(path.join("whole.csv")).unwrap();
    let (lines, heading) = (whole.lines().collect::<Vec<_>>(), whole.lines().position(|line| line.starts_with("row,")));
    let (comments, rows) = lines.split_at(heading.unwrap() + 1);
    for (name, rows) in ["a.csv", "b.csv"].into_iter().zip(rows.chunks(70)) {
        fs::write(path.join("other/of=it").join(name), [comments, rows].concat().join("\n") + "\n").unwrap();
    }
    assert_eq!(fit("other", &[]), fit("whole.csv", &[]));
    // The rows that meet a condition are the same: they are separable.
    let [one, other] = ["whole.csv", "other"].map(|table| {
        let refusal = refusal(path, &["fragility", table, "--im", "PGV", "--limit", "0.2", "--where", "scale=0.6"]);
        assert!(refusal.contains("exceeded in 14 of 20 at"), "{refusal}");
        refusal.trim_start_matches(table).to_string()
    });
    assert_eq!(one, other);
    refused(path, &["fragility", "other", "--im", "PGV", "--where", "p=99"], &["other: found no row with p = 99"]);
    let missing = path.join("parts/part-00003-of-00004.csv");
    let bytes = fs::read(&missing).unwrap();
    let arguments = ["fragility", "parts", "--im", "PGV"];
    for (content, reason) in [
        (&bytes[..bytes.len() - 1], "its bytes do not have their checksum"),
        (&bytes[..bytes.len() - 20], "found no checksum in its end"),
        (&bytes[..0], "found no checksum in its end"),
        (&bytes[..300], "found no checksum in its end"),
        (b"\xff\xfe\x00", "found no checksum in its end"),
        // Zeros in the description.
        (&[&bytes[..50], &[0; 100], &bytes[150..]].concat(), "its bytes do not have their checksum"),
    ] {
        fs::write(&missing, content).unwrap();
        let refusal = refusal(path, &arguments);
        let begin = format!("parts/part-00003-of-00004.csv: is damaged: {reason}");
        assert!(refusal.starts_with(&begin), "{refusal}");
        assert!(refusal.ends_with("; make it anew: delete it, and run part 3 of 4 again"), "{refusal}");
    }
    fs::remove_file(&missing).unwrap();
    assert_eq!(
        refusal(path, &arguments),
        "parts: lacks 1 of 4 parts: 3; make these, or evaluate the others alone with --partial"
    );
    let three = fit("parts", &["--partial"]);
    assert_eq!(three["rows"]["all"].as_u64().unwrap() + rows_of(&bytes), 120);
    // A stranger among them.
    fs::write(path.join("study.toml"), RECORDED.replace("seed = 3", "seed = 4")).unwrap();
    make_part(path, "3/4", "parts");
    refused(path, &arguments, &["part-00003-of-00004.csv: is a part of another study; found `seed = 4`"]);
    make_part(path, "1/2", "halves");
    let half = "part-00001-of-00002.csv";
    fs::copy(path.join("halves").join(half), path.join("parts").join(half)).unwrap();
    refused(path, &arguments, &["parts of different sets, part-00001-of-00002.csv and"]);
    fs::create_dir(path.join("none")).unwrap();
    refused(path, &["fragility", "none", "--im", "PGV"], &["none: has no parts of a study"]);
    refused(
        path,
        &["fragility", "whole.csv", "--im", "PGV", "--partial"],
        &["--partial has no effect without a folder"],
    );
}

/// Folders named `key=value`, as Dask and Spark write them, have a set of parts or other files each; the key is a column.
#[test]
fn keys_of_folders_are_columns() {
    let folder = folder(RECORDED);
    let path = folder.path();
    let fit = |table: &str, condition: &[&str]| {
        let arguments = ["fragility", table, "--im", "PGV", "--limit", "0.3", "--bootstrap", "20", "--json"];
        let printed = rocking(path, &[&arguments[..], condition].concat());
        assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
        let mut json: serde_json::Value = serde_json::from_slice(&printed.stdout).unwrap();
        json.as_object_mut().unwrap().remove("table").unwrap();
        json
    };
    for (region, count, seed) in [("north", 2, "seed = 3"), ("the%20south", 3, "seed = 4")] {
        fs::write(path.join("study.toml"), RECORDED.replace("seed = 3", seed)).unwrap();
        fs::create_dir_all(path.join("runs")).unwrap();
        make_parts(path, count, &format!("runs/region={region}"));
        stdout(path, &["sweep", "study.toml", "--csv", &format!("{}.csv", &region[..5])]);
    }
    let rows = |json: &serde_json::Value| json["rows"]["all"].as_u64();
    let both = fit("runs", &[]);
    assert_eq!(rows(&both), Some(240));
    // Rows are in the order of the folders, and in them in that of the files.
    let median = |json: &serde_json::Value| json["measures"][0]["median"].as_f64().unwrap();
    for (region, table) in [("north", "north.csv"), ("the south", "the%2.csv")] {
        let condition = format!("region={region}");
        let [one, other] = [fit("runs", &["--where", &condition]), fit(table, &[])];
        assert_eq!((rows(&one), rows(&other)), (Some(120), Some(120)));
        assert!((median(&one) / median(&other) - 1.0).abs() < 1e-9);
        assert!((median(&one) / median(&both) - 1.0).abs() > 1e-4);
    }
    assert_eq!(fit("runs/region=*/*.csv", &[]), both);
    // A folder of one key has no key, and its rows have numbers.
    assert_eq!(fit("runs/region=north", &[]), fit("north.csv", &[]));
    refused(path, &["fragility", "runs/region=north", "--im", "PGV", "--where", "region=north"], &["no column region"]);
    refused(
        path,
        &["fragility", "runs", "--im", "PGV", "--where", "region=west"],
        &["runs: found no row with region = west"],
    );
    let lost = path.join("runs/region=north/part-00002-of-00002.csv");
    fs::rename(&lost, path.join("lost.csv")).unwrap();
    let refusal = refusal(path, &["fragility", "runs", "--im", "PGV"]);
    assert!(refusal.starts_with("runs/region=north: lacks 1 of 2 parts: 2; make these"), "{refusal}");
    assert_eq!(rows(&fit("runs", &["--partial"])), Some(180));
    // Other folders with the same parts are not told apart.
    fs::create_dir_all(path.join("copies/a")).unwrap();
    fs::create_dir_all(path.join("copies/b")).unwrap();
    fs::copy(path.join("lost.csv"), path.join("copies/a/part-00002-of-00002.csv")).unwrap();
    fs::copy(path.join("lost.csv"), path.join("copies/b/part-00002-of-00002.csv")).unwrap();
    let sets = "parts of different sets, a/part-00002-of-00002.csv and b/part-00002-of-00002.csv";
    refused(path, &["fragility", "copies", "--im", "PGV"], &[sets]);
}

fn rows_of(part: &[u8]) -> u64 {
    let text = String::from_utf8_lossy(part);
    text.lines().filter(|line| !line.starts_with('#')).count() as u64 - 1
}

#[test]
fn options_of_parts_say_what_they_expect() {
    let folder = folder(SAMPLES);
    for (options, expected) in [
        (&["--part", "0/4", "--out", "parts"][..], "number the tasks of a job array from 1"),
        (&["--part", "5/4", "--out", "parts"], "from 1 and the number of all parts, such as 3/100, 1-10/100"),
        (&["--part", "1/4"], "--out <FOLDER>"),
        (&["--out", "parts"], "--part <K/N>"),
        (&["--part", "1/4", "--out", "parts", "--csv", "table.csv"], "--csv"),
        (&[], "--csv <FILE.csv>"),
    ] {
        let printed = rocking(folder.path(), &[&["sweep", "study.toml"], options].concat());
        let message = String::from_utf8_lossy(&printed.stderr);
        assert!(printed.status.code() == Some(2) && message.contains(expected), "{options:?}: {message}");
    }
    assert!(!folder.path().join("parts").exists());
}

/// The CPU time of one core is that of an idle machine, also where other programs take most of the time of all cores.
#[cfg(unix)]
#[test]
fn a_dry_run_counts_cpu_time() {
    let folder = folder(&RECORDED.replace("samples = 20", "samples = 2000"));
    let seconds = || {
        let printed = stdout(folder.path(), &["sweep", "study.toml", "--dry-run", "--json"]);
        serde_json::from_str::<serde_json::Value>(&printed).unwrap()["seconds"].as_f64().unwrap()
    };
    let alone = seconds();
    let is_over = std::sync::atomic::AtomicBool::new(false);
    let busy = std::thread::scope(|scope| {
        for _ in 0..10 * std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(|| {
                while !is_over.load(std::sync::atomic::Ordering::Relaxed) {
                    std::hint::spin_loop()
                }
            });
        }
        let busy = seconds();
        is_over.store(true, std::sync::atomic::Ordering::Relaxed);
        busy
    });
    assert!(busy < 2.5 * alone, "{busy} s beside others, {alone} s alone");
}

/// The sample of a small study is all of it, and the size of its rows is exact.
#[test]
fn a_dry_run_forecasts_rows_and_size() {
    let folder = folder(RECORDED);
    let path = folder.path();
    let printed = stdout(path, &["sweep", "study.toml", "--dry-run", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    stdout(path, &["sweep", "study.toml", "--csv", "whole.csv"]);
    let size: usize = rows(&path.join("whole.csv")).iter().map(|(_, line)| line.len() + 1).sum();
    assert_eq!(
        (json["rows"].as_u64(), json["tried"].as_u64(), json["bytes"].as_f64()),
        (Some(120), Some(120), Some(size as f64))
    );
    assert!(json["seconds"].as_f64().unwrap() > 0.0);
    let printed = stdout(path, &["sweep", "study.toml", "--dry-run", "--part", "1/7", "--out", "parts"]);
    assert!(printed.starts_with("rows          120\nparts         7, of some 18 rows\n"), "{printed}");
    assert_eq!(files(path), ["h.csv", "study.toml", "v.csv", "whole.csv"]);
}
