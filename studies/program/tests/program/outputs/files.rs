//! Existing files: inputs, other outputs, links, old results, failed writes.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::outputs::{SEARCH, SIMULATE, SPECTRUM, folder, is_root, tool};
use crate::program::{fails_with, files, program, succeeds, text};
use crate::skipped::skip;

/// Not by the same name, nor through symbolic links, hard links or chains of them.
#[test]
fn an_input_is_never_replaced() {
    let folder = folder();
    let path = folder.path();
    let before = fs::read(path.join("record.smc")).unwrap();
    symlink("record.smc", path.join("symbolic")).unwrap();
    fs::hard_link(path.join("record.smc"), path.join("hard")).unwrap();
    symlink("hard", path.join("chain")).unwrap();
    fs::hard_link(path.join("study.toml"), path.join("study")).unwrap();
    let all = files(path);
    let spectrum = ["spectrum", "--record", "record.smc"];
    let svg = ["--csv", "new.csv", "--plot-format", "svg"];
    for name in ["record.smc", "./record.smc", "symbolic", "hard", "chain"] {
        let csv = ["--csv", name];
        let would = format!("--csv {name} would replace");
        let record = [would.as_str(), "--record record.smc"];
        fails_with(&mut program(path, &[&SIMULATE, &["--record", "record.smc"], &csv]), &record);
        fails_with(
            &mut program(path, &[&SIMULATE, &["--vertical", "record.smc"], &csv]),
            &[&would, "--vertical record.smc"],
        );
        fails_with(&mut program(path, &[&spectrum, &csv]), &record);
        fails_with(&mut program(path, &[&["search", "overturning", "--record", "record.smc"], &csv]), &record);
        fails_with(&mut program(path, &[&["sweep", "study.toml"], &csv]), &[&would, "the record record.smc"]);
        fails_with(
            &mut program(path, &[&["sweep", "study.toml", "--resume"], &csv]),
            &[&would, "the record record.smc"],
        );
    }
    for name in ["hard", "chain"] {
        let would = format!("--plot {name} would replace");
        let words = [would.as_str(), "--record record.smc"];
        fails_with(&mut program(path, &[&spectrum, &svg, &["--plot", name]]), &words);
        fails_with(&mut program(path, &[&SIMULATE, &["--record", "record.smc"], &svg, &["--plot", name]]), &words);
    }
    fails_with(
        &mut program(path, &[&["sweep", "study.toml", "--csv", "study"]]),
        &["--csv study", "the study study.toml"],
    );
    let redirected = fs::File::open(path.join("record.smc")).unwrap();
    fails_with(
        program(path, &[&SIMULATE, &["--record", "-", "--csv", "hard"]]).stdin(redirected),
        &["--csv hard", "--record -"],
    );
    assert!(fs::read(path.join("record.smc")).unwrap() == before);
    assert_eq!(files(path), all);
}

#[test]
fn two_outputs_never_share_a_file() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("old"), "old").unwrap();
    fs::hard_link(path.join("old"), path.join("hard")).unwrap();
    symlink("new", path.join("dangling")).unwrap();
    let all = files(path);
    let svg = ["--plot-format", "svg"];
    for [csv, plot] in [["same", "same"], ["same", "./same"], ["old", "hard"], ["dangling", "new"], ["-", "-"]] {
        let words = [&*format!("--plot {plot}"), &*format!("--csv {csv}")];
        for command in [&SIMULATE[..], &SPECTRUM] {
            fails_with(&mut program(path, &[command, &svg, &["--csv", csv, "--plot", plot]]), &words);
        }
    }
    assert_eq!(files(path), all);
    assert_eq!(fs::read(path.join("old")).unwrap(), b"old");
}

