//! Mutants listed by cargo-mutants → one program with a switch for each → the mutants that no test notices.
//!
//! A rewritten copy of the sources holds each changed operator, guard, arm, field or body next to the original, and the
//! environment variable `MUTANT` selects one of them. A mutant then costs the time of its tests, without a compilation.

mod list;
mod outcomes;
mod switched;
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use clap::Parser;

use list::Mutant;
use outcomes::{Outcome, Table};
use switched::Copy;
use tests::{Program, Verdict};

/// Compiles mutants together and runs tests on each.
#[derive(Parser)]
struct Arguments {
    /// What `cargo mutants --list --json` wrote
    list: PathBuf,
    /// Folders and files whose mutants are tested, such as src/system
    #[arg(required = true)]
    places: Vec<String>,
    /// Tests to run: `lib`, a folder of tests such as `system`, or a module such as `simulation::physics`
    #[arg(long = "test", required = true)]
    tests: Vec<String>,
    /// A module that runs only if --test names it
    #[arg(long)]
    skip: Vec<String>,
    /// Test again the mutants that survived these tests before
    #[arg(long)]
    again: bool,
    /// Folder of the copy, its programs and outcomes.csv
    #[arg(long, default_value = "target/mutants")]
    out: PathBuf,
}

fn main() {
    if let Err(message) = run(&Arguments::parse()) {
        eprintln!("error: {message}");
        std::process::exit(1);
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let text = std::fs::read_to_string(&arguments.list).map_err(|e| format!("{}: {e}", arguments.list.display()))?;
    let mut mutants = list::read(&text)?;
    mutants.retain(|mutant| arguments.places.iter().any(|place| Path::new(&mutant.file).starts_with(place)));
    mutants.sort_by_key(|m| arguments.places.iter().position(|place| Path::new(&m.file).starts_with(place)));
    let mut table = Table::open(&arguments.out.join("outcomes.csv"))?;
    let left_out: BTreeSet<u32> =
        mutants.iter().filter(|m| table.of(m).is_some_and(Outcome::cannot_run)).map(|m| m.number).collect();
    let (mut programs, left_out) = compile(arguments, &mutants, left_out, &mut table)?;
    let mut times = BTreeMap::new();
    for program in &mut programs {
        let time = program.measure()?;
        println!("{}: {:.2} s without a mutant", program.name, time.as_secs_f64());
        times.insert(program.name.clone(), time);
    }
    // How many mutants of a file a test has caught.
    let mut catches: BTreeMap<(&str, String), u32> = BTreeMap::new();

    let runnable: Vec<&Mutant> = mutants.iter().filter(|mutant| !left_out.contains(&mutant.number)).collect();
    for (done, mutant) in runnable.iter().enumerate() {
        let mut survived = match table.of(mutant) {
            Some(Outcome::Survived(tests)) => tests.clone(),
            Some(_) => continue,
            None => BTreeSet::new(),
        };
        // Those that have caught the most mutants of this file for their time come first.
        programs.sort_by_cached_key(|program| {
            let caught = catches.get(&(&*mutant.file, program.name.clone())).copied().unwrap_or_default();
            times[&program.name] / (1 + caught)
        });
        let mut noticed = None;
        for program in &programs {
            if survived.contains(&program.name) && !arguments.again {
                continue;
            }
            noticed = match program.run(mutant.number)? {
                Verdict::Passed => None,
                Verdict::Failed => Some(Outcome::Caught(program.name.clone())),
                Verdict::TimedOut => Some(Outcome::TimedOut(program.name.clone())),
            };
            if noticed.is_some() {
                break;
            }
            survived.insert(program.name.clone());
        }
        if let Some(Outcome::Caught(test) | Outcome::TimedOut(test)) = &noticed {
            *catches.entry((&mutant.file, test.clone())).or_default() += 1;
        }
        let outcome = noticed.unwrap_or(Outcome::Survived(survived));
        println!("{}/{} {} {}: {outcome}", done + 1, runnable.len(), mutant.place(), mutant.change);
        table.record(mutant, outcome)?;
    }
    table.print_counts(mutants.iter());
    Ok(())
}

/// Compiles the mutants together; returns the programs and the mutants that do not compile.
fn compile(
    arguments: &Arguments,
    mutants: &[Mutant],
    mut left_out: BTreeSet<u32>,
    table: &mut Table,
) -> Result<(Vec<Program>, BTreeSet<u32>), String> {
    let mut files: BTreeMap<&str, Vec<&Mutant>> = BTreeMap::new();
    for mutant in mutants {
        files.entry(&mutant.file).or_default().push(mutant);
    }
    let copy = Copy::of_sources(&arguments.out.join("switched"), |file| files.contains_key(file))?;
    loop {
        let mut regions = BTreeMap::new();
        for (&file, mutants) in &files {
            let wanted: Vec<&Mutant> = mutants.iter().copied().filter(|m| !left_out.contains(&m.number)).collect();
            let rewritten = copy.rewrite(file, &wanted)?;
            regions.insert(file, rewritten.regions);
            leave_out(&rewritten.refused, mutants, &mut left_out, table)?;
        }
        let errors = tests::check(&copy.folder, &arguments.out)?;
        if errors.is_empty() {
            let programs = tests::build(&copy.folder, &arguments.out, &arguments.tests, &arguments.skip)?;
            return Ok((programs, left_out));
        }
        for error in &errors {
            let refused = switched::culprits(&regions, error)?;
            leave_out(&refused, &files[error.file.as_str()], &mut left_out, table)?;
        }
        println!("{} mutants left out", left_out.len());
    }
}

fn leave_out(
    refused: &[(u32, Outcome)],
    mutants: &[&Mutant],
    left_out: &mut BTreeSet<u32>,
    table: &mut Table,
) -> Result<(), String> {
    for (number, outcome) in refused {
        let mutant = mutants.iter().find(|mutant| mutant.number == *number).expect("it is one of them");
        if left_out.insert(*number) {
            table.record(mutant, outcome.clone())?;
        }
    }
    Ok(())
}
