//! Standard input and output, devices and pipes.

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::outputs::{SEARCH, SIMULATE, SPECTRUM, folder, is_root, same, tool};
use crate::program::{RECORD, fails_with, program, succeeds, text};
use crate::skipped::skip;

const SVG: [&str; 2] = ["--plot-format", "svg"];

/// Returns the commands that write a table.
fn tables() -> [(&'static str, &'static [&'static str]); 4] {
    [("simulate", &SIMULATE), ("spectrum", &SPECTRUM), ("search", &SEARCH), ("sweep", &["sweep", "study.toml"])]
}

/// Returns the table that a command writes to a file.
fn table(folder: &Path, name: &str, command: &[&str]) -> String {
    succeeds(&mut program(folder, &[command, &["--csv", &format!("{name}.csv")]]));
    fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap()
}

/// Standard output, under any name, holds the table only; the summary goes to standard error.
#[test]
fn standard_output_holds_the_table_only() {
    let folder = folder();
    let path = folder.path();
    // Like /dev/stdout, which a failing test could damage.
    symlink("/proc/self/fd/1", path.join("stdout")).unwrap();
    for (name, command) in tables() {
        let whole = table(path, name, command);
        assert!(whole.lines().count() > 2);
        for output in ["-", "stdout", "/proc/self/fd/1"] {
            let (out, err) = succeeds(&mut program(path, &[command, &["--csv", output]]));
            same(&out, &whole);
            assert!(!err.is_empty());
        }
        let file = File::create(path.join("redirected")).unwrap();
        let (_, err) = succeeds(program(path, &[command, &["--csv", "redirected"]]).stdout(file));
        same(&fs::read_to_string(path.join("redirected")).unwrap(), &whole);
        assert!(!err.is_empty());
    }
    assert!(!path.join("-").exists());
}

#[test]
fn standard_output_holds_the_picture() {
    let folder = folder();
    let path = folder.path();
    for command in [&SIMULATE[..], &SPECTRUM] {
        let csv = ["--csv", "run.csv"];
        succeeds(&mut program(path, &[command, &csv, &["--plot", "run.svg"]]));
        fs::remove_file(path.join("run.csv")).unwrap();
        let (picture, _) = succeeds(&mut program(path, &[command, &csv, &["--plot", "-"], &SVG]));
        same(&picture, &fs::read_to_string(path.join("run.svg")).unwrap());
        fs::remove_file(path.join("run.csv")).unwrap();
        let (table, _) = succeeds(&mut program(path, &[command, &["--csv", "-", "--plot", "other.svg"]]));
        same(&fs::read_to_string(path.join("other.svg")).unwrap(), &picture);
        succeeds(&mut program(path, &[command, &csv]));
        same(&table, &fs::read_to_string(path.join("run.csv")).unwrap());
        fs::remove_file(path.join("run.csv")).unwrap();
    }
}

/// Devices are written to, not replaced. The test makes its own, which a faulty program may damage.
#[test]
fn devices_are_written_to() {
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
            let mut command = program(path, &[command, &["--csv", device]]);
            match device {
                "full" => fails_with(&mut command, &["full: cannot be written: No space left"]),
                "disk" => fails_with(&mut command, &["disk: cannot be written: it is a disk"]),
                _ => drop(succeeds(&mut command)),
            }
            let kind = fs::symlink_metadata(path.join(device)).unwrap().file_type();
            assert!(kind.is_char_device() || kind.is_block_device(), "{device} was replaced");
        }
    }
    if devices.len() > 1 {
        succeeds(&mut program(path, &[&SIMULATE, &["--csv", "null", "--plot", "null"], &SVG]));
        fails_with(&mut program(path, &[&SIMULATE, &["--plot", "full"], &SVG]), &["full: cannot be written"]);
        let full = || File::options().append(true).open(path.join("full")).unwrap();
        fails_with(program(path, &[&SIMULATE]).stdout(full()), &["standard output: cannot be written: No space left"]);
        fails_with(
            program(path, &[&SPECTRUM, &["--csv", "-"]]).stdout(full()),
            &["standard output: cannot be written"],
        );
    }
}