/// A link stays a link, even if its target is created by the write.
#[test]
fn links_are_followed() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("inner")).unwrap();
    for (command, name) in [(&SIMULATE[..], "simulate"), (&SEARCH, "search"), (&SPECTRUM, "spectrum")] {
        let [there, plain] = ["there", "plain"].map(|end| format!("{name}-{end}"));
        // A study refuses an existing table.
        if name != "spectrum" {
            fs::write(path.join("inner").join(&there), "old").unwrap();
        }
        symlink(Path::new("inner").join(&there), path.join(name)).unwrap();
        succeeds(&mut program(path, &[command, &["--csv", name]]));
        succeeds(&mut program(path, &[command, &["--csv", &plain]]));
        assert!(path.join(name).is_symlink() && path.join("inner").join(&there).is_file());
        assert!(fs::read(path.join("inner").join(&there)).unwrap() == fs::read(path.join(&plain)).unwrap());
    }
    symlink("nowhere/run.csv", path.join("lost")).unwrap();
    symlink("round", path.join("round")).unwrap();
    fails_with(&mut program(path, &[&SIMULATE, &["--csv", "lost"]]), &["lost", "found no folder"]);
    fails_with(&mut program(path, &[&SPECTRUM, &["--csv", "round"]]), &["round", "symbolic links"]);
    fails_with(&mut program(path, &[&SIMULATE, &["--csv", "inner"]]), &["inner", "is a folder"]);
    assert!(path.join("lost").is_symlink() && path.join("round").is_symlink());
}

#[test]
fn a_replaced_file_keeps_owner_and_permissions() {
    let folder = folder();
    let file = folder.path().join("run.csv");
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    let owner =
        if is_root() { (4321, 1234) } else { (fs::metadata(&file).unwrap().uid(), fs::metadata(&file).unwrap().gid()) };
    std::os::unix::fs::chown(&file, Some(owner.0), Some(owner.1)).unwrap();
    succeeds(&mut program(folder.path(), &[&SIMULATE, &["--csv", "run.csv"]]));
    let metadata = fs::metadata(&file).unwrap();
    assert_eq!(metadata.permissions().mode() & 0o7777, 0o640);
    assert_eq!((metadata.uid(), metadata.gid()), owner);
    assert!(metadata.len() > 10_000);
}

/// The old file stays as it was, no other file remains, and a study resumes once there is room.
#[test]
fn a_full_disk_loses_nothing() {
    if !is_root() {
        return;
    }
    let folder = folder();
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).unwrap();
    let mount = |options| Command::new("mount").args(["-t", "tmpfs", "-o", options, "none"]).arg(&disk).status();
    if !mount("size=64k").is_ok_and(|status| status.success()) {
        skip("a full disk: nothing can be mounted here");
        return;
    }
    let _mounted = Mounted(&disk);
    fs::write(disk.join("run.csv"), "old").unwrap();
    for command in [&["simulate", "--csv", "run.csv"][..], &["simulate", "--csv", "run.csv", "--plot", "run.svg"]] {
        fails_with(&mut program(&disk, &[command]), &["run.csv: cannot be written: No space left"]);
        assert_eq!(fs::read(disk.join("run.csv")).unwrap(), b"old");
        assert_eq!(files(&disk), ["run.csv"]);
    }
    let spectrum = ["spectrum", "--pulse", "one-sine", "--amplitude", "1", "--points", "500", "--duration", "0.1"];
    fails_with(&mut program(&disk, &[&spectrum, &["--csv", "s.csv"]]), &["s.csv: cannot be written: No space left"]);
    assert!(mount("remount,size=4m").unwrap().success());
    succeeds(&mut program(&disk, &[&spectrum, &["--csv", "s.csv", "--resume"]]));
    succeeds(&mut program(&disk, &[&spectrum, &["--csv", "whole.csv"]]));
    assert!(fs::read(disk.join("s.csv")).unwrap() == fs::read(disk.join("whole.csv")).unwrap());
}

struct Mounted<'a>(&'a Path);

impl Drop for Mounted<'_> {
    fn drop(&mut self) {
        tool(Path::new("/"), "umount", &[self.0.to_str().unwrap()]);
    }
}

/// The signal of a file-size limit does not end the program.
#[test]
fn a_limit_of_the_file_size_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("run.csv"), "old").unwrap();
    let limited = |arguments: &str| {
        let mut command = Command::new("sh");
        let program = env!("CARGO_BIN_EXE_rocking");
        // Shells count blocks of 512 or of 1024 bytes.
        command.args(["-c", &format!("ulimit -f 8; exec {program} {arguments}")]).current_dir(path);
        command
    };
    fails_with(&mut limited("simulate --csv run.csv --plot run.svg"), &["run.csv: cannot be written: File too large"]);
    assert_eq!(fs::read(path.join("run.csv")).unwrap(), b"old");
    assert_eq!(files(path), ["run.csv"]);
    fails_with(
        &mut limited(&format!("{} --points 500 --csv s.csv", SPECTRUM[..7].join(" "))),
        &["s.csv: cannot be written"],
    );
}

