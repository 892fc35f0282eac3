//! Standard input and output, devices and pipes.

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::skipped::skip;
use crate::{RECORD, SEARCH, SIMULATE, SPECTRUM, folder, is_root, made, refused, rocking, same, text, tool};

const SVG: [&str; 2] = ["--plot-format", "svg"];

/// The commands that write a table.
fn tables() -> [(&'static str, &'static [&'static str]); 4] {
    [("simulate", &SIMULATE), ("spectrum", &SPECTRUM), ("search", &SEARCH), ("sweep", &["sweep", "study.toml"])]
}

/// The table that a command writes into a file.
fn table(folder: &Path, name: &str, command: &[&str]) -> String {
    made(&mut rocking(folder, &[command, &["--csv", &format!("{name}.csv")]]));
    fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap()
}

/// `-`, another name of standard output, and the file that it is redirected to: the table alone is there, and what a
/// person wants to know is on standard error.
#[test]
fn standard_output_takes_the_table_alone() {
    let folder = folder();
    let path = folder.path();
    // As /dev/stdout is, which no test should put at risk.
    symlink("/proc/self/fd/1", path.join("stdout")).unwrap();
    for (name, command) in tables() {
        let whole = table(path, name, command);
        assert!(whole.lines().count() > 2);
        for output in ["-", "stdout", "/proc/self/fd/1"] {
            let (out, err) = made(&mut rocking(path, &[command, &["--csv", output]]));
            same(&out, &whole);
            assert!(!err.is_empty());
        }
        let file = File::create(path.join("redirected")).unwrap();
        let (_, err) = made(rocking(path, &[command, &["--csv", "redirected"]]).stdout(file));
        same(&fs::read_to_string(path.join("redirected")).unwrap(), &whole);
        assert!(!err.is_empty());
    }
    assert!(!path.join("-").exists());
}

#[test]
fn standard_output_takes_the_picture() {
    let folder = folder();
    let path = folder.path();
    for command in [&SIMULATE[..], &SPECTRUM] {
        let csv = ["--csv", "run.csv"];
        made(&mut rocking(path, &[command, &csv, &["--plot", "run.svg"]]));
        fs::remove_file(path.join("run.csv")).unwrap();
        let (picture, _) = made(&mut rocking(path, &[command, &csv, &["--plot", "-"], &SVG]));
        same(&picture, &fs::read_to_string(path.join("run.svg")).unwrap());
        fs::remove_file(path.join("run.csv")).unwrap();
        let (table, _) = made(&mut rocking(path, &[command, &["--csv", "-", "--plot", "other.svg"]]));
        same(&fs::read_to_string(path.join("other.svg")).unwrap(), &picture);
        made(&mut rocking(path, &[command, &csv]));
        same(&table, &fs::read_to_string(path.join("run.csv")).unwrap());
        fs::remove_file(path.join("run.csv")).unwrap();
    }
}

/// A device is written into. The tests make devices of their own, since a program that is wrong would replace them.
#[test]
fn devices_are_written_into() {
    if !is_root() {
        return;
    }
    let folder = folder();
    let path = folder.path();
    for (name, number) in [("full", "7"), ("null", "3")] {
        tool(path, "mknod", &[name, "c", "1", number]);
    }
    tool(path, "mknod", &["disk", "b", "1", "0"]);
    let mut devices = vec!["full", "null", "disk"];
    if File::options().append(true).open(path.join("null")).is_err() {
        skip(&format!("devices as outputs: they do not work in {}", path.display()));
        devices = vec!["disk"];
    }
    for (_, command) in tables() {
        for &device in &devices {
            let mut command = rocking(path, &[command, &["--csv", device]]);
            match device {
                "full" => refused(&mut command, &["full: cannot be written: No space left"]),
                "disk" => refused(&mut command, &["disk: cannot be written: it is a disk"]),
                _ => drop(made(&mut command)),
            }
            let kind = fs::symlink_metadata(path.join(device)).unwrap().file_type();
            assert!(kind.is_char_device() || kind.is_block_device(), "{device} was replaced");
        }
    }
    if devices.len() > 1 {
        made(&mut rocking(path, &[&SIMULATE, &["--csv", "null", "--plot", "null"], &SVG]));
        refused(&mut rocking(path, &[&SIMULATE, &["--plot", "full"], &SVG]), &["full: cannot be written"]);
        let full = || File::options().append(true).open(path.join("full")).unwrap();
        refused(rocking(path, &[&SIMULATE]).stdout(full()), &["standard output: cannot be written: No space left"]);
        refused(rocking(path, &[&SPECTRUM, &["--csv", "-"]]).stdout(full()), &["standard output: cannot be written"]);
    }
}

#[test]
fn a_named_pipe_gets_all_and_stays() {
    let folder = folder();
    let path = folder.path();
    tool(path, "mkfifo", &["pipe"]);
    let through = |arguments: &[&[&str]]| {
        let copy = File::create(path.join("copy")).unwrap();
        let mut reader = Command::new("cat").arg("pipe").current_dir(path).stdout(copy).spawn().unwrap();
        made(&mut rocking(path, arguments));
        // It waits for ever where nobody opened the pipe.
        let ended = (0..100).any(|_| {
            std::thread::sleep(Duration::from_millis(20));
            reader.try_wait().unwrap().is_some()
        });
        if !ended {
            reader.kill().unwrap();
            reader.wait().unwrap();
        }
        assert!(ended, "nobody wrote into the pipe");
        fs::read_to_string(path.join("copy")).unwrap()
    };
    for (name, command) in tables() {
        let whole = table(path, name, command);
        same(&through(&[command, &["--csv", "pipe"]]), &whole);
    }
    made(&mut rocking(path, &[&SIMULATE, &["--plot", "run.svg"]]));
    let picture = fs::read_to_string(path.join("run.svg")).unwrap();
    same(&through(&[&SIMULATE, &["--plot", "pipe"], &SVG]), &picture);
    assert!(fs::metadata(path.join("pipe")).unwrap().file_type().is_fifo());
    let same = ["--csv", "pipe", "--plot", "pipe"];
    refused(&mut rocking(path, &[&SIMULATE, &same, &SVG]), &["--plot pipe", "--csv pipe"]);
}

/// What a shell hands over as `>(gzip > run.csv.gz)` or `3>> run.csv`: an open file of it, which is added to.
#[test]
fn an_open_file_of_the_shell_is_added_to() {
    let folder = folder();
    let path = folder.path();
    for (name, command) in tables() {
        let whole = table(path, name, command);
        let program = env!("CARGO_BIN_EXE_rocking");
        let command = command.join(" ");
        let script = format!(
            "rm -f there; exec 3>> there; echo before >&3; {program} {command} --csv /dev/fd/3; echo after >&3"
        );
        made(Command::new("sh").args(["-c", &script]).current_dir(path));
        let there = fs::read_to_string(path.join("there")).unwrap();
        same(&there, &format!("before\n{whole}after\n"));
    }
}

/// `rocking … | head -1`
#[test]
fn a_reader_may_close_the_pipe() {
    let folder = folder();
    let path = folder.path();
    let closed = |command: &mut Command| {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::with_capacity(1, child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
        assert!(!line.is_empty() && !text(&output.stderr).contains("pipe"), "{}", text(&output.stderr));
    };
    for (_, command) in tables() {
        closed(&mut rocking(path, &[command, &["--csv", "-"]]));
    }
    // Longer than a pipe holds.
    let spectrum = ["spectrum", "--pulse", "one-sine", "--amplitude", "1", "--points", "500", "--duration", "0.1"];
    closed(&mut rocking(path, &[&spectrum, &["--csv", "-"]]));
    closed(&mut rocking(path, &[&spectrum, &["--csv", "-", "--plot", "closed.svg"]]));
    made(&mut rocking(path, &[&spectrum, &["--csv", "s.csv", "--plot", "whole.svg"]]));
    assert!(fs::read(path.join("closed.svg")).unwrap() == fs::read(path.join("whole.svg")).unwrap());
    for command in [&SEARCH[..], &["simulate"], &["simulate", "--csv", "run.csv", "--json"], &["man"]] {
        closed(&mut rocking(path, &[command]));
    }
}

#[test]
fn standard_input_is_a_record_or_a_study() {
    let folder = folder();
    let path = folder.path();
    let standard = |name: &str| File::open(path.join(name)).unwrap();
    let commands: [&[&str]; 3] = [
        &["simulate", "--duration", "1"],
        &["spectrum", "--points", "2", "--duration", "1"],
        &["search", "overturning", "--from", "2", "--to", "3", "--points", "2", "--resolution", "0.5"],
    ];
    for command in commands {
        for option in ["--record", "--vertical"] {
            if command[0] == "search" && option == "--vertical" {
                continue;
            }
            let (named, _) = made(&mut rocking(path, &[command, &[option, RECORD, "--csv", "-"]]));
            let (piped, _) =
                made(rocking(path, &[command, &[option, "-", "--csv", "-"]]).stdin(standard("record.smc")));
            assert!(named == piped && named.lines().count() >= 2, "{command:?} {option}");
        }
        let both = ["--record", "-", "--vertical", "-", "--csv", "-"];
        refused(&mut rocking(path, &[command, &both]), &["--record -", "--vertical -", "standard input"]);
        let empty = rocking(path, &[command, &["--record", "-", "--csv", "-"]]).stdin(Stdio::null()).output().unwrap();
        assert!(text(&empty.stderr).contains("standard input: the file is empty"), "{}", text(&empty.stderr));
    }
    let (named, _) = made(&mut rocking(path, &[&["sweep", "study.toml", "--csv", "-"]]));
    let (piped, _) = made(rocking(path, &[&["sweep", "-", "--csv", "-"]]).stdin(standard("study.toml")));
    assert!(named == piped && named.lines().any(|line| line.starts_with("5,")));
    refused(rocking(path, &[&["sweep", "-", "--csv", "-"]]).stdin(standard("record.smc")), &["standard input:1: "]);
}

#[test]
fn what_is_not_kept_is_not_resumed() {
    let folder = folder();
    let path = folder.path();
    tool(path, "mkfifo", &["pipe"]);
    for command in [&SPECTRUM[..], &["sweep", "study.toml"]] {
        for (csv, name) in [("-", "standard output"), ("pipe", "pipe")] {
            refused(&mut rocking(path, &[command, &["--resume", "--csv", csv]]), &[name, "--resume"]);
        }
    }
    assert!(fs::metadata(path.join("pipe")).unwrap().file_type().is_fifo());
}
