//! Completions, manual pages and the reference in Markdown, checked with the tools that read them.

use std::fs;
use std::process::Command;

use crate::outputs::folder;
use crate::program::{fails_with, files, program, succeeds, text};
use crate::skipped::skip;

const COMMANDS: [&str; 23] = [
    "simulate",
    "sketch",
    "pushover",
    "frame",
    "spectrum",
    "sweep",
    "parts",
    "portfolio",
    "merge",
    "ida",
    "stripes",
    "cloud",
    "record",
    "pulse",
    "schema",
    "search",
    "foundations",
    "fragility",
    "rate",
    "fit",
    "assess",
    "completions",
    "man",
];

/// Returns whether a tool exists; reports a partly skipped test otherwise.
fn have(program: &str) -> bool {
    let there = Command::new(program).arg("--version").output().is_ok();
    if !there {
        skip(&format!("completions and manual pages in part: there is no {program} here"));
    }
    there
}

#[test]
fn bash_completes_commands_and_options() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (script, _) = succeeds(&mut program(folder.path(), &[&["completions", shell]]));
        assert!(COMMANDS.iter().all(|command| script.contains(command)) && script.contains("on-separation"), "{shell}");
        fs::write(folder.path().join(shell), script).unwrap();
    }
    let output = program(folder.path(), &[&["completions", "cmd"]]).output().unwrap();
    assert!(!output.status.success() && text(&output.stderr).contains("possible values: bash"));
    if !have("bash") {
        return;
    }
    let complete = |words: &str, number: usize| {
        let script = format!(
            "source ./bash; COMP_WORDS=({words}); COMP_CWORD={number}; \
             _rocking rocking \"${{COMP_WORDS[{number}]}}\" \"${{COMP_WORDS[{number}-1]}}\"; echo \"${{COMPREPLY[@]}}\""
        );
        let (answer, _) = succeeds(Command::new("bash").args(["--norc", "-c", &script]).current_dir(folder.path()));
        answer.trim().to_string()
    };
    assert_eq!(complete("rocking sim", 1), "simulate");
    assert_eq!(complete("rocking simulate --plot-f", 2), "--plot-format");
    assert_eq!(complete("rocking search damping --resol", 3), "--resolution");
    assert_eq!(complete("rocking simulate --plot-format s", 3), "svg");
}

#[test]
fn there_is_a_manual_page_for_each_command() {
    let folder = folder();
    let path = folder.path();
    let (main, _) = succeeds(&mut program(path, &[&["man"]]));
    succeeds(&mut program(path, &[&["man", "--out", "new/man"]]));
    let pages = path.join("new/man");
    assert_eq!(fs::read_to_string(pages.join("rocking.1")).unwrap(), main);
    let mut expected: Vec<String> = COMMANDS.map(|command| format!("rocking-{command}.1")).to_vec();
    expected.extend(
        [
            "rocking-foundations-pad.1",
            "rocking-foundations-soil.1",
            "rocking-search-damping.1",
            "rocking-search-overturning.1",
            "rocking.1",
        ]
        .map(String::from),
    );
    expected.sort();
    assert_eq!(files(&pages), expected);
    let has_groff = have("groff");
    for name in expected {
        let page = fs::read_to_string(pages.join(&name)).unwrap();
        assert!(page.contains("SYNOPSIS") && page.contains("Print help"), "{page}");
        if has_groff {
            let groff = ["-man", "-ww", "-k", "-z"];
            let output = Command::new("groff").args(groff).arg(pages.join(&name)).output().unwrap();
            assert!(output.status.success() && output.stderr.is_empty(), "{name}: {}", text(&output.stderr));
        }
    }
    fs::write(path.join("file"), "").unwrap();
    fails_with(&mut program(path, &[&["man", "--out", "file"]]), &["file"]);
}

#[test]
fn the_reference_has_every_option_of_the_help() {
    let folder = folder();
    let (reference, _) = succeeds(&mut program(folder.path(), &[&["man", "--markdown"]]));
    let mut sections = reference.split("\n## rocking ").skip(1);
    for command in &COMMANDS[..2] {
        let section = sections.next().unwrap();
        assert!(section.starts_with(command), "{section}");
        let (help, _) = succeeds(&mut program(folder.path(), &[&[command, "--help"]]));
        let options: Vec<&str> = help.lines().filter_map(|line| line.strip_prefix("      --")).collect();
        assert!(options.len() > 10, "{help}");
        for option in options {
            assert_eq!(section.matches(&format!("| `--{option}` |")).count(), 1, "{command} --{option}");
        }
    }
    assert!(reference.contains("\n### rocking search damping\n"), "{reference}");
    assert!(reference.contains("| `--alpha <RAD>` | Slenderness angle alpha [rad] | `0.18` |\n"), "{reference}");
    let output = program(folder.path(), &[&["man", "--markdown", "--out", "new"]]).output().unwrap();
    assert!(
        !output.status.success() && text(&output.stderr).contains("'--markdown' cannot be used with '--out <DIR>'")
    );
}