/// Whether this process, and with it the program, ignores a signal: shells make their background ignore SIGINT.
fn is_ignored(signal: u32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap().trim();
    u64::from_str_radix(mask, 16).unwrap() >> (signal - 1) & 1 == 1
}

/// A program killed before its results are complete leaves the old files and no others.
#[test]
fn a_killed_program_leaves_no_trace() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("run.csv"), "old").unwrap();
    tool(path, "mkfifo", &["pipe"]);
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-KILL", 9)] {
        if is_ignored(number) {
            skip(&format!("a program killed by {signal}: this shell's background ignores it"));
            continue;
        }
        // The program has prepared the table when it waits for a reader of the pipe.
        let outputs = ["--csv", "run.csv", "--plot", "pipe", "--plot-format", "svg"];
        let mut child = program(path, &[&SIMULATE, &outputs]).spawn().unwrap();
        let (start, place) = (Instant::now(), format!("/proc/{}/wchan", child.id()));
        while fs::read_to_string(&place).unwrap() != "wait_for_partner" && start.elapsed() < Duration::from_secs(1) {
            std::thread::yield_now();
        }
        assert!(child.try_wait().unwrap().is_none(), "it has ended before it was killed");
        tool(path, "kill", &[signal, &child.id().to_string()]);
        assert!(!child.wait().unwrap().success());
        assert_eq!(files(path), ["pipe", "run.csv"], "after {signal}");
        assert_eq!(text(&fs::read(path.join("run.csv")).unwrap()), "old");
    }
}

/// Ctrl-C keeps the rows and prints the command that continues the table.
#[test]
fn an_interrupted_study_says_how_to_continue() {
    if is_ignored(2) {
        skip("an interrupted study: this shell's background ignores SIGINT");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let sizes = ["--points", "8000", "--threads", "1", "--lanes", "1"];
    let spectrum = [&SPECTRUM[..7], &sizes].concat();
    let mut child = program(path, &[&spectrum, &["--csv", "a table.csv", "--force"]])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let rows = || fs::read_to_string(path.join("a table.csv")).map_or(0, |text| text.lines().count());
    let start = Instant::now();
    while rows() < 100 && start.elapsed() < Duration::from_secs(20) {
        std::thread::yield_now();
    }
    assert!(child.try_wait().unwrap().is_none(), "it has ended before it was interrupted");
    tool(path, "kill", &["-INT", &child.id().to_string()]);
    let output = child.wait_with_output().unwrap();
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(2));
    let said = text(&output.stderr);
    let (_, command) = said.split_once("the table keeps its rows. To continue: ").unwrap();
    assert!(command.contains("--csv 'a table.csv' --resume") && !command.contains("--force"), "{command}");
    let left = rows();
    assert!((100..8_000).contains(&left), "{left} lines");
    tool(path, "sh", &["-c", command]);
    succeeds(&mut program(path, &[&spectrum, &["--csv", "whole.csv"]]));
    assert!(fs::read(path.join("a table.csv")).unwrap() == fs::read(path.join("whole.csv")).unwrap());
}

/// A read-only file is refused before the work begins.
#[test]
fn a_read_only_file_is_left_alone() {
    if !is_root() {
        return;
    }
    let folder = folder();
    let path = folder.path();
    tool(path, "chmod", &["777", "."]);
    fs::write(path.join("run.csv"), "old").unwrap();
    tool(path, "chmod", &["444", "run.csv"]);
    let program = env!("CARGO_BIN_EXE_rocking");
    let user = ["--reuid", "1000", "--regid", "1000", "--clear-groups", program];
    let mut command = Command::new("setpriv");
    command.args(user).args(SIMULATE).args(["--csv", "run.csv"]).current_dir(path);
    if !Command::new("setpriv").args(user).arg("--version").output().is_ok_and(|output| output.status.success()) {
        skip("files of another user: another user cannot run the program here");
        return;
    }
    fails_with(&mut command, &["run.csv: cannot be written: Permission denied"]);
    assert_eq!(fs::read(path.join("run.csv")).unwrap(), b"old");
}
