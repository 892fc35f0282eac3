//! Outcomes of the mutants ↔ outcomes.csv, from which an interrupted run resumes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use crate::list::Mutant;

#[derive(Clone)]
pub enum Outcome {
    DoesNotCompile,
    /// It has no switch: it is in a constant, or its switch does not compile.
    NotRun,
    /// This test failed.
    Caught(String),
    /// This test took far longer than without the mutant.
    TimedOut(String),
    /// These tests passed.
    Survived(BTreeSet<String>),
}

impl Outcome {
    pub fn cannot_run(&self) -> bool {
        matches!(self, Outcome::DoesNotCompile | Outcome::NotRun)
    }

    fn word(&self) -> &'static str {
        match self {
            Outcome::DoesNotCompile => "does not compile",
            Outcome::NotRun => "not run",
            Outcome::Caught(_) => "caught",
            Outcome::TimedOut(_) => "timeout",
            Outcome::Survived(_) => "survived",
        }
    }

    fn tests(&self) -> String {
        match self {
            Outcome::DoesNotCompile | Outcome::NotRun => String::new(),
            Outcome::Caught(test) | Outcome::TimedOut(test) => test.clone(),
            Outcome::Survived(tests) => tests.iter().map(String::as_str).collect::<Vec<_>>().join(" "),
        }
    }

    fn read(word: &str, tests: &str) -> Option<Outcome> {
        Some(match word {
            "does not compile" => Outcome::DoesNotCompile,
            "not run" => Outcome::NotRun,
            "caught" => Outcome::Caught(tests.into()),
            "timeout" => Outcome::TimedOut(tests.into()),
            "survived" => Outcome::Survived(tests.split_whitespace().map(String::from).collect()),
            _ => return None,
        })
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.word(), self.tests())
    }
}

/// Outcomes by the mutants' numbers.
pub struct Table {
    path: PathBuf,
    rows: BTreeMap<u32, Row>,
}

struct Row {
    place: String,
    function: String,
    change: String,
    outcome: Outcome,
}

impl Table {
    /// Reads the table of an earlier run, or starts an empty one.
    pub fn open(path: &Path) -> Result<Table, String> {
        let failed = |error: String| format!("{}: {error}", path.display());
        let mut table = Table { path: path.to_path_buf(), rows: BTreeMap::new() };
        if !path.exists() {
            return Ok(table);
        }
        for record in csv::Reader::from_path(path).map_err(|e| failed(e.to_string()))?.records() {
            let record = record.map_err(|e| failed(e.to_string()))?;
            let number = record[0].parse().map_err(|e| failed(format!("{}: {e}", &record[0])))?;
            let outcome = Outcome::read(&record[4], &record[5]).ok_or_else(|| failed(format!("{:?}", &record[4])))?;
            let [place, function, change] = [1, 2, 3].map(|column| record[column].to_string());
            table.rows.insert(number, Row { place, function, change, outcome });
        }
        Ok(table)
    }

    /// Returns the outcome of a mutant, unless the sources have changed since.
    pub fn of(&self, mutant: &Mutant) -> Option<&Outcome> {
        let row = self.rows.get(&mutant.number)?;
        (row.place == mutant.place() && row.change == mutant.change).then_some(&row.outcome)
    }

    /// Records an outcome and writes the table at once, so that a later run can resume from here.
    pub fn record(&mut self, mutant: &Mutant, outcome: Outcome) -> Result<(), String> {
        let (place, function, change) = (mutant.place(), mutant.function.clone(), mutant.change.clone());
        self.rows.insert(mutant.number, Row { place, function, change, outcome });
        let new = self.path.with_extension("new");
        let written = || -> Result<(), csv::Error> {
            let mut writer = csv::Writer::from_path(&new)?;
            writer.write_record(["number", "place", "function", "change", "outcome", "tests"])?;
            for (number, Row { place, function, change, outcome }) in &self.rows {
                writer.write_record([
                    &number.to_string(),
                    place,
                    function,
                    change,
                    outcome.word(),
                    &outcome.tests(),
                ])?;
            }
            writer.flush()?;
            Ok(std::fs::rename(&new, &self.path)?)
        };
        written().map_err(|e| format!("{}: {e}", self.path.display()))
    }

    /// Prints the number of mutants per file and outcome.
    pub fn print_counts<'a>(&self, mutants: impl Iterator<Item = &'a Mutant>) {
        let mut counts: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
        for mutant in mutants {
            let word = self.of(mutant).map_or("not run", Outcome::word);
            *counts.entry(&mutant.file).or_default().entry(word).or_default() += 1;
        }
        for (file, counts) in counts {
            println!("{file}: {} mutants, {counts:?}", counts.values().sum::<usize>());
        }
    }
}