#[test]
fn a_named_pipe_receives_everything_and_stays() {
    let folder = folder();
    let path = folder.path();
    tool(path, "mkfifo", &["pipe"]);
    let through = |arguments: &[&[&str]]| {
        let copy = File::create(path.join("copy")).unwrap();
        let mut reader = Command::new("cat").arg("pipe").current_dir(path).stdout(copy).spawn().unwrap();
        succeeds(&mut program(path, arguments));
        // If the program did not open the pipe, this ends the reader, with an empty copy.
        let _ = File::options().write(true).custom_flags(libc::O_NONBLOCK).open(path.join("pipe"));
        assert!(reader.wait().unwrap().success());
        fs::read_to_string(path.join("copy")).unwrap()
    };
    for (name, command) in tables() {
        let whole = table(path, name, command);
        same(&through(&[command, &["--csv", "pipe"]]), &whole);
    }
    succeeds(&mut program(path, &[&SIMULATE, &["--plot", "run.svg"]]));
    let picture = fs::read_to_string(path.join("run.svg")).unwrap();
    same(&through(&[&SIMULATE, &["--plot", "pipe"], &SVG]), &picture);
    assert!(fs::metadata(path.join("pipe")).unwrap().file_type().is_fifo());
    let same = ["--csv", "pipe", "--plot", "pipe"];
    fails_with(&mut program(path, &[&SIMULATE, &same, &SVG]), &["--plot pipe", "--csv pipe"]);
}

/// Open files of the shell are appended to, such as `>(gzip > run.csv.gz)` or `3>> run.csv`.
#[test]
fn open_files_of_the_shell_are_appended_to() {
    let folder = folder();
    let path = folder.path();
    for (name, command) in tables() {
        let whole = table(path, name, command);
        let program = env!("CARGO_BIN_EXE_rocking");
        let command = command.join(" ");
        let script = format!(
            "rm -f there; exec 3>> there; echo before >&3; {program} {command} --csv /dev/fd/3; echo after >&3"
        );
        succeeds(Command::new("sh").args(["-c", &script]).current_dir(path));
        let there = fs::read_to_string(path.join("there")).unwrap();
        same(&there, &format!("before\n{whole}after\n"));
    }
}

/// A reader may close the pipe early, as in `rocking … | head -1`.
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
        closed(&mut program(path, &[command, &["--csv", "-"]]));
    }
    // Longer than the buffer of a pipe.
    let spectrum = ["spectrum", "--pulse", "one-sine", "--amplitude", "1", "--points", "500", "--duration", "0.1"];
    closed(&mut program(path, &[&spectrum, &["--csv", "-"]]));
    closed(&mut program(path, &[&spectrum, &["--csv", "-", "--plot", "closed.svg"]]));
    succeeds(&mut program(path, &[&spectrum, &["--csv", "s.csv", "--plot", "whole.svg"]]));
    assert!(fs::read(path.join("closed.svg")).unwrap() == fs::read(path.join("whole.svg")).unwrap());
    for command in [&SEARCH[..], &["simulate"], &["simulate", "--csv", "run.csv", "--json"], &["man"]] {
        closed(&mut program(path, &[command]));
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
            let (named, _) = succeeds(&mut program(path, &[command, &[option, RECORD, "--csv", "-"]]));
            let (piped, _) =
                succeeds(program(path, &[command, &[option, "-", "--csv", "-"]]).stdin(standard("record.smc")));
            assert!(named == piped && named.lines().count() >= 2, "{command:?} {option}");
        }
        let both = ["--record", "-", "--vertical", "-", "--csv", "-"];
        fails_with(&mut program(path, &[command, &both]), &["--record -", "--vertical -", "standard input"]);
        let empty = program(path, &[command, &["--record", "-", "--csv", "-"]]).stdin(Stdio::null()).output().unwrap();
        assert!(text(&empty.stderr).contains("standard input: the file is empty"), "{}", text(&empty.stderr));
    }
    let (named, _) = succeeds(&mut program(path, &[&["sweep", "study.toml", "--csv", "-"]]));
    let (piped, _) = succeeds(program(path, &[&["sweep", "-", "--csv", "-"]]).stdin(standard("study.toml")));
    assert!(named == piped && named.lines().any(|line| line.starts_with("5,")));
    fails_with(program(path, &[&["sweep", "-", "--csv", "-"]]).stdin(standard("record.smc")), &["standard input:1: "]);
}

#[test]
fn streams_cannot_be_resumed() {
    let folder = folder();
    let path = folder.path();
    tool(path, "mkfifo", &["pipe"]);
    for command in [&SPECTRUM[..], &["sweep", "study.toml"]] {
        for (csv, name) in [("-", "standard output"), ("pipe", "pipe")] {
            fails_with(&mut program(path, &[command, &["--resume", "--csv", csv]]), &[name, "--resume"]);
        }
    }
    assert!(fs::metadata(path.join("pipe")).unwrap().file_type().is_fifo());
}
